//! The command `random-drive`.

use std::cell::Cell;
use std::f64::consts::PI;
use std::rc::Rc;
use std::sync::Arc;

use roverlab::drive::{CoverageMap, CoverageMapParameters, RandomDrive, RandomDriveParameters};
use roverlab::geometry::{Point, Pose, units};
use roverlab::io::control::{self, Behaviour};
use roverlab::io::sim::{Fleet, SimOptions};
use roverlab::io::{FleetIo, RobotIo};
use roverlab::picture::{Mark, Picture};
use roverlab::random::Stream;
use roverlab::world::{Object, ObjectKind, RobotPlacement, RobotSpec, Scene, World};

use crate::common::{
    CampaignArgs, CommonArgs, Failure, FreeFloor, OF_A_CAMPAIGN, OF_ONE_RUN, Outcome, Report,
    campaign_report, rounded, wrong_seeds,
};
use crate::driving::{Conditions, Trail, counted, draw_contacts, paced};

/// Command line of `random-drive`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Drives straight until an obstacle is ahead, turns by a random angle, and repeats; one robot or several",
    after_help = "\
Without --world, the robots drive in a room with two crates and a can. With a .sim, all of its robots drive; if there
are fewer than --robots, --seed places additional ones. --fault requires a single robot.

With --campaign, two robots in that room, or --robots, once for each seed.

JSON fields:
  robots                      number of driving robots
  turns                       total number of turns
  coverage_percent            fraction of the floor that the robots have passed over, relative to that which the first one can
                              reach 15 mm away from all obstacles
  time_limit_s, picture
  metres                      with --campaign only: path length of the first robots
Collisions are those of all robots; pose, odometry and path length are the first one's.
Outcomes: driven, blocked (a robot drove less than a tenth of what it would straight on), collided, failed; with --campaign: passed,
wrong, collided."
)]
pub(crate) struct Args {
    /// Number of robots [default: those of the world, or 1].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=6), allow_hyphen_values = true)]
    pub(crate) robots: Option<u8>,

    #[command(flatten)]
    pub(crate) trials: CampaignArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("campaign", OF_ONE_RUN),
    ("!campaign", OF_A_CAMPAIGN),
]);

/// Simulated time of a run (s).
const SECONDS: f64 = 120.0;
/// Number of places tried for an additional robot.
const PLACES_TRIED: u32 = 50;
/// Share of what a robot would drive straight on below which it found no way.
const HELD: f64 = 0.1;
/// Time between path points of several robots (s).
const STEP: f64 = 0.1;

/// Result of the robots.
struct Outing {
    paths: Vec<Trail>,
    turns: u32,
    contacts: u64,
    contact_places: Vec<Point>,
    report: Report,
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.trials.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let own = || scene(usize::from(args.robots.unwrap_or(1)));
    let mut scene = common.placed_without_goal("the robots have none", own)?;
    if let Some(robots) = args.robots {
        add_robots(&mut scene, usize::from(robots), common.seed)?;
    }
    let seconds = common.time_limit.unwrap_or(SECONDS);
    let outing = if scene.robots.len() == 1 {
        alone(args, &scene, seconds)?
    } else {
        if !common.fault.is_empty() {
            return Err(Failure::input(
                "--fault: found it for several robots; expected it for one robot alone",
            ));
        }
        let mut fleet = common.fleet(&scene, SimOptions::with_noise(common.noise, common.seed))?;
        together(&mut *fleet, &scene, (common.seed, seconds), paced(common))?
    };
    let share = covered(&scene, &outing.paths);
    let report = Report { collisions: Some(outing.contacts), ..outing.report.clone() }
        .field("robots", outing.paths.len())
        .field("turns", outing.turns)
        .field("coverage_percent", share.map(|share| rounded(100.0 * share)))
        .field("time_limit_s", seconds);
    Ok(common.draw(report, "random_drive.svg", || picture(args, &scene, &outing, share)))
}

/// A room with two crates and a can, and robots of different sizes, as in the book.
fn scene(robots: usize) -> Scene {
    let mut world = World::walled(3.0, 2.4);
    for (name, x, y) in [("crate", 1.1, 0.7), ("crate", 2.2, 1.7), ("can", 1.6, 1.5)] {
        let kind = ObjectKind::predefined(name).map(|kind| Arc::new(ObjectKind { fixed: true, ..kind }));
        world.objects.extend(kind.map(|kind| Object::new(kind, Pose::new(x, y, 0.4))));
    }
    let mut scene = Scene::new(world);
    let places = [
        (0.4, 0.4, 0.0),
        (0.7, 1.2, 45.0),
        (2.5, 0.5, 90.0),
        (0.5, 2.0, 0.0),
        (2.6, 2.1, 180.0),
        (1.8, 0.4, 0.0),
    ];
    for (number, (x, y, heading)) in places.into_iter().take(robots).enumerate() {
        let spec = if number % 2 == 1 { RobotSpec::labbot() } else { RobotSpec::s4() };
        let pose = Pose::new(x, y, units::from_deg(heading));
        scene.robots.push(RobotPlacement::new(Arc::new(spec), pose));
    }
    scene
}

/// Adds robots like the first one at random places until a scene has `robots` of them.
fn add_robots(scene: &mut Scene, robots: usize, seed: u64) -> Result<(), Failure> {
    let found = scene.robots.len();
    if found > robots {
        return Err(Failure::input(format!(
            "--robots {robots}: found {found} robots in the world; expected at least as many"
        )));
    }
    let (spec, floor) = (Arc::clone(&scene.robots[0].spec), scene.world.site());
    let free = FreeFloor::new(scene, &spec);
    let mut stream = Stream::new(seed).child("places", 0);
    for _ in found..robots {
        let mut anywhere = || {
            let x = stream.between(floor.min.x, floor.max.x);
            let y = stream.between(floor.min.y, floor.max.y);
            Pose::new(x, y, stream.between(-PI, PI))
        };
        let place =
            (0..PLACES_TRIED).find_map(|_| free.place(scene, &spec, anywhere())).ok_or_else(|| {
                let more = robots - scene.robots.len();
                Failure::input(format!(
                    "--robots {robots}: found no room for {more} more; expected fewer robots"
                ))
            })?;
        scene.robots.push(RobotPlacement::new(Arc::clone(&spec), place));
    }
    Ok(())
}

fn behaviour(scene: &Scene, robot: usize, seed: u64) -> Result<RandomDrive, Failure> {
    let radius = scene.robots[robot].spec.footprint.bounding_radius();
    let parameters = RandomDriveParameters { radius, ..RandomDriveParameters::default() };
    let stream = Stream::new(seed).child("random drive", robot as u64);
    RandomDrive::new(parameters, stream).map_err(Failure::input)
}

/// One robot.
fn alone(args: &Args, scene: &Scene, seconds: f64) -> Result<Outing, Failure> {
    let conditions = Conditions::new(&args.common, seconds)?;
    let mut drive = behaviour(scene, 0, args.common.seed)?;
    let run = conditions.run(scene, paced(&args.common), |robot, step| {
        control::run(robot, &mut drive, seconds, |_, _, _| step())?;
        Ok(drive.turns())
    })?;
    let run = run.lasting(seconds);
    Ok(Outing {
        turns: run.ending.as_ref().copied().unwrap_or(0),
        contacts: run.truth.contacts.into(),
        contact_places: run.truth.contact_places.clone(),
        report: run.report(|_| ended(std::slice::from_ref(&run.trail))),
        paths: vec![run.trail],
    })
}

/// Seeds of a campaign without `--runs`.
const SEEDS: u64 = 100;

/// Drives in the room with many seeds.
fn campaign(args: &Args) -> Result<Report, Failure> {
    let common = &args.common;
    let scene = scene(usize::from(args.robots.unwrap_or(2)));
    let seconds = common.time_limit.unwrap_or(SECONDS);
    let trials = args.trials.trials(common, "drives", SEEDS, |seed| {
        let mut fleet = Fleet::new(&scene, SimOptions::with_noise(common.noise, seed))?;
        let outing = together(&mut fleet, &scene, (seed, seconds), |_| {})?;
        Ok((outing.contacts, outing.report.path_length))
    })?;
    let wrong = wrong_seeds(&trials, |(contacts, _)| *contacts == 0);
    let contacts: u64 = trials.iter().map(|(_, (contacts, _))| contacts).sum();
    let metres: f64 = trials.iter().filter_map(|(_, (_, length))| *length).sum();
    let robots = scene.robots.len();
    common.tell(format_args!(
        "{} drives of {}, {seconds:.0} s each: {metres:.0} m of the first ones, {contacts} contacts",
        trials.len(),
        counted(robots, "robot")
    ));
    Ok(campaign_report(wrong.is_empty(), contacts, &wrong)
        .field("robots", robots)
        .field("metres", rounded(metres)))
}

/// Several robots in one thread, with a seed and for a time (s). `pace` is called with the time.
fn together<'a>(
    fleet: &mut (dyn FleetIo<'a> + 'a),
    scene: &Scene,
    (seed, seconds): (u64, f64),
    mut pace: impl FnMut(f64),
) -> Result<Outing, Failure> {
    let turns: Vec<Rc<Cell<u32>>> = scene.robots.iter().map(|_| Rc::default()).collect();
    for (robot, turns) in turns.iter().cloned().enumerate() {
        let mut drive = behaviour(scene, robot, seed)?;
        let (period, mut run) =
            (drive.period(), control::Run::new(&drive, f64::INFINITY).map_err(Failure::input)?);
        let step = move |robot: &mut dyn RobotIo| {
            let flow = run.step(robot, &mut drive)?;
            turns.set(drive.turns());
            Ok(flow.map_break(|_| ()))
        };
        fleet.control(robot, period, Box::new(step))?;
    }
    let mut paths: Vec<Trail> = scene.robots.iter().map(|robot| vec![(0.0, robot.pose)]).collect();
    while fleet.time()? + 0.5 * STEP < seconds {
        fleet.run_for(STEP)?;
        let time = fleet.time()?;
        for (robot, path) in paths.iter_mut().enumerate() {
            path.push((time, fleet.pose(robot)?));
        }
        pace(time);
    }
    let first = fleet.truth(0)?;
    let (mut contacts, mut contact_places) = (0, Vec::new());
    for robot in 0..scene.robots.len() {
        let truth = fleet.truth(robot)?;
        contacts += u64::from(truth.contacts);
        contact_places.extend(truth.contact_places);
    }
    let report = Report {
        sim_time: Some(fleet.time()?),
        path_length: Some(first.path_length),
        pose: Some(first.pose),
        odometry: Some(scene.robots[0].pose.compose(&first.odometry)),
        ..Report::new(ended(&paths))
    };
    Ok(Outing { turns: turns.iter().map(|turns| turns.get()).sum(), contacts, contact_places, report, paths })
}

/// How a drive ended without a contact: a robot that came hardly anywhere found no way.
fn ended(paths: &[Trail]) -> Outcome {
    let RandomDriveParameters { speed, lag, .. } = RandomDriveParameters::default();
    let is_held = |path: &Trail| {
        let steps = path.windows(2).map(|ends| (ends[1].1.position() - ends[0].1.position()).norm());
        path.last().is_some_and(|(time, _)| steps.sum::<f64>() < HELD * speed * (time - lag))
    };
    if paths.iter().any(is_held) { Outcome::failure("blocked") } else { Outcome::verdict("driven") }
}

/// Fraction of the floor that the robots have passed over.
fn covered(scene: &Scene, paths: &[Trail]) -> Option<f64> {
    let radius = scene.robots[0].spec.footprint.bounding_radius();
    let parameters = CoverageMapParameters { radius, ..CoverageMapParameters::default() };
    let mut map = CoverageMap::new(&scene.world, scene.robots[0].pose.position(), parameters).ok()?;
    paths.iter().flatten().for_each(|(_, pose)| map.cover(pose.position()));
    Some(map.share())
}

/// Paths of all robots.
fn picture(args: &Args, scene: &Scene, outing: &Outing, share: Option<f64>) -> Picture {
    let mut picture = Picture::new(&scene.world);
    let ending = if outing.contacts > 0 { "collided" } else { "no contact" };
    picture.title(format!("Random drive: {}, {ending}", counted(outing.paths.len(), "robot")));
    let share = share.map_or("-".into(), |share| format!("{:.0} %", 100.0 * share));
    picture.caption(format!(
        "{share} of the floor, {} turns, noise {}, seed {}",
        outing.turns, args.common.noise, args.common.seed
    ));
    for (robot, path) in scene.robots.iter().zip(&outing.paths) {
        picture.mark(Mark::Start, robot.pose.position()).drive(path, &robot.spec.footprint);
    }
    draw_contacts(&mut picture, &outing.contact_places);
    picture
}
