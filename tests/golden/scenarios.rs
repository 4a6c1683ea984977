//! Ten whole runs and the logs that they leave. No test harness is needed, so that a plain program can run them on any
//! platform.

use std::fmt::{Debug, Write as _};
use std::ops::ControlFlow;
use std::sync::Arc;

use roverlab::geometry::{Point, Pose, Twist, units};
use roverlab::io::sim::{Fleet, NoiseModel, RobotTruth, SimOptions, SimRobot, Simulation};
use roverlab::io::wrappers::Traced;
use roverlab::io::{
    Clock, DistanceSensors, Drive, Encoders, Error, ErrorKind, Lidar, LidarSettings, Motors, Psd, Radio,
    Result,
};
use roverlab::nav::{DistBug, DistBugParameters};
use roverlab::random::Stream;
use roverlab::world::generate::{CourseOptions, obstacle_course};
use roverlab::world::{Object, ObjectKind, RobotPlacement, RobotSpec, Scene, Wall, World};

/// A named run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scenario {
    /// What the file of digests calls it.
    pub(crate) name: &'static str,
    /// Whether it drives robots from several threads.
    threads: bool,
    run: fn() -> Result<String>,
}

impl Scenario {
    /// Whether this platform can run it: WebAssembly starts no threads.
    pub(crate) fn runs_here(&self) -> bool {
        !(self.threads && cfg!(target_family = "wasm"))
    }

    /// The run's log: each call of each robot with its result, and then what is true about the robots.
    pub(crate) fn log(&self) -> Result<String> {
        (self.run)()
    }
}

/// All scenarios, in the order of the file of digests.
pub(crate) const SCENARIOS: [Scenario; 10] = [
    single("straight-and-turn", straight_and_turn),
    single("arcs", arcs),
    single("wall-bump", wall_bump),
    single("wandering", wandering),
    single("lidar", lidar),
    single("distbug-ideal", distbug_ideal),
    single("distbug-noise", distbug_noise),
    single("generated-course", generated_course),
    Scenario { name: "threads-and-radio", threads: true, run: threads_and_radio },
    single("fleet-of-50", fleet_of_50),
];

const fn single(name: &'static str, run: fn() -> Result<String>) -> Scenario {
    Scenario { name, threads: false, run }
}

/// The 64-bit FNV-1a digest of a log.
pub(crate) fn digest(log: &str) -> u64 {
    log.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// The simulated robot that the programs below talk to.
type Robot = Traced<SimRobot, Vec<u8>>;

/// Lets one robot's program run and returns its log. A scan is in it with every range.
fn drive(
    scene: &Scene,
    options: SimOptions,
    program: impl FnOnce(&mut Robot) -> Result<()>,
) -> Result<String> {
    let simulation = Simulation::new(scene, options)?;
    let mut robot = Traced::new(simulation.robot(0)?, Vec::new()).whole_scans();
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

/// The smallest program, without noise, with the real robot's and with the book's.
fn straight_and_turn() -> Result<String> {
    let scene = in_room(0.4, 0.4, 0.3);
    let mut log = String::new();
    for options in [noise(0.0, 11), noise(1.0, 11), textbook(11)] {
        log += &drive(&scene, options, |robot| {
            for (distance, angle) in [(0.5, 1.2), (0.3, -2.0), (-0.2, 3.0)] {
                robot.straight(distance, 0.3)?;
                robot.wait_done()?;
                robot.turn(angle, 1.5)?;
                robot.wait_done()?;
                robot.pose()?;
            }
            Ok(())
        })?;
    }
    Ok(log)
}

/// Curves and points to drive to, watched on the way, with odometry and encoders set anew.
fn arcs() -> Result<String> {
    drive(&in_room(0.8, 0.6, 0.0), noise(1.0, 12), |robot| {
        robot.curve(0.4, 1.1, 0.25)?;
        while !robot.is_done()? {
            robot.remaining()?;
            robot.speed()?;
            robot.wait(0.07)?;
        }
        robot.set_pose(Pose::new(1.0, 2.0, -0.5))?;
        robot.reset_encoder(1)?;
        for (forward, left) in [(0.2, 0.1), (0.1, -0.2), (-0.05, 0.1), (1e-7, 0.1)] {
            robot.drive_to(forward, left, 0.2)?;
            robot.wait_done()?;
            robot.pose()?;
            robot.encoder(1)?;
            robot.encoder(2)?;
        }
        robot.set_motor(1, 0.1)?;
        robot.set_motor(2, -0.05)?;
        robot.wait(1.0)
    })
}

/// Against walls, head on and at a slant, and against what stands about, until the robot stalls.
fn wall_bump() -> Result<String> {
    let options = SimOptions { time_limit: Some(20.0), ..noise(1.0, 13) };
    drive(&in_room(0.3, 1.0, 3.1), options, |robot| {
        for twist in [
            Twist::new(0.4, 0.0),
            Twist::new(-0.3, 0.4),
            Twist::new(0.5, -0.1),
            Twist::new(0.2, 1.0),
            Twist::new(0.6, 0.05),
        ] {
            robot.set_speed(twist)?;
            for _ in 0..6 {
                robot.wait(0.4)?;
                robot.is_stalled()?;
                robot.speed()?;
                robot.pose()?;
            }
        }
        // The log shows the time limit's error as well.
        match robot.wait(60.0) {
            Err(error) if error.kind() == ErrorKind::TimedOut => Ok(()),
            other => other,
        }
    })
}

/// One step of a robot that turns away from what its distance sensors see.
fn wander<R: DistanceSensors + Drive>(robot: &mut R, stream: &mut Stream) -> Result<()> {
    let ahead = robot.distance(Psd::FRONT)?;
    let (left, right) = (robot.distance(Psd::LEFT)?, robot.distance(Psd::RIGHT)?);
    let twist = if ahead < 0.15 {
        Twist::new(-0.05, if left > right { 2.0 } else { -2.0 })
    } else {
        let swerve = if left.min(right) < 0.1 { 4.0 * (left.min(0.5) - right.min(0.5)) } else { 0.0 };
        Twist::new((0.5 * ahead).min(0.3), swerve + stream.between(-0.8, 0.8))
    };
    robot.set_speed(twist)
}

fn wandering() -> Result<String> {
    drive(&in_room(0.5, 0.5, 1.0), noise(1.0, 14), |robot| {
        let mut stream = Stream::new(14).child("program", 0);
        for step in 0..240 {
            wander(robot, &mut stream)?;
            if step % 20 == 0 {
                robot.distance(Psd::BACK)?;
                robot.pose()?;
            }
            robot.wait(0.1)?;
        }
        Ok(())
    })
}

/// Scans from many places, all round, tilted, of a few beams, with twice the real robot's noise.
fn lidar() -> Result<String> {
    let settings = |degrees: f64, tilt: f64, points| LidarSettings {
        field_of_view: units::from_deg(degrees),
        tilt: units::from_deg(tilt),
        points,
    };
    drive(&in_room(0.5, 1.0, -0.4), noise(2.0, 15), |robot| {
        robot.set_speed(Twist::new(0.15, 0.3))?;
        for round in [settings(360.0, 0.0, 360), settings(180.0, -5.0, 91), settings(60.0, 2.0, 7)] {
            robot.configure_lidar(round)?;
            for _ in 0..8 {
                robot.scan()?;
                robot.wait(0.3)?;
            }
        }
        Ok(())
    })
}

/// A room with a cove that opens towards the start, and a slanted bar behind it.
fn cove() -> Scene {
    let mut world = World::walled(3.0, 2.0);
    let corners = [(1.0, 0.6), (1.6, 0.6), (1.6, 1.4), (1.0, 1.4)].map(|(x, y): (f64, f64)| Point::new(x, y));
    world.walls.extend(corners.windows(2).map(|pair| Wall::new(pair[0], pair[1])));
    world.walls.push(Wall::new(Point::new(2.0, 1.2), Point::new(2.3, 0.6)));
    Scene::with_robot(world, RobotSpec::s4(), Pose::new(0.4, 1.0, 0.0))
}

/// DistBug to a goal relative to the start, and what it comes to.
fn distbug(scene: &Scene, options: SimOptions, goal: Point, time_limit: f64) -> Result<String> {
    let mut verdict = String::new();
    let log = drive(scene, options, |robot| {
        let mut behaviour = DistBug::new(goal, DistBugParameters::default())?;
        let outcome = behaviour.run(robot, time_limit, |_, _| {})?;
        note(&mut verdict, "outcome", &outcome);
        note(&mut verdict, "events", &behaviour.take_events());
        note(&mut verdict, "pose as the robot sees it", &behaviour.pose());
        Ok(())
    })?;
    Ok(log + &verdict)
}

fn distbug_ideal() -> Result<String> {
    distbug(&cove(), noise(0.0, 16), Point::new(2.2, 0.1), 40.0)
}

fn distbug_noise() -> Result<String> {
    distbug(&cove(), noise(1.0, 17), Point::new(2.2, 0.1), 40.0)
}

/// A drawn course, and the first twenty seconds on the way to its goal.
fn generated_course() -> Result<String> {
    let course = obstacle_course(&mut Stream::new(18), &CourseOptions::default()).map_err(other)?;
    let mut log = String::new();
    note(&mut log, "start", &course.start);
    note(&mut log, "goal", &course.goal);
    note(&mut log, "reachable", &course.reachable);
    note(&mut log, "obstacles", &course.obstacles);
    note(&mut log, "walls", &course.world.walls);
    note(&mut log, "objects", &course.world.objects);
    let goal = course.start.to_local(course.goal);
    let scene = Scene::with_robot(course.world, RobotSpec::s4(), course.start);
    Ok(log + &distbug(&scene, noise(1.0, 18), goal, 20.0)?)
}

/// Robots that stand in rows, `columns` in each, in a field that leaves room for more.
fn formation(robots: usize, columns: usize) -> Scene {
    let rows = robots.div_ceil(columns);
    let mut scene = Scene::new(World::walled(0.6 * columns as f64, 0.6 * rows as f64));
    let spec = Arc::new(RobotSpec::s4());
    scene.robots.extend((0..robots).map(|number| {
        let (column, row) = (number % columns, number / columns);
        let pose = Pose::new(0.6 * column as f64 + 0.3, 0.6 * row as f64 + 0.3, 0.7 * number as f64);
        RobotPlacement::new(Arc::clone(&spec), pose)
    }));
    scene
}

fn threads_and_radio() -> Result<String> {
    threads(8, |_, _| {})
}

/// Robots in threads of their own, which meet, and tell each other where they are. `disturb` is called with the
/// robot's index and the step's number between steps, so that a caller can upset the scheduler.
pub(crate) fn threads(robots: usize, disturb: impl Fn(usize, u32) + Sync) -> Result<String> {
    let simulation = Simulation::new(&formation(robots, 4), noise(1.0, 19))?;
    let all: Vec<SimRobot> = (0..robots).map(|index| simulation.robot(index)).collect::<Result<_>>()?;
    let disturb = &disturb;
    let logs: Vec<Result<String>> = std::thread::scope(|scope| {
        let start = |(index, robot)| scope.spawn(move || talk(index, robot, |step| disturb(index, step)));
        let threads: Vec<_> = all.into_iter().enumerate().map(start).collect();
        let join = |thread: std::thread::ScopedJoinHandle<'_, Result<String>>| {
            thread.join().unwrap_or_else(|_| Err(Error::new(ErrorKind::Other, "a robot's thread panicked")))
        };
        threads.into_iter().map(join).collect()
    });
    let mut log = logs.into_iter().collect::<Result<String>>()?;
    for robot in 0..robots {
        note_truth(&mut log, &simulation.truth().robot(robot)?);
    }
    Ok(log)
}

/// One robot's program among several: wanders, sends its pose to a drawn robot, and follows what it is told.
fn talk(index: usize, robot: SimRobot, disturb: impl Fn(u32)) -> Result<String> {
    let mut robot = Traced::new(robot, Vec::new());
    let mut stream = Stream::new(19).child("program", index as u64);
    let peers = robot.radio_peers()?;
    // Some programs end sooner, and the world goes on without them.
    let steps = 60 - 4 * index as u32;
    for step in 0..steps {
        disturb(step);
        wander(&mut robot, &mut stream)?;
        if stream.chance(0.4) {
            let to = peers[stream.below(peers.len())];
            let pose = robot.pose()?;
            robot.send(to, format!("{step} {:?} {:?}", pose.x, pose.y).as_bytes())?;
        }
        while let Some(message) = robot.receive()? {
            if message.data.len() % 5 == 0 {
                robot.turn(0.3, 2.0)?;
                robot.wait_done()?;
            }
        }
        robot.wait(0.05 + 0.01 * index as f64)?;
    }
    text(robot)
}

/// Fifty wandering robots in one thread, with control periods of their own.
fn fleet_of_50() -> Result<String> {
    const ROBOTS: usize = 50;
    let mut traces = vec![Vec::new(); ROBOTS];
    let mut fleet = Fleet::new(&formation(ROBOTS, 10), noise(1.0, 20))?;
    for (index, trace) in traces.iter_mut().enumerate() {
        let mut stream = Stream::new(20).child("program", index as u64);
        fleet.control(index, 0.08 + 0.01 * (index % 5) as f64, move |robot| {
            let mut robot = Traced::new(robot, &mut *trace);
            wander(&mut robot, &mut stream)?;
            let over = robot.now()? > 6.0;
            Ok(if over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        })?;
    }
    fleet.run_for(8.0)?;
    let truths: Vec<RobotTruth> = (0..ROBOTS).map(|index| fleet.truth(index)).collect::<Result<_>>()?;
    drop(fleet);
    let mut log = String::new();
    for (trace, truth) in traces.into_iter().zip(&truths) {
        log += &String::from_utf8(trace).map_err(other)?;
        note_truth(&mut log, truth);
    }
    Ok(log)
}
