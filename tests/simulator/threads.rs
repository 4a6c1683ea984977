//! Several robots in threads: mistakes and mishaps of one do not hold up the others.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread;
use std::time::Duration;

use roverlab::geometry::{Pose, Twist};
use roverlab::io::sim::{SimOptions, SimRobot, Simulation};
use roverlab::io::{Clock, Drive, Error, ErrorKind, Manoeuvres, Radio};
use roverlab::world::World;

use crate::common::robots;

fn simulation(number: usize, options: SimOptions) -> (Simulation, Vec<SimRobot>) {
    let poses: Vec<Pose> = (0..number).map(|i| Pose::new(0.5 * i as f64, 1.0, 0.0)).collect();
    let simulation = Simulation::new(&robots(World::empty(9.0, 2.0), &poses), options).unwrap();
    let robots = (0..number).map(|robot| simulation.robot(robot).unwrap()).collect();
    (simulation, robots)
}

fn assert_held_back(error: &Error) {
    assert_eq!(error.kind(), ErrorKind::Other);
    assert!(error.to_string().contains("robot 0 waits for robot 1"), "{error}");
    assert!(error.to_string().contains("give each robot a running thread of its own"), "{error}");
}

/// Without a minute of patience.
fn impatient() -> SimOptions {
    SimOptions { patience: 0.2, ..SimOptions::ideal() }
}

#[test]
fn two_robots_of_one_thread_are_an_error_and_no_deadlock() {
    let (_simulation, mut robots) = simulation(2, impatient());
    let [a, b] = robots.get_disjoint_mut([0, 1]).unwrap();
    a.straight(1.0, 0.3).unwrap();
    b.straight(1.0, 0.3).unwrap();
    assert_held_back(&a.wait_done().unwrap_err());
    // In turns they may be driven, as far as neither runs ahead.
    drop(robots.pop());
    robots[0].wait_done().unwrap();
}

#[test]
fn a_robot_left_behind_in_the_thread_of_another_is_an_error_and_no_deadlock() {
    let (_simulation, mut robots) = simulation(2, impatient());
    assert_held_back(&robots[0].wait(1.0).unwrap_err());
    // Whoever lets go of it drives on.
    drop(robots.pop());
    robots[0].wait(1.0).unwrap();
}

#[test]
fn nor_is_one_that_was_taken_in_a_third_thread_and_never_used() {
    let (_simulation, mut robots) = simulation(2, impatient());
    thread::scope(|scope| {
        scope.spawn(|| assert_held_back(&robots[0].wait(1.0).unwrap_err()));
    });
}

#[test]
fn a_robot_used_here_and_given_to_a_thread_that_begins_later_is_waited_for() {
    let (_simulation, mut robots) = simulation(2, SimOptions::ideal());
    let (mut b, mut a) = (robots.pop().unwrap(), robots.pop().unwrap());
    b.set_speed(Twist::new(0.1, 0.0)).unwrap();
    thread::scope(|scope| {
        scope.spawn(move || {
            thread::sleep(Duration::from_millis(200));
            b.wait(1.0).unwrap();
        });
        a.wait(1.0).unwrap();
    });
}

#[test]
fn a_robot_can_be_taken_once() {
    let (simulation, mut robots) = simulation(2, SimOptions::ideal());
    let error = simulation.robot(0).unwrap_err();
    assert!(error.kind() == ErrorKind::InvalidInput && error.to_string().contains("robot 0"), "{error}");
    assert_eq!(simulation.robot(2).unwrap_err().kind(), ErrorKind::InvalidInput);
    drop(robots.remove(0));
    let mut again = simulation.robot(0).unwrap();
    assert_eq!(again.now().unwrap(), 0.0);
}

#[test]
fn robots_that_nobody_drives_hold_nobody_up() {
    let poses = [Pose::new(0.5, 1.0, 0.0), Pose::new(1.5, 1.0, 0.0)];
    let scene = robots(World::empty(9.0, 2.0), &poses);
    let simulation = Simulation::new(&scene, SimOptions::ideal()).unwrap();
    let mut robot = simulation.robot(1).unwrap();
    robot.wait(2.0).unwrap();
    assert_eq!(simulation.truth().time(), 2.0);
    // Whoever comes later begins at the world's time.
    let mut late = simulation.robot(0).unwrap();
    assert_eq!(late.now().unwrap(), 2.0);
}

#[test]
fn a_dropped_robot_drives_on_and_the_others_too() {
    let (simulation, mut robots) = simulation(2, SimOptions::ideal());
    let (mut b, mut a) = (robots.pop().unwrap(), robots.pop().unwrap());
    thread::scope(|scope| {
        scope.spawn(move || {
            b.set_speed(Twist::new(0.1, 0.0)).unwrap();
            b.wait(0.5).unwrap();
        });
        scope.spawn(move || {
            a.wait(4.0).unwrap();
            assert!((a.now().unwrap() - 4.0).abs() < 1e-3);
        });
    });
    let pose = simulation.truth().pose(1).unwrap();
    assert!((pose.x - (0.5 + 0.1 * 3.8)).abs() < 0.01, "{pose:?}");
}

#[test]
fn a_panic_in_one_program_leaves_the_others_running() {
    let (simulation, robots) = simulation(3, SimOptions::ideal());
    thread::scope(|scope| {
        for (number, mut robot) in robots.into_iter().enumerate() {
            scope.spawn(move || {
                let program = AssertUnwindSafe(|| {
                    robot.set_speed(Twist::new(0.1, 0.0)).unwrap();
                    robot.wait(1.0).unwrap();
                    // Not `panic!`, whose message would stand in the test's output.
                    if number == 1 {
                        std::panic::resume_unwind(Box::new("a program's own mistake"));
                    }
                    robot.wait(2.0).unwrap();
                    robot.now().unwrap()
                });
                let ended = catch_unwind(program);
                assert_eq!(ended.is_err(), number == 1);
            });
        }
    });
    assert_eq!(simulation.truth().time(), 3.0);
}

#[test]
fn every_robot_gets_to_the_time_limit() {
    let options = SimOptions { time_limit: Some(1.0), ..SimOptions::ideal() };
    let (simulation, robots) = simulation(4, options);
    thread::scope(|scope| {
        for (number, mut robot) in robots.into_iter().enumerate() {
            scope.spawn(move || {
                loop {
                    let step = robot.wait(0.01 * (number + 1) as f64).and_then(|()| robot.send(1, b"on"));
                    if let Err(error) = step {
                        assert_eq!(error.kind(), ErrorKind::TimedOut);
                        break;
                    }
                }
            });
        }
    });
    assert_eq!(simulation.truth().time(), 1.0);
}
