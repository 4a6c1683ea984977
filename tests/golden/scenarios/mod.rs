//! Whole runs of every system and the logs that they leave. No test harness is needed, so that a plain
//! program can run them on any platform.

#![allow(clippy::unnecessary_wraps, reason = "the table holds functions of one type")]

mod bugs;
mod cameras;
mod driving;
mod evolution;
mod grids;
mod hills;
mod loops;
mod marine;
mod mazes;
mod pictures;
mod races;
mod recordings;
mod safety;
mod scans;
pub(crate) mod simulator;
mod swarms;
mod tracks;
mod vision;
mod walls;
mod worlds;
mod wrappers;

use std::fmt::{Debug, Write as _};
use std::sync::Arc;

use roverlab::geometry::{Point, Pose};
use roverlab::io::sim::{NoiseModel, RobotTruth, SimOptions, SimRobot, Simulation};
use roverlab::io::wrappers::Traced;
use roverlab::io::{Error, ErrorKind, Result};
use roverlab::world::{Object, ObjectKind, RobotSpec, Scene, Wall, World};

/// A named run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scenario {
    /// What the file of digests calls it.
    pub(crate) name: &'static str,
    /// The run, or why there is none here.
    run: std::result::Result<fn() -> Result<String>, &'static str>,
}

impl Scenario {
    const fn new(name: &'static str, run: fn() -> Result<String>) -> Self {
        Self { name, run: Ok(run) }
    }

    /// A run of robots in threads, which WebAssembly does not start.
    const fn threaded(name: &'static str, run: fn() -> Result<String>) -> Self {
        let lacks = "there are no threads on this platform";
        Self { name, run: if cfg!(target_family = "wasm") { Err(lacks) } else { Ok(run) } }
    }

    /// A run of what this program was built without.
    #[allow(dead_code, reason = "tests are built with all features")]
    const fn without(name: &'static str, lacks: &'static str) -> Self {
        Self { name, run: Err(lacks) }
    }

    /// Why it cannot run here, if it cannot.
    pub(crate) fn lacks(&self) -> Option<&'static str> {
        self.run.err()
    }

    /// The run's log: what was commanded, measured and decided, and then the ground truth.
    pub(crate) fn log(&self) -> Result<String> {
        self.run.map_err(Error::unsupported)?()
    }
}

/// All scenarios, in the order of the file of digests.
pub(crate) fn scenarios() -> impl Iterator<Item = &'static Scenario> {
    let wings = [
        simulator::SCENARIOS,
        cameras::SCENARIOS,
        wrappers::SCENARIOS,
        recordings::SCENARIOS,
        worlds::SCENARIOS,
        driving::SCENARIOS,
        walls::SCENARIOS,
        swarms::SCENARIOS,
        safety::SCENARIOS,
        bugs::SCENARIOS,
        grids::SCENARIOS,
        hills::SCENARIOS,
        scans::SCENARIOS,
        mazes::SCENARIOS,
        tracks::SCENARIOS,
        races::SCENARIOS,
        vision::SCENARIOS,
        evolution::SCENARIOS,
        loops::SCENARIOS,
        marine::SCENARIOS,
        pictures::SCENARIOS,
    ];
    wings.into_iter().flatten()
}

/// The 64-bit FNV-1a digest of a log.
pub(crate) fn digest(log: &str) -> u64 {
    fnv(log.bytes())
}

/// The same digest of other bytes, for a log that has no room for them all.
fn fnv(bytes: impl IntoIterator<Item = u8>) -> u64 {
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// The simulated robot that the programs below talk to.
type Robot = Traced<SimRobot, Vec<u8>>;

/// Lets one robot's program run and returns its log, with every range of every scan.
fn drive(
    scene: &Scene,
    options: SimOptions,
    program: impl FnOnce(&mut Robot) -> Result<()>,
) -> Result<String> {
    recorded(scene, options, Robot::whole_scans, program)
}

/// The same with a digest of each scan in its place, for long runs.
fn ride(
    scene: &Scene,
    options: SimOptions,
    program: impl FnOnce(&mut Robot) -> Result<()>,
) -> Result<String> {
    recorded(scene, options, |robot| robot, program)
}

fn recorded(
    scene: &Scene,
    options: SimOptions,
    prepare: impl FnOnce(Robot) -> Robot,
    program: impl FnOnce(&mut Robot) -> Result<()>,
) -> Result<String> {
    let simulation = Simulation::new(scene, options)?;
    let mut robot = prepare(Traced::new(simulation.robot(0)?, Vec::new()));
    program(&mut robot)?;
    let mut log = text(robot)?;
    note_truth(&mut log, &simulation.truth().robot(0)?);
    Ok(log)
}

/// Ends a robot's program and returns its trace.
fn text<R>(robot: Traced<R, Vec<u8>>) -> Result<String> {
    let (_robot, written) = robot.finish();
    written.map_err(other).and_then(|bytes| String::from_utf8(bytes).map_err(other))
}

fn note_truth(log: &mut String, truth: &RobotTruth) {
    let RobotTruth { pose, odometry, contacts, contact_places, path_length, trail } = truth;
    note(log, "pose", pose);
    note(log, "odometry", odometry);
    note(log, "contacts", contacts);
    note(log, "contact places", contact_places);
    note(log, "path length", path_length);
    note(log, "trail", trail);
}

/// Adds a line. Numbers are written with all their digits.
fn note(log: &mut String, what: &str, value: &dyn Debug) {
    // Writing to a string cannot fail.
    let _ = writeln!(log, "{what}: {value:?}");
}

fn other(error: impl std::error::Error) -> Error {
    Error::new(ErrorKind::Other, error.to_string())
}

fn noise(factor: f64, seed: u64) -> SimOptions {
    SimOptions { trail_interval: Some(0.5), ..SimOptions::with_noise(factor, seed) }
}

fn textbook(seed: u64) -> SimOptions {
    SimOptions { noise: NoiseModel::textbook(), ..noise(0.0, seed) }
}

/// A room of 3 m by 2 m with a wall in its middle, a crate, a can and a ball.
fn room() -> World {
    let mut world = World::walled(3.0, 2.0);
    world.walls.push(Wall::new(Point::new(1.4, 0.7), Point::new(1.7, 1.2)));
    for (name, x, y, heading) in [("crate", 2.3, 0.5, 0.4), ("can", 0.7, 1.5, 0.0), ("soccer", 2.2, 1.5, 0.0)]
    {
        let kind = ObjectKind::predefined(name).expect("the kind is predefined");
        world.objects.push(Object::new(Arc::new(kind), Pose::new(x, y, heading)));
    }
    world
}

fn in_room(x: f64, y: f64, heading: f64) -> Scene {
    Scene::with_robot(room(), RobotSpec::s4(), Pose::new(x, y, heading))
}
