//! What a robot cannot do, wrong arguments, the end of time, keys and radio.

use std::ops::ControlFlow;

use roverlab::geometry::{Pose, Twist};
use roverlab::io::sim::{Fleet, NoiseModel, SimOptions, SimRobot, Simulation, TICK};
use roverlab::io::{
    Clock, DistanceSensors, Drive, Encoders, Error, ErrorKind, Key, Keys, Lidar, LidarSettings, Manoeuvres,
    Motors, Odometry, Psd, Radio, Servos,
};
use roverlab::world::{DriveSpec, Object, ObjectKind, RobotSpec, Scene, Wall, World};

use crate::common::{open_floor, robots, start};

const START: Pose = Pose::new(1.0, 1.0, 0.0);

type Call = fn(&mut SimRobot, LidarSettings) -> Result<(), Error>;
type Program = fn(&mut SimRobot) -> Result<(), Error>;
type Change = fn(&mut SimOptions);

fn assert_error<T: std::fmt::Debug>(result: Result<T, Error>, kind: ErrorKind, says: &str) {
    let error = result.unwrap_err();
    assert_eq!(error.kind(), kind, "{error}");
    assert!(error.to_string().contains(says), "`{says}` is missing in `{error}`");
}

#[test]
fn what_the_robot_lacks_is_an_error_that_names_it() {
    let bare = RobotSpec { psds: Vec::new(), lidar: None, camera: None, ..RobotSpec::s4() };
    let (mut robot, _) = start(&Scene::with_robot(World::empty(2.0, 2.0), bare, START), SimOptions::ideal());
    let settings = LidarSettings { field_of_view: 1.0, tilt: 0.0, points: 3 };
    assert_error(robot.distance(Psd::FRONT), ErrorKind::Unsupported, "front PSD");
    assert_error(robot.distance(Psd(9)), ErrorKind::Unsupported, "PSD 9");
    assert_error(robot.scan(), ErrorKind::Unsupported, "lidar");
    assert_error(robot.configure_lidar(settings), ErrorKind::Unsupported, "lidar");
    assert_error(robot.encoder(3), ErrorKind::Unsupported, "encoder 3");
    assert_error(robot.reset_encoder(0), ErrorKind::Unsupported, "encoder 0");
    assert_error(robot.set_motor(3, 0.5), ErrorKind::Unsupported, "motor 3");
    assert_error(robot.set_servo(1, 0.5), ErrorKind::Unsupported, "servo 1");
}

#[test]
fn wrong_arguments_are_named() {
    let (mut robot, truth) = start(&open_floor(START), SimOptions::ideal());
    let lidar = LidarSettings { field_of_view: 1.0, tilt: 0.0, points: 3 };
    let calls: [(&str, Call); 21] = [
        ("linear speed is NaN", |r, _| r.set_speed(Twist::new(f64::NAN, 0.0))),
        ("angular speed is inf", |r, _| r.set_speed(Twist::new(0.0, f64::INFINITY))),
        ("linear speed is 1797", |r, _| r.set_speed(Twist::new(f64::MAX, f64::MAX))),
        ("distance is NaN", |r, _| r.straight(f64::NAN, 0.1)),
        ("angle is inf", |r, _| r.turn(f64::INFINITY, 0.1)),
        ("speed is 0", |r, _| r.straight(1.0, 0.0)),
        ("speed is NaN", |r, _| r.curve(1.0, 1.0, f64::NAN)),
        ("manoeuvre is", |r, _| r.straight(1e300, 0.1)),
        ("manoeuvre is", |r, _| r.straight(1.0, 1e-300)),
        ("manoeuvre is", |r, _| r.curve(f64::MAX, f64::MAX, f64::MAX)),
        ("target", |r, _| r.drive_to(-1.0, 0.0, 0.1)),
        ("forward distance", |r, _| r.drive_to(f64::NAN, 0.0, 0.1)),
        ("pose", |r, _| r.set_pose(Pose::new(0.0, f64::NAN, 0.0))),
        ("motor speed is 1.5", |r, _| r.set_motor(1, 1.5)),
        ("motor speed is NaN", |r, _| r.set_motor(2, f64::NAN)),
        ("waiting time is NaN", |r, _| r.wait(f64::NAN)),
        ("waiting time is 1000", |r, _| r.wait(1e300)),
        ("lidar points is 0", |r, s| r.configure_lidar(LidarSettings { points: 0, ..s })),
        ("lidar field of view", |r, s| r.configure_lidar(LidarSettings { field_of_view: 7.0, ..s })),
        ("radio receiver is 2", |r, _| r.send(2, b"nobody")),
        ("radio message length", |r, _| r.send(1, &vec![0; 70_000])),
    ];
    for (says, call) in calls {
        assert_error(call(&mut robot, lidar), ErrorKind::InvalidInput, says);
    }
    robot.wait(1.0).unwrap();
    assert_eq!(truth.pose(0).unwrap(), START, "what was refused moved nothing");
    assert_eq!(robot.scan().unwrap().ranges.len(), 360);
}

#[test]
fn the_largest_commands_do_no_harm() {
    let (mut robot, truth) = start(&open_floor(START), SimOptions::with_noise(20.0, 3));
    robot.set_speed(Twist::new(1e6, -1e6)).unwrap();
    robot.wait(5.0).unwrap();
    robot.set_pose(Pose::new(1e300, -1e300, 1e300)).unwrap();
    robot.curve(-1e5, 1e5, 1e6).unwrap();
    robot.wait(5.0).unwrap();
    assert!(truth.pose(0).unwrap().is_finite());
    assert!(truth.set_pose(0, Pose::new(f64::NAN, 0.0, 0.0)).is_err());
    assert!(truth.set_pose(1, START).is_err());
}

#[test]
fn options_out_of_range_are_named() {
    let with = |change: Change| {
        let mut options = SimOptions::ideal();
        change(&mut options);
        Simulation::new(&open_floor(START), options).map(|_| ())
    };
    let bad: [(&str, Change); 8] = [
        ("wheel scale", |o| o.noise.wheel_scale = -0.1),
        ("slip", |o| o.noise.slip = f64::NAN),
        ("range error", |o| o.noise.range = f64::INFINITY),
        ("command error", |o| o.noise = NoiseModel::textbook().scaled(1e3)),
        ("time limit", |o| o.time_limit = Some(-1.0)),
        ("trail interval", |o| o.trail_interval = Some(0.001)),
        ("call duration is 0", |o| o.call_duration = 0.0),
        ("call duration is NaN", |o| o.call_duration = f64::NAN),
    ];
    for (says, change) in bad {
        assert_error(with(change), ErrorKind::InvalidInput, says);
    }
}

#[test]
fn scenes_that_make_no_sense_are_refused() {
    let refused = |scene: &Scene| Simulation::new(scene, SimOptions::ideal()).map(|_| ());
    let mut scene = open_floor(Pose::new(f64::NAN, 0.0, 0.0));
    assert_error(refused(&scene), ErrorKind::InvalidInput, "robot pose");
    scene = open_floor(START);
    scene.world.walls.push(Wall::new(
        roverlab::geometry::Point::new(0.0, f64::INFINITY),
        roverlab::geometry::Point::origin(),
    ));
    assert_error(refused(&scene), ErrorKind::InvalidInput, "wall 0");
    scene = open_floor(START);
    let can = ObjectKind::predefined("can").unwrap();
    scene.world.objects.push(Object::new(can.into(), Pose::new(0.0, f64::NAN, 0.0)));
    assert_error(refused(&scene), ErrorKind::InvalidInput, "object 0");

    let with = |change: fn(&mut RobotSpec)| {
        let mut spec = RobotSpec::s4();
        change(&mut spec);
        refused(&Scene::with_robot(World::empty(2.0, 2.0), spec, START))
    };
    assert_error(with(|s| s.height = 0.0), ErrorKind::InvalidInput, "height is 0");
    let fast = |s: &mut RobotSpec| {
        if let DriveSpec::Differential { max_wheel_speed, .. } = &mut s.drive {
            *max_wheel_speed = 1e12;
        }
    };
    assert_error(with(fast), ErrorKind::InvalidInput, "S4: top speed");
    let car = |s: &mut RobotSpec| {
        s.drive = DriveSpec::Ackermann {
            wheel_diameter: 0.1,
            track: 0.2,
            wheelbase: 0.3,
            max_steering: 1.6,
            dynamics: None,
            max_wheel_speed: 10.0,
            ticks_per_turn: 100.0,
        };
    };
    assert_error(with(car), ErrorKind::InvalidInput, "S4: maximal steering is 1.6");
}

#[test]
fn time_ends_exactly_at_the_limit() {
    let limited = |limit| SimOptions { time_limit: Some(limit), ..SimOptions::ideal() };
    let programs: [Program; 4] = [
        |robot| robot.wait(1e6),
        |robot| loop {
            robot.distance(Psd::FRONT)?;
        },
        |robot| loop {
            robot.wait(0.07)?;
        },
        |robot| robot.straight(100.0, 0.1).and_then(|()| robot.wait_done()),
    ];
    for program in programs {
        let (mut robot, truth) = start(&open_floor(START), limited(1.5));
        assert_error(program(&mut robot), ErrorKind::TimedOut, "time limit");
        assert_eq!(truth.time(), 1.5);
        assert_error(robot.now(), ErrorKind::TimedOut, "time limit");
        drop(robot);
        assert_eq!(truth.time(), 1.5);
    }
    let (mut robot, truth) = start(&open_floor(START), limited(0.0));
    assert_error(robot.pose(), ErrorKind::TimedOut, "time limit");
    assert_eq!(truth.time(), 0.0);
}

#[test]
fn every_call_before_the_limit_succeeds() {
    let options = SimOptions { time_limit: Some(0.2), call_duration: 0.01, ..SimOptions::ideal() };
    let (mut robot, _) = start(&open_floor(START), options);
    for call in 0..20 {
        assert_eq!(robot.now().unwrap(), f64::from(call) / 100.0);
    }
    assert_error(robot.now(), ErrorKind::TimedOut, "time limit");
}

#[test]
fn a_fleet_has_the_same_limits() {
    let options = SimOptions { time_limit: Some(0.5), ..SimOptions::ideal() };
    let mut fleet = Fleet::new(&open_floor(START), options).unwrap();
    assert_error(fleet.run_for(1e300), ErrorKind::InvalidInput, "duration is 1000");
    assert_error(fleet.run_for(f64::NAN), ErrorKind::InvalidInput, "duration is NaN");
    assert_error(fleet.control(0, 0.0, |_| Ok(ControlFlow::Continue(()))), ErrorKind::InvalidInput, "period");
    assert_error(fleet.control(1, 0.1, |_| Ok(ControlFlow::Continue(()))), ErrorKind::InvalidInput, "robot");
    fleet.control(0, 0.1, |robot| robot.pose().map(|_| ControlFlow::Continue(()))).unwrap();
    assert_error(fleet.run_for(2.0), ErrorKind::TimedOut, "time limit");
    assert_eq!(fleet.time(), 0.5);
}

#[test]
fn a_fleets_behaviour_cannot_wait_but_may_be_called_late() {
    let mut fleet = Fleet::new(&open_floor(START), SimOptions::ideal()).unwrap();
    fleet.control(0, 1e300, |robot| robot.wait(0.1).map(|()| ControlFlow::Continue(()))).unwrap();
    assert_error(fleet.run_for(0.1), ErrorKind::Unsupported, "cannot wait");
    let mut calls = 0;
    let mut fleet = Fleet::new(&open_floor(START), SimOptions::ideal()).unwrap();
    let count = |_: &mut roverlab::io::sim::FleetRobot<'_>| {
        calls += 1;
        Ok(ControlFlow::Continue(()))
    };
    fleet.control(0, 1e300, count).unwrap();
    fleet.run_for(3.0).unwrap();
    assert_eq!(fleet.time(), 3.0);
    drop(fleet);
    assert_eq!(calls, 1);
}

#[test]
fn time_passes_by_waiting_and_a_little_by_calling() {
    let (mut robot, truth) = start(&open_floor(START), SimOptions::ideal());
    assert_eq!(robot.now().unwrap(), 0.0);
    robot.wait(-1.0).unwrap();
    assert_eq!(robot.now().unwrap(), 2e-4);
    // 97 more calls end just before the first tick does; what is read is the last tick's state.
    for _ in 0..97 {
        robot.pose().unwrap();
    }
    assert_eq!(truth.time(), 0.0);
    assert_eq!(robot.now().unwrap(), TICK);
    assert_eq!(truth.time(), TICK);
    robot.wait(0.5 * TICK).unwrap();
    assert_eq!(truth.time(), TICK);
    robot.wait(0.5 * TICK).unwrap();
    assert_eq!(truth.time(), 2.0 * TICK);
}

#[test]
fn keys_come_when_they_are_due_and_in_order() {
    let simulation = Simulation::new(&open_floor(START), SimOptions::ideal()).unwrap();
    let mut robot = simulation.robot(0).unwrap();
    for (time, key) in [(2.0, Key::Key3), (0.57, Key::Key1), (0.57, Key::Key2), (-1.0, Key::Key4)] {
        simulation.press_key(0, time, key).unwrap();
    }
    assert_eq!(robot.read_key().unwrap(), Some(Key::Key4));
    assert_eq!(robot.read_key().unwrap(), None);
    assert_eq!(robot.wait_key().unwrap(), Key::Key1);
    assert_eq!(simulation.truth().time(), 0.57);
    assert_eq!(robot.read_key().unwrap(), Some(Key::Key2));
    assert_eq!(robot.wait_key().unwrap(), Key::Key3);
    assert_eq!(simulation.truth().time(), 2.0);
    assert_error(robot.wait_key(), ErrorKind::Other, "no key press is scheduled");
    assert_error(simulation.press_key(1, 1.0, Key::Key1), ErrorKind::InvalidInput, "robot");
    for time in [f64::NAN, 1e300] {
        assert_error(simulation.press_key(0, time, Key::Key1), ErrorKind::InvalidInput, "key press");
    }
    assert_eq!(robot.read_touch().unwrap(), None);
}

#[test]
fn a_fleets_robots_have_keys_too() {
    let mut pressed = None;
    let mut fleet = Fleet::new(&open_floor(START), SimOptions::ideal()).unwrap();
    fleet.press_key(0, 0.25, Key::Key2).unwrap();
    assert!(fleet.press_key(1, 0.25, Key::Key2).is_err());
    fleet
        .control(0, 0.1, |robot| {
            if robot.read_key()? != Some(Key::Key2) {
                return Ok(ControlFlow::Continue(()));
            }
            pressed = Some(robot.now()?);
            Ok(ControlFlow::Break(()))
        })
        .unwrap();
    fleet.run_for(1.0).unwrap();
    assert_eq!(fleet.time(), 0.3, "with the last behaviour the run ends");
    drop(fleet);
    assert_eq!(pressed, Some(0.3));
}

#[test]
fn radio_messages_arrive_at_the_next_tick_in_order() {
    let poses = [0.5, 1.0, 1.5].map(|x| Pose::new(x, 1.0, 0.0));
    let mut received = Vec::new();
    let mut fleet = Fleet::new(&robots(World::empty(2.0, 2.0), &poses), SimOptions::ideal()).unwrap();
    for robot in [2, 0] {
        fleet
            .control(robot, 1.0, move |radio| {
                assert_eq!(radio.radio_id()? as usize, robot + 1);
                assert_eq!(radio.radio_peers()?, [1, 2, 3]);
                radio.send(2, &[robot as u8, 1])?;
                radio.send(2, &[robot as u8, 2])?;
                Ok(ControlFlow::Break(()))
            })
            .unwrap();
    }
    fleet
        .control(1, TICK, |radio| {
            while let Some(message) = radio.receive()? {
                received.push((radio.now()?, message.from, message.data));
            }
            Ok(ControlFlow::Continue(()))
        })
        .unwrap();
    fleet.run_for(0.1).unwrap();
    drop(fleet);
    let expected = [(1, vec![0, 1]), (1, vec![0, 2]), (3, vec![2, 1]), (3, vec![2, 2])];
    assert_eq!(received, expected.map(|(from, data)| (TICK, from, data)));
}
