//! The command `coverage`.

mod campaign;
mod rooms;

pub(crate) use campaign::campaign;
#[cfg(test)]
pub(crate) use campaign::{row, text};

use std::sync::Arc;

use roverlab::drive::{
    CoverageMap, CoverageMapParameters, CoveragePlan, RandomDrive, RandomDriveParameters, Tour, TourOutcome,
    TourParameters,
};
use roverlab::geometry::{Point, Pose, units};
use roverlab::io::control::{self, SensedBy};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{self, Clock, Drive, Lidar, LidarScan, Odometry};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::random::Stream;
use roverlab::scan::Localiser;
use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, Wall, World};

use crate::common::{CommonArgs, Failure, OF_ONE_RUN, OF_PARTS, Outcome, PartArgs, Report, rounded};
use crate::driving::{
    Conditions, Run, check_level_lidar, draw_contacts, localisation_map, paced, world_with_others,
};

/// Command line of `coverage`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Covers the floor of a known room in parallel lanes, like a lawn mower",
    after_help = "\
Without --world, the room has a projecting wall and two crates. The robot knows the world and its start, and tracks its
pose by matching scans. The coverable floor is what is under the robot wherever it can be 15 mm away from all obstacles.

With --campaign, rooms of many sizes with projecting walls, crates and cans.

JSON fields:
  coverage_percent            fraction of that floor that it has truly passed over
  area_m2                     area of that floor
  planned_length_mm           length of the plan
  path_ratio                  true path length relative to area divided by the robot's width
  random_drive_percent        coverage of a random drive of the same duration
  time_limit_s, picture
  rows                        with --campaign only: the table
Outcomes: covered (98 % or more), incomplete, timed_out, collided, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Cover many rooms and print a table.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Number of rooms in a campaign.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) rooms: u64,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("campaign", OF_ONE_RUN),
    ("!campaign", &["rooms"]),
    ("!campaign", OF_PARTS),
]);

/// Sufficient fraction of the floor.
const ENOUGH: f64 = 0.98;
/// Number of steps between scans.
const EVERY: u32 = 3;

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    let common = &args.common;
    if args.campaign {
        return campaign(args);
    }
    common.check_picture()?;
    let scene = &common.placed_without_goal("the robot goes everywhere", scene)?;
    check_level_lidar(scene)?;
    let done = cover(scene, |limit| Conditions::new(common, limit), paced(common))?;
    let Covered { plan, run, map, ratio, .. } = &done;
    let report = run.report(|outcome| match outcome {
        TourOutcome::TimedOut => Outcome::failure("timed_out"),
        _ if map.share() >= ENOUGH => Outcome::verdict("covered"),
        _ => Outcome::failure("incomplete"),
    });
    let report = report
        .field("coverage_percent", rounded(100.0 * map.share()))
        .field("area_m2", rounded(map.area()))
        .field("planned_length_mm", rounded(units::to_mm(plan.length())))
        .field("path_ratio", rounded(*ratio))
        .field("random_drive_percent", rounded(100.0 * done.random))
        .field("time_limit_s", done.time_limit);
    Ok(common.draw(report, "coverage.svg", || picture(args, scene, &done)))
}

/// Result in a room.
pub(crate) struct Covered {
    pub(crate) plan: CoveragePlan,
    pub(crate) run: Run<TourOutcome>,
    /// The covered floor, and the fraction covered by a random drive in the same time.
    pub(crate) map: CoverageMap,
    pub(crate) random: f64,
    /// Path length divided by area over width.
    pub(crate) ratio: f64,
    pub(crate) time_limit: f64,
}

/// Lets the robot cover its floor, and measures the result. `conditions` are given for a time limit.
pub(crate) fn cover(
    scene: &Scene,
    conditions: impl FnOnce(f64) -> Result<Conditions, Failure>,
    pace: impl FnMut(f64),
) -> Result<Covered, Failure> {
    let (start, radius) = (scene.robots[0].pose, scene.robots[0].spec.footprint.bounding_radius());
    let parameters = CoverageMapParameters { radius, ..CoverageMapParameters::default() };
    let world = world_with_others(scene);
    let mut map = CoverageMap::new(&world, start.position(), parameters).map_err(Failure::input)?;
    let plan = CoveragePlan::new(&map, start.position()).map_err(Failure::input)?;
    let tour = TourParameters::default();
    let limit = 60.0 + 3.0 * plan.length() / tour.speed + 4.0 * plan.points().len() as f64;
    let conditions = conditions(limit.ceil())?;
    let mut localiser = localisation_map(scene)
        .and_then(|map| Localiser::new(map, conditions.localiser(&scene.robots[0].spec)))
        .map_err(Failure::input)?;
    localiser.start_at(start);
    let mut tour = Tour::new(plan.points(), tour).map_err(Failure::input)?;
    let limit = conditions.time_limit;
    let run =
        conditions.run(scene, pace, |robot, step| drive(robot, &mut localiser, &mut tour, limit, step))?;
    run.positions().for_each(|place| map.cover(place));
    let random = random_share(&conditions, scene, &map, run.sim_time)?;
    let ratio = run.truth.path_length * 2.0 * radius / map.area();
    Ok(Covered { plan, run, map, random, ratio, time_limit: conditions.time_limit })
}

/// A room with a projecting wall and two crates.
fn scene() -> Scene {
    let mut world = World::walled(3.2, 2.4);
    let kind = ObjectKind::predefined("crate").map(|kind| Arc::new(ObjectKind { fixed: true, ..kind }));
    for (x, y, heading) in [(0.9, 0.8, 0.3), (2.2, 1.7, 0.0)] {
        world.objects.extend(kind.iter().map(|kind| Object::new(Arc::clone(kind), Pose::new(x, y, heading))));
    }
    world.walls.push(Wall::new(Point::new(2.3, 0.0), Point::new(2.3, 0.9)));
    Scene::with_robot(world, RobotSpec::s4(), Pose::new(0.2, 0.2, 0.0))
}

/// Drives a tour. `watch` is called after each step.
fn drive<R: Clock + Drive + Odometry + Lidar + ?Sized>(
    robot: &mut R,
    localiser: &mut Localiser,
    tour: &mut Tour,
    time_limit: f64,
    mut watch: impl FnMut(),
) -> io::Result<TourOutcome> {
    let (mut scan, mut steps) = (LidarScan::default(), 0_u32);
    let locate = |robot: &mut R, _, place: &mut Option<Pose>| {
        let odometry = robot.pose()?;
        if steps.is_multiple_of(EVERY) {
            robot.scan_into(&mut scan)?;
            localiser.update(odometry, &scan)?;
        }
        steps += 1;
        *place = localiser.place(odometry);
        Ok(())
    };
    control::run(robot, &mut SensedBy::new(tour, locate), time_limit, |_, _, _| watch())
}

/// Fraction covered by a random drive in the same time.
fn random_share(
    conditions: &Conditions,
    scene: &Scene,
    map: &CoverageMap,
    seconds: f64,
) -> Result<f64, Failure> {
    let parameters = *map.parameters();
    let start = scene.robots[0].pose.position();
    let mut map = CoverageMap::new(&world_with_others(scene), start, parameters).map_err(Failure::input)?;
    let options = SimOptions::with_noise(conditions.noise, conditions.seed);
    let simulation = Simulation::new(scene, options).map_err(Failure::input)?;
    let truth = simulation.truth();
    let random = RandomDriveParameters { radius: parameters.radius, ..RandomDriveParameters::default() };
    let stream = Stream::new(conditions.seed).child("random drive", 0);
    let mut drive = RandomDrive::new(random, stream).map_err(Failure::input)?;
    let mut robot = simulation.robot(0).map_err(Failure::input)?;
    control::run(&mut robot, &mut drive, seconds, |_, _, _| {
        if let Ok(pose) = truth.pose(0) {
            map.cover(pose.position());
        }
    })?;
    Ok(map.share())
}

/// Plan, path, and uncovered floor.
fn picture(args: &Args, scene: &Scene, done: &Covered) -> Picture {
    let Covered { plan, run, map, ratio, .. } = done;
    let mut picture = Picture::new(&scene.world);
    picture.title(format!("Coverage: {:.1} % of the floor", 100.0 * map.share()));
    picture.caption(format!(
        "path {ratio:.2} times area over width; {:.0} s, noise {}, seed {}",
        run.sim_time, args.common.noise, args.common.seed
    ));
    let left_out = Style::new(Colour::from_hex(0xd0_20_20)).labelled("left out");
    picture.line(plan.points().iter().copied(), Style::plan());
    picture.points(map.cells(false), left_out);
    picture.drive(&run.trail, &scene.robots[0].spec.footprint);
    picture.mark(Mark::Start, scene.robots[0].pose.position());
    draw_contacts(&mut picture, &run.truth.contact_places);
    picture
}
