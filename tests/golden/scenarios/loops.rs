//! How the loops that run behaviours begin and end: at the time limit, blocked, with a sensor, link or clock
//! that fails, and at the end of the simulation.

use std::thread;

use roverlab::drive::colour::{ColourTracker, ColourTrackerParameters, PushHome, PushHomeParameters};
use roverlab::drive::motion_watch::{MotionWatch, MotionWatchParameters};
use roverlab::drive::{
    AToB, AToBParameters, AlongWall, CarDriver, CarToB, CarToBParameters, Chase, ChaseParameters, Goal,
    LidarWallFollower, LidarWallFollowerParameters, Method, OmniDriver, OmniParameters, OmniTracker,
    RandomDrive, RandomDriveParameters, WallFollower, WallFollowerParameters,
};
use roverlab::evolve::Gait;
use roverlab::geometry::{Point, Pose, Twist};
use roverlab::io::control::{run, until};
use roverlab::io::sim::{SimOptions, SimRobot, Simulation};
use roverlab::io::wrappers::{Faulty, Traced};
use roverlab::io::{Clock, DistanceSensors, Drive, Keys, Lidar, Manoeuvres, Odometry, Psd, Radio, Result};
use roverlab::kinematics::{Ackermann, Omni};
use roverlab::maze::{Direction, LeftHand, LeftHandParameters, LidarLeft, LidarLeftParameters};
use roverlab::nav::{BugKind, BugParameters, DistBug, Navigator, NavigatorParameters};
use roverlab::race::{Cone, ConeTrack, EventParameters, EventRacer, GapDriver, Racer, RacerParameters};
use roverlab::random::Stream;
use roverlab::vision::{CameraGeometry, ColourFinder, FindMethod};
use roverlab::world::{RobotSpec, Scene, World};

use super::{Scenario, noise, note, note_truth, other, room, text};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("run-loops", robots),
    Scenario::new("race-run-loops", cars),
    Scenario::threaded("race-shared", shared),
];

/// The robot that the loops run.
type Robot = Traced<Faulty<SimRobot>, Vec<u8>>;

/// A loop, and what it gives back.
type Loop = (&'static str, fn() -> RobotSpec, fn(&mut Robot) -> Result<String>);

/// A fault, a world, and the seconds that it lasts.
type Circumstance = (&'static str, fn() -> World, f64);

/// Seconds that loops are given, and where to they drive.
const LIMIT: f64 = 2.5;
const GOAL: Point = Point::new(1.0, 0.4);

const LOOPS: [Loop; 20] = [
    ("turn", RobotSpec::s4, |robot| a_to_b(Method::Turn, robot)),
    ("spline", RobotSpec::s4, |robot| a_to_b(Method::Spline, robot)),
    ("by another estimate", RobotSpec::s4, |robot| {
        let mut behaviour = AToB::new(Method::Arc, Goal::point(GOAL), AToBParameters::default())?;
        let estimate = |robot: &mut Robot| Ok(robot.pose()?.compose(&Pose::new(0.01, 0.0, 0.0)));
        said(run(robot, &mut behaviour.by(estimate), LIMIT, |_, _, _| {})?)
    }),
    ("chase", RobotSpec::s4, |robot| {
        let mut behaviour = Chase::new(Method::Dog, ChaseParameters::default())?;
        let goal = |_: &mut Robot, time| Ok(Pose::new(0.4 + 0.1 * time, 0.2, 0.0));
        said(run(robot, &mut behaviour.after(goal), LIMIT, |_, _, _| {})?)
    }),
    ("car", RobotSpec::car, |robot| {
        let kinematics = Ackermann::new(0.12, 0.1, 0.5).map_err(other)?;
        let driver = CarDriver::new(kinematics, 0.5)?;
        let mut behaviour = CarToB::new(Method::Arc, Goal::point(GOAL), driver, CarToBParameters::default())?;
        said(run(robot, &mut behaviour, LIMIT, |_, _, _| {})?)
    }),
    ("Mecanum", RobotSpec::omni, |robot| {
        let kinematics = Omni::mecanum(0.2, 0.2).map_err(other)?;
        let tracker = OmniTracker::new(robot.pose()?, &[GOAL], OmniParameters::default())?;
        let driver = OmniDriver::new(kinematics, 0.5)?;
        said(run(robot, &mut tracker.by(driver), LIMIT, |_, _, _| {})?)
    }),
    ("wall", RobotSpec::s4, |robot| {
        let mut along = AlongWall::new(WallFollower::new(WallFollowerParameters::default())?);
        said(run(robot, &mut along, LIMIT, |_, _, _| {})?)
    }),
    ("wall, stopped", RobotSpec::s4, |robot| {
        let mut along = AlongWall::new(LidarWallFollower::new(LidarWallFollowerParameters::default())?);
        said(run(robot, &mut along, LIMIT, |_, _, step| until(step.time > 1.0))?)
    }),
    ("random", RobotSpec::s4, |robot| {
        let mut behaviour = RandomDrive::new(RandomDriveParameters::default(), Stream::new(181))?;
        said(run(robot, &mut behaviour, LIMIT, |_, _, _| {})?)
    }),
    ("left hand", RobotSpec::s4, |robot| {
        let mut rule = LeftHand::new(LeftHandParameters::as_printed(), Direction::North)?;
        said(run(robot, &mut rule, LIMIT, |_, rule, _| until(rule.at().0.abs() + rule.at().1.abs() > 1))?)
    }),
    ("left by lidar", RobotSpec::s4, |robot| {
        let mut follower = LidarLeft::new(LidarLeftParameters::for_corridor(0.36))?;
        said(run(robot, &mut follower, LIMIT, |_, _, step| {
            let pose = step.seen.pose;
            until(pose.x * pose.x + pose.y * pose.y > 0.04)
        })?)
    }),
    ("bug", RobotSpec::s4, |robot| {
        let mut bug = BugKind::Bug2.with(GOAL, BugParameters::default())?;
        said(run(robot, bug.as_mut(), LIMIT, |_, _, _| {})?)
    }),
    ("DistBug", RobotSpec::s4, |robot| {
        said(run(robot, &mut DistBug::new(GOAL, BugParameters::default())?, LIMIT, |_, _, _| {})?)
    }),
    ("navigate", RobotSpec::s4, |robot| {
        let goal = Point::new(1.4, 0.9);
        let mut navigator = Navigator::new(&room(), START, goal, NavigatorParameters::default())?;
        said(run(robot, &mut navigator, LIMIT, |_, _, _| {})?)
    }),
    ("colour", RobotSpec::s4, |robot| {
        let mut tracker = ColourTracker::new(finder()?, ColourTrackerParameters::default())?;
        said(run(robot, &mut tracker, LIMIT, |_, _, _| {})?)
    }),
    ("home", RobotSpec::s4, |robot| {
        let mut push = PushHome::new(finder()?, Point::origin(), PushHomeParameters::default())?;
        said(run(robot, &mut push, LIMIT, |_, _, _| {})?)
    }),
    ("motion", RobotSpec::s4, |robot| {
        let mut watch = MotionWatch::new(MotionWatchParameters::new(1.0)).map_err(other)?;
        said(run(robot, &mut watch, LIMIT, |_, _, _| {})?)
    }),
    ("gait", RobotSpec::s4, |robot| {
        let gait = Gait::from_bytes(&[30, 128, 200, 40, 128, 90], 2, 1)?;
        gait.settle(robot)?;
        said(gait.walk(robot, LIMIT)?)
    }),
    ("gap", RobotSpec::car, |robot| said(run(robot, &mut GapDriver::with_speed(0.2)?, LIMIT, |_, _, _| {})?)),
    ("racer", RobotSpec::s4, |robot| {
        said(run(robot, &mut Racer::new(RacerParameters::default())?, LIMIT, |_, _, _| {})?)
    }),
];

const START: Pose = Pose::new(0.5, 0.5, 0.3);

fn said(outcome: impl std::fmt::Debug) -> Result<String> {
    Ok(format!("{outcome:?}"))
}

fn a_to_b(method: Method, robot: &mut Robot) -> Result<String> {
    let mut behaviour = AToB::new(method, Goal::point(GOAL), AToBParameters::default())?;
    said(run(robot, &mut behaviour, LIMIT, |_, _, _| {})?)
}

fn finder() -> Result<ColourFinder> {
    let camera = RobotSpec::s4().camera.expect("the robot has a camera");
    ColourFinder::new(42, 10, FindMethod::Blob, CameraGeometry::from(&camera)).map_err(other)
}

/// Every loop under every circumstance, begun when the robot's clock has gone on a little.
fn robots() -> Result<String> {
    let free = || room();
    let tight = || World::walled(0.24, 0.24);
    let circumstances: [Circumstance; 6] = [
        ("", free, 12.0),
        ("", tight, 12.0),
        ("clock@1", free, 6.0),
        ("lost:all@1", free, 6.0),
        ("link@1-1.5", free, 6.0),
        ("", free, 1.3),
    ];
    let mut log = String::new();
    for (name, spec, run) in LOOPS {
        for (fault, world, time_limit) in &circumstances {
            let world = world();
            let middle = world.floor.min + 0.5 * world.floor.size();
            let place = if world.floor.size().x < 1.0 { Pose::new(middle.x, middle.y, 0.3) } else { START };
            let options = SimOptions { time_limit: Some(*time_limit), ..noise(1.0, 182) };
            let simulation = Simulation::new(&Scene::with_robot(world, spec(), place), options)?;
            let faults = if fault.is_empty() { Vec::new() } else { vec![fault.parse()?] };
            let mut robot = Traced::new(Faulty::new(simulation.robot(0)?, faults), Vec::new());
            robot.wait(0.37)?;
            let outcome = run(&mut robot).map_err(|error| (error.kind(), error.to_string()));
            log += &text(robot)?;
            note(&mut log, name, &(fault, outcome));
            note_truth(&mut log, &simulation.truth().robot(0)?);
        }
    }
    Ok(log)
}

/// Cars before two rows of cones.
fn lane(cars: &[Pose]) -> Scene {
    let rows = (0..30).flat_map(|k| [1.7, -1.7].map(|y| Point::new(3.5 * f64::from(k), y)));
    ConeTrack { cones: rows.map(Cone::unknown).collect(), ..ConeTrack::default() }.scene(cars)
}

/// The loops of racing cars.
fn cars() -> Result<String> {
    let scene = lane(&[Pose::new(-2.0, 0.2, 0.0)]);
    let mut log = String::new();
    for index in 0..3 {
        let race = Simulation::new(&scene, SimOptions { seed: 183, ..SimOptions::default() })?;
        let mut car = Traced::new(race.robot(0)?, Vec::new());
        car.wait(0.37)?;
        let (mut watched, limit) = (0, 6.0);
        let outcome = match index {
            0 => {
                let mut racer = Racer::new(RacerParameters::default())?;
                said(run(&mut car, &mut racer, limit, |_, _, _| watched += 1)?)
            }
            1 => {
                let mut racer = EventRacer::acceleration(EventParameters::default())?;
                said(run(&mut car, &mut racer, limit, |_, _, _| watched += 1)?)
            }
            _ => said(run(&mut car, &mut GapDriver::with_speed(0.2)?, limit, |_, _, _| watched += 1)?),
        };
        log += &text(car)?;
        note(&mut log, "outcome", &(outcome?, watched));
        note_truth(&mut log, &race.truth().robot(0)?);
    }
    Ok(log)
}

/// Two cars of one race, each in a thread of its own. Capabilities that they lack are errors.
fn shared() -> Result<String> {
    let scene = lane(&[0.4, -0.6].map(|y| Pose::new(-2.0 - 4.0 * y, y, 0.05)));
    let race = Simulation::new(&scene, SimOptions { seed: 184, ..SimOptions::default() })?;
    let drive = |mut robot: Traced<SimRobot, Vec<u8>>, speed: f64| -> Result<String> {
        for step in 0..80_u32 {
            robot.set_speed(Twist::new(speed, 0.2 * (f64::from(step % 7) - 3.0)))?;
            robot.pose()?;
            robot.scan()?;
            robot.wait(0.05)?;
        }
        let _ = (robot.radio_id(), robot.read_key(), robot.distance(Psd::FRONT), robot.turn(1.0, 1.0));
        text(robot)
    };
    let robots = [Traced::new(race.robot(0)?, Vec::new()), Traced::new(race.robot(1)?, Vec::new())];
    let mut log = String::new();
    let logs = thread::scope(|scope| {
        let [first, second] = robots;
        let second = scope.spawn(|| drive(second, 3.0));
        (drive(first, 7.0), second.join().expect("no thread panics"))
    });
    log += &logs.0?;
    log += &logs.1?;
    for index in 0..2 {
        note(&mut log, "time", &race.truth().time());
        note_truth(&mut log, &race.truth().robot(index)?);
    }
    Ok(log)
}
