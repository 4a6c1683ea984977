use roverlab::drive::{WallOutcome, WallSensors, WallSide};
use roverlab::geometry::units;
use roverlab::io::sim::NoiseModel;
use roverlab::random::Stream;
use roverlab::world::generate::{self, RoomOptions};
use roverlab::world::{RobotSpec, Scene};

use super::drive::{Options, Walk, drive};
use super::{Args, Watch, campaign, picture};
use crate::common::{Failure, Outcome, Report, millimetres, rounded};
use crate::driving::{Conditions, Run, paced};

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let own = || scene(common.seed);
    let scene = common.placed_without_goal("following a wall leads round it", own)?;
    let conditions = Conditions::new(common, time_limit(args, &scene))?;
    let (run, watch) = run(args, &scene, &conditions, paced(common))?;
    let report = report(args, &run, &watch).field("time_limit_s", conditions.time_limit);
    Ok(common.draw(report, "wall_following.svg", || picture::of(args, &scene, &run, &watch, &conditions)))
}

/// The room of a seed, with an S4.
pub(super) fn scene(seed: u64) -> Scene {
    let mut stream = Stream::new(seed).child("room", 0);
    let room = generate::room(&mut stream, &RoomOptions::default()).expect("default options are valid");
    Scene::with_robot(room.world, RobotSpec::s4(), room.start)
}

/// Time for all walls at half the speed, for each lap and for the search (s).
pub(super) fn time_limit(args: &Args, scene: &Scene) -> f64 {
    let walls: f64 = scene.world.walls.iter().map(|wall| wall.line.length() + 0.1).sum();
    let speed = units::from_mm(args.speed);
    (60.0 + 2.5 * f64::from(args.laps + 1) * walls / speed).ceil().min(1e6)
}

/// Lets the robot follow the wall.
pub(super) fn run(
    args: &Args,
    scene: &Scene,
    conditions: &Conditions,
    mut pace: impl FnMut(f64),
) -> Result<(Run<Walk>, Watch), Failure> {
    let spec = &scene.robots[0].spec;
    let options = Options {
        controller: args.controller,
        side: args.side.side(),
        distance: units::from_mm(args.distance),
        speed: units::from_mm(args.speed),
        radius: spec.footprint.bounding_radius(),
        range_error: NoiseModel::real().scaled(conditions.noise).range,
        sensors: WallSensors::of(spec).map_err(Failure::input)?,
        time_limit: conditions.time_limit,
    };
    let mut watch = Watch::new(scene, options.distance, args.laps);
    let run = conditions.run_watched(scene, &mut pace, |robot, step| {
        drive(robot, &options, &mut |beside| watch.see(step(), beside))
    })?;
    Ok((run, watch))
}

fn report(args: &Args, run: &Run<Walk>, watch: &Watch) -> Report {
    let report = run.report(|walk| match walk.outcome {
        WallOutcome::Stopped => Outcome::verdict("followed"),
        WallOutcome::Blocked => Outcome::failure("blocked"),
        _ => Outcome::failure("timed_out"),
    });
    let side = run.ending.as_ref().ok().and_then(|walk| walk.side);
    let away = &watch.away_from_corners;
    let rms = away.rms();
    report
        .field("controller", args.controller.name())
        .field("side", side.map(|side| if side == WallSide::Left { "left" } else { "right" }))
        .field("laps", watch.laps)
        .field("rms_error_mm", rms.map(millimetres))
        .field("max_error_mm", rms.map(|_| millimetres(away.worst)))
        .field("rms_error_everywhere_mm", watch.everywhere.rms().map(millimetres))
        .field("lap_length_mm", watch.lap_length.map(|length| rounded(units::to_mm(length))))
}
