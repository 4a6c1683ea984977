use std::sync::Arc;

use roverlab::drive::CruiseParameters;
use roverlab::geometry::{Point, units};
use roverlab::io::sim::SimOptions;
use roverlab::picture::{Figure, Mark, Picture, SERIES, Style};
use roverlab::random::Stream;
use roverlab::world::{RobotPlacement, RobotSpec, Scene};

use super::campaign;
use super::scene::{Mode, Pattern, behind, hall};
use super::swarm::{SwarmRun, run};
use crate::common::{
    CommonArgs, Failure, FreeFloor, OF_ONE_RUN, OF_PARTS, Outcome, PartArgs, Report, StandIn, millimetres,
    rounded,
};
use crate::driving::{counted, draw_contacts, paced};

/// Command line of `follow-me`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Lets robots follow a leader: one by lidar, five by raised lidars, a chain, or a formation by radio",
    after_help = "\
Without --world, a LabBot leads round a hall that depends on the seed. With --world, the first robot of a .sim leads and
all others follow; letters in a maze represent robots. In a world with at most one robot, --followers robots are placed
behind the leader at its place, or behind a LabBot at --start. It leads past the world's markers, or without markers
past the corners of the floor.

--robios and --fault are rejected, because they apply to a single robot.

With --campaign, many seeds for one follower, five, five among obstacles, five by radio, and a chain of 20, and for one and
five behind leaders that drive in other patterns.

JSON fields:
  followers, mode             their number, and how they follow: lidar, raised, chain or radio
  lost                        number of those that were three times as far away as required after the first 10 s, or have not
                              seen the robot ahead for the last three seconds, or by radio were over 0.9 m from their place
                              for half of the time
  pattern                     how the leader drives
  mean_gap_mm, max_gap_mm     distance to the robot ahead, after the first 10 s, or null
  obstacles                   number of objects in the world
  time_limit_s, picture
  rows                        with --campaign only: the table
Collisions are those of all robots; pose, odometry and path length are the leader's.
Outcomes: followed, lost, blocked (the leader found no way: it drove less than a third of the possible distance, and did not
come by all markers), timed_out (in the first 10 s), collided; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Number of followers [default: those of the world, or 1].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=100), allow_hyphen_values = true)]
    pub(crate) followers: Option<u16>,

    /// How the followers locate the leader [default: lidar for one, raised up to five, chain beyond].
    #[arg(long, value_enum)]
    pub(crate) mode: Option<Mode>,

    /// How the leader of the hall drives.
    #[arg(long, value_enum, default_value = "round")]
    pub(crate) pattern: Pattern,

    /// Number of cans on the leader's way.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=50), allow_hyphen_values = true)]
    pub(crate) obstacles: u16,

    /// Drive with many seeds and print a table.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Number of seeds in a campaign.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) runs: u64,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("campaign", OF_ONE_RUN),
    ("campaign", &["followers", "mode", "obstacles", "pattern"]),
    ("!campaign", &["runs"]),
    ("!campaign", OF_PARTS),
]);

/// Simulated time of a run (s).
pub(super) const SECONDS: f64 = 90.0;

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    let common = &args.common;
    refuse(common)?;
    if args.campaign {
        return campaign(args);
    }
    common.check_picture()?;
    let (scene, waypoints) = scene(args)?;
    let followers = scene.robots.len() - 1;
    let mode = args.mode.unwrap_or(Mode::for_followers(followers));
    let seconds = common.time_limit.unwrap_or(SECONDS);
    let options = SimOptions::with_noise(common.noise, common.seed);
    let mut fleet = common.fleet(&scene, options)?;
    let run = run(&mut *fleet, &scene, &waypoints, (mode, args.pattern), seconds, paced(common))?;
    drop(fleet);
    let outcome = match () {
        () if run.is_leader_held() && !has_come_by(&scene, &run) => Outcome::failure("blocked"),
        () if run.lost.is_empty() && !run.has_formed() => Outcome::failure("timed_out"),
        () if run.lost.is_empty() => Outcome::verdict("followed"),
        () => Outcome::failure("lost"),
    };
    let leader = run.paths[0].last().map(|(_, pose)| *pose);
    let report = Report {
        sim_time: Some(run.sim_time),
        collisions: Some(run.contacts),
        path_length: Some(run.leader_path),
        pose: leader,
        odometry: run.odometry.first().copied(),
        ..Report::new(outcome)
    }
    .field("followers", followers)
    .field("mode", mode.name())
    .field("pattern", args.pattern.name())
    .field("lost", run.lost.len())
    .field("mean_gap_mm", run.has_formed().then(|| millimetres(run.mean_gap)))
    .field("max_gap_mm", run.has_formed().then(|| millimetres(run.largest_gap)))
    .field("obstacles", scene.world.objects.len())
    .field("time_limit_s", rounded(seconds));
    Ok(common.draw(report, "follow_me.svg", || picture(args, &scene, &run, mode)))
}

/// Whether the leader has come by all of a world's markers, so that it found its way, however short.
fn has_come_by(scene: &Scene, run: &SwarmRun) -> bool {
    let near = CruiseParameters::default().arrival;
    let is_passed = |place: Point| run.paths[0].iter().any(|(_, pose)| pose.distance_to(place) <= near);
    let markers = &scene.world.markers;
    !markers.is_empty() && markers.iter().all(|marker| is_passed(marker.position))
}

/// Rejects options that the robots of a fleet do not support.
fn refuse(common: &CommonArgs) -> Result<(), Failure> {
    let given = [
        ("--fault", !common.fault.is_empty()),
        ("--goal", common.goal.is_some()),
        ("--start", common.start.is_some() && common.world.is_none()),
        ("--robot", common.robot.is_some()),
    ];
    match given.into_iter().find(|(_, given)| *given) {
        Some((option, _)) => Err(Failure::input(format!(
            "{option}: found it for several robots in one thread; expected a command line without {option}"
        ))),
        None => Ok(()),
    }
}

/// The robots in their world, and the leader's waypoints.
fn scene(args: &Args) -> Result<(Scene, Vec<Point>), Failure> {
    let common = &args.common;
    let wanted = args.followers.map(usize::from);
    let followers = wanted.unwrap_or(1);
    let mode = args.mode.unwrap_or(Mode::for_followers(followers));
    let Some(file) = &common.world else {
        return Ok(hall((mode, args.pattern), followers, usize::from(args.obstacles), common.seed));
    };
    let mut scene = common.load_scene("world", file).map_err(Failure::input)?;
    if scene.robots.len() < 2 {
        let leader = StandIn { spec: RobotSpec::labbot().into(), ..StandIn::default() };
        scene = common.placed_in(scene, &leader)?;
        add_followers(&mut scene, mode, followers, common.seed)?;
    }
    let found = scene.robots.len() - 1;
    if let Some(wanted) = wanted.filter(|&wanted| wanted != found) {
        return Err(Failure::input(format!(
            "--followers {wanted}: found {found} in {}; expected the same, or none in the file",
            file.display()
        )));
    }
    if let Some(start) = common.start {
        scene.robots[0].pose = start;
    }
    let markers: Vec<Point> = scene.world.markers.iter().map(|marker| marker.position).collect();
    let waypoints = if markers.is_empty() { corners(&scene) } else { markers };
    Ok((scene, waypoints))
}

/// Places followers behind the leader of a scene, or where there is room.
fn add_followers(scene: &mut Scene, mode: Mode, followers: usize, seed: u64) -> Result<(), Failure> {
    let start = scene.robots[0].pose;
    let mut stream = Stream::new(seed).child("followers", 0);
    let spec = mode.spec();
    let free = FreeFloor::new(scene, &spec);
    for wished in behind(start, mode, followers, &mut stream) {
        let place = free.place(scene, &spec, wished).ok_or_else(|| {
            let number = scene.robots.len();
            Failure::input(format!(
                "--followers: found no room for follower {number}; expected fewer of them"
            ))
        })?;
        scene.robots.push(RobotPlacement::new(Arc::clone(&spec), place));
    }
    Ok(())
}

/// Points well inside the corners of the floor, counter-clockwise.
fn corners(scene: &Scene) -> Vec<Point> {
    let floor = scene.world.floor;
    let inset = (0.25 * floor.size().x.min(floor.size().y)).min(1.0);
    let inner = floor.inflated(-inset);
    let (low, high) = (inner.min, inner.max);
    vec![high, Point::new(low.x, high.y), low, Point::new(high.x, low.y)]
}

/// Paths of all robots, and their final poses.
fn picture(args: &Args, scene: &Scene, run: &SwarmRun, mode: Mode) -> Picture {
    let mut picture = Picture::new(&scene.world);
    let followers = counted(scene.robots.len() - 1, "follower");
    let ending = if run.contacts > 0 {
        "collided"
    } else if run.lost.is_empty() {
        "none lost"
    } else {
        "some lost"
    };
    picture.title(format!("Follow me ({}): {followers}, {ending}", mode.name()));
    picture.caption(format!(
        "mean gap {:.0} mm; {:.0} s, noise {}, seed {}",
        units::to_mm(run.mean_gap),
        run.sim_time,
        args.common.noise,
        args.common.seed
    ));
    for (index, (robot, path)) in scene.robots.iter().zip(&run.paths).enumerate() {
        let name = if index == 0 { "leader".into() } else { format!("follower {index}") };
        let style =
            Style::new(SERIES[index % SERIES.len()]).width(if index == 0 { 3.0 } else { 1.6 }).labelled(name);
        picture.trace(path.iter().map(|(time, pose)| (*time, pose.position())), style.clone());
        let figure = Figure::Robot { poses: path.clone(), footprint: robot.spec.footprint };
        picture.add(figure, style);
    }
    picture.mark(Mark::Start, scene.robots[0].pose.position());
    draw_contacts(&mut picture, &run.contact_places);
    picture
}
