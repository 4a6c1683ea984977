//! The simulator and its robots: driving, contacts, sensors, threads and fleets.

use std::ops::ControlFlow;
use std::sync::Arc;

use roverlab::geometry::{Pose, Twist, units};
use roverlab::io::sim::{Fleet, RobotTruth, SimOptions, SimRobot, Simulation};
use roverlab::io::wrappers::{Stamp, Traced};
use roverlab::io::{
    Clock, DistanceSensors, Drive, Encoders, Error, ErrorKind, Lidar, LidarSettings, Manoeuvres, Motors,
    Odometry, Psd, Radio, Result, StallDetector,
};
use roverlab::random::Stream;
use roverlab::world::generate::{CourseOptions, obstacle_course};
use roverlab::world::{RobotPlacement, RobotSpec, Scene, World};

use super::bugs::distbug;
use super::{Scenario, drive, in_room, noise, note, note_truth, other, text, textbook};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("straight-and-turn", straight_and_turn),
    Scenario::new("arcs", arcs),
    Scenario::new("wall-bump", wall_bump),
    Scenario::new("wandering", wandering),
    Scenario::new("lidar", lidar),
    Scenario::new("pushing", pushing),
    Scenario::new("generated-course", generated_course),
    Scenario::threaded("threads-and-radio", threads_and_radio),
    Scenario::new("fleet-of-50", fleet_of_50),
];

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

/// Things that are pushed, and robots and things that a hand moves, under options that no other run has.
fn pushing() -> Result<String> {
    let mut scene = in_room(0.5, 0.5, 0.0);
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::labbot()), Pose::new(0.6, 1.5, 0.0)));
    let options = SimOptions { pushing: true, ideal_encoders: true, call_duration: 0.002, ..noise(1.0, 21) };
    let simulation = Simulation::new(&scene, options)?;
    let truth = simulation.truth();
    let mut log = String::new();
    let mut robot = Traced::new(simulation.robot(0)?, Vec::new()).with_stamp(Stamp::LastKnown);
    for (round, angular) in [0.0, 0.6, -0.9, 0.3].into_iter().enumerate() {
        // The can or the ball is put before the robot.
        let ahead = truth.pose(0)?.compose(&Pose::new(0.25, 0.02, 0.0));
        truth.set_object(1 + round % 2, ahead)?;
        robot.set_speed(Twist::new(0.3, angular))?;
        for _ in 0..8 {
            robot.wait(0.3)?;
            robot.pose()?;
            robot.encoder(1)?;
            robot.distance(Psd::FRONT)?;
            robot.is_stalled()?;
            let objects = (0..3).map(|object| truth.object(object)).collect::<Result<Vec<_>>>()?;
            note(&mut log, "objects", &(truth.time(), objects));
        }
        match round {
            0 => truth.move_robot(0, 1, Pose::new(0.7, 1.2, 1.0))?,
            1 => truth.move_object(0, 0, Pose::new(2.8, 0.2, 0.0))?,
            _ => truth.set_pose(0, Pose::new(1.9, 0.5, 0.2))?,
        }
    }
    log += &text(robot)?;
    note_truth(&mut log, &truth.robot(0)?);
    note_truth(&mut log, &truth.robot(1)?);
    Ok(log)
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

/// Robots in threads of their own, which meet, and tell each other where they are. `disturb` is called with
/// the robot's index and the step's number between steps, so that a caller can upset the scheduler.
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
