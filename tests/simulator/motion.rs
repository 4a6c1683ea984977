//! Where an undisturbed robot comes to.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use proptest::prelude::*;
use roverlab::geometry::{Pose, Twist, math};
use roverlab::io::sim::{SimOptions, SimRobot, TICK};
use roverlab::io::{Clock, Drive, Encoders, Manoeuvres, Motors, Odometry};
use roverlab::kinematics::{Displacement, advance};
use roverlab::world::{MotorSpec, RobotSpec, Scene, World};

use crate::common::{ENCODER_TICK, degrees_between, open_floor, start};

const START: Pose = Pose::new(5.0, 5.0, 0.7);

fn exact() -> SimOptions {
    SimOptions { ideal_encoders: true, ..SimOptions::ideal() }
}

#[test]
fn turning_on_the_spot_turns_the_true_pose() {
    for angle in [0.1, -1.0, FRAC_PI_2, PI - 0.01, -3.0] {
        let (mut robot, truth) = start(&open_floor(START), SimOptions::ideal());
        robot.turn(angle, 1.0).unwrap();
        robot.wait_done().unwrap();
        let pose = truth.pose(0).unwrap();
        assert!(degrees_between(pose.heading, START.heading + angle) < 0.3, "{angle}: {pose:?}");
        assert!((pose.position() - START.position()).norm() < 1e-4, "{angle}: {pose:?}");
    }
}

#[test]
fn a_speed_on_the_spot_turns_the_true_pose() {
    let (mut robot, truth) = start(&open_floor(START), exact());
    robot.set_speed(Twist::new(0.0, 0.5)).unwrap();
    robot.wait(2.0).unwrap();
    robot.set_speed(Twist::STOP).unwrap();
    robot.wait(3.0).unwrap();
    let pose = truth.pose(0).unwrap();
    // What the lag takes at the start it gives back at the end, but for the ticks of the call itself.
    assert!(degrees_between(pose.heading, START.heading + 1.0) < 0.3, "{pose:?}");
    assert!((pose.position() - START.position()).norm() < 1e-12);
}

#[derive(Debug, Clone)]
enum Command {
    Speed(f64, f64),
    Straight(f64, f64),
    Turn(f64, f64),
    Curve(f64, f64, f64),
    Motors(f64, f64),
}

fn command() -> impl Strategy<Value = Command> {
    prop_oneof![
        (-0.6..0.6f64, -4.0..4.0f64).prop_map(|(v, w)| Command::Speed(v, w)),
        (-0.5..0.5f64, 0.05..0.6f64).prop_map(|(d, v)| Command::Straight(d, v)),
        (-4.0..4.0f64, 0.2..3.0f64).prop_map(|(a, w)| Command::Turn(a, w)),
        (-0.5..0.5f64, -3.0..3.0f64, 0.05..0.6f64).prop_map(|(d, a, v)| Command::Curve(d, a, v)),
        (-1.0..1.0f64, -1.0..1.0f64).prop_map(|(l, r)| Command::Motors(0.2 * l, 0.2 * r)),
    ]
}

fn give(robot: &mut SimRobot, command: &Command) {
    match *command {
        Command::Speed(v, w) => robot.set_speed(Twist::new(v, w)),
        Command::Straight(d, v) => robot.straight(d, v),
        Command::Turn(a, w) => robot.turn(a, w),
        Command::Curve(d, a, v) => robot.curve(d, a, v),
        Command::Motors(l, r) => robot.set_motor(1, l).and_then(|()| robot.set_motor(2, r)),
    }
    .unwrap();
}

proptest! {
    #![proptest_config(crate::cases::cases(48))]

    #[test]
    fn without_noise_the_truth_is_what_exact_odometry_says(
        commands in prop::collection::vec((command(), 0.0..2.0f64), 1..12),
    ) {
        let (mut robot, truth) = start(&open_floor(START), exact());
        for (command, seconds) in &commands {
            give(&mut robot, command);
            robot.wait(*seconds).unwrap();
            let expected = START.compose(&robot.pose().unwrap());
            let pose = truth.pose(0).unwrap();
            prop_assert!((pose.position() - expected.position()).norm() < 1e-10, "{pose:?} {expected:?}");
            prop_assert!(degrees_between(pose.heading, expected.heading) < 1e-8);
        }
    }

    #[test]
    fn without_noise_odometry_errs_by_encoder_ticks(
        commands in prop::collection::vec((command(), 0.0..2.0f64), 1..12),
    ) {
        let (mut robot, truth) = start(&open_floor(START), SimOptions::ideal());
        for (command, seconds) in &commands {
            give(&mut robot, command);
            robot.wait(*seconds).unwrap();
        }
        let expected = START.compose(&robot.pose().unwrap());
        let (pose, path) = (truth.pose(0).unwrap(), truth.robot(0).unwrap().path_length);
        // A count is off by up to a tick, the heading by both wheels' over the track; the heading's error
        // displaces what is driven under it.
        let turned = 2.0 * ENCODER_TICK / 0.09;
        prop_assert!(degrees_between(pose.heading, expected.heading) <= turned.to_degrees() + 1e-9);
        let apart = (pose.position() - expected.position()).norm();
        prop_assert!(apart <= 2.0 * ENCODER_TICK + turned * path, "{apart} after {path}");
    }

    #[test]
    fn manoeuvres_end_where_they_should(length in -0.8..0.8f64, angle in -5.0..5.0f64, speed in 0.05..0.5f64) {
        let (mut robot, truth) = start(&open_floor(START), exact());
        robot.curve(length, angle, speed).unwrap();
        robot.wait_done().unwrap();
        let (pose, goal) = (truth.pose(0).unwrap(), advance(START, Displacement { length, angle }));
        prop_assert!((pose.position() - goal.position()).norm() < 1e-3, "{pose:?} {goal:?}");
        prop_assert!(degrees_between(pose.heading, goal.heading) < 0.15);
        prop_assert!(robot.is_done().unwrap() && robot.remaining().unwrap() == 0.0);
    }

    #[test]
    fn drive_to_ends_at_the_point(forward in -0.5..0.8f64, left in -0.5..0.5f64) {
        prop_assume!(left.abs() > 0.05 || forward > 0.05);
        let (mut robot, truth) = start(&open_floor(START), SimOptions::ideal());
        robot.drive_to(forward, left, 0.3).unwrap();
        robot.wait_done().unwrap();
        let goal = START.to_world(roverlab::geometry::Point::new(forward, left));
        let path = truth.robot(0).unwrap().path_length;
        // A tick of each wheel turns the robot by 0.2 degrees, and it has driven so far since.
        let tolerance = 1e-3 + 4e-3 * path;
        prop_assert!((truth.pose(0).unwrap().position() - goal).norm() < tolerance, "{:?}", truth.pose(0));
    }

    #[test]
    fn remaining_falls_to_nothing(
        length in prop_oneof![Just(0.0), -0.5..0.5f64], angle in prop_oneof![Just(0.0), -3.0..3.0f64],
        speed in 0.05..1.0f64, ideal_encoders: bool,
    ) {
        let (mut robot, _) = start(&open_floor(START), SimOptions { ideal_encoders, ..SimOptions::ideal() });
        // The slower wheel's counts come one by one, and may set the pace at the very end.
        let step = if ideal_encoders { 1e-9 } else { ENCODER_TICK };
        let unit = if length == 0.0 { 1.0 / 0.045 } else { 1.0 };
        robot.curve(length, angle, speed).unwrap();
        let mut last = robot.remaining().unwrap();
        let whole = if length == 0.0 { angle } else { length };
        // Of a manoeuvre that ends where the robot stands, as its encoders see it, nothing is left from the
        // start.
        let resolution = if ideal_encoders { 5e-5 } else { 0.5 * ENCODER_TICK };
        let is_seen = length.abs() + 0.045 * angle.abs() > resolution;
        let expected = if is_seen { whole.abs() } else { 0.0 };
        prop_assert!((last - expected).abs() < 1e-9, "{last} of {expected}");
        let mut waited = 0;
        while !robot.is_done().unwrap() {
            robot.wait(TICK).unwrap();
            let left = robot.remaining().unwrap();
            prop_assert!(left <= last + step * unit, "{left} after {last}");
            last = left;
            waited += 1;
            prop_assert!(waited < 10_000);
        }
        prop_assert!(last == 0.0);
    }

    #[test]
    fn speeds_beyond_the_limits_keep_their_curvature(v in -50.0..50.0f64, w in -300.0..300.0f64) {
        let (mut robot, truth) = start(&open_floor(START), exact());
        robot.set_speed(Twist::new(v, w)).unwrap();
        robot.wait(3.0).unwrap();
        let speed = robot.speed().unwrap();
        let fastest = (speed.linear.abs() + 0.045 * speed.angular.abs()).abs();
        // The S4's rims turn at 10 turns per second.
        prop_assert!(fastest <= PI * 0.054 * 10.0 + 1e-9, "{speed:?}");
        let parallel = (speed.linear * w - speed.angular * v).abs() / (1.0 + v.abs() + w.abs());
        prop_assert!(parallel < 1e-9, "{speed:?} for {v} {w}");
        prop_assert!(truth.pose(0).unwrap().is_finite());
    }
}

#[test]
fn nothing_remains_of_a_manoeuvre_within_a_tick() {
    let (mut robot, _) = start(&open_floor(START), SimOptions::ideal());
    robot.curve(-2.63e-5, 0.0, 0.05).unwrap();
    assert_eq!(robot.remaining().unwrap(), 0.0);
    robot.wait_done().unwrap();
    robot.curve(-2.0 * ENCODER_TICK, 0.0, 0.05).unwrap();
    assert!((robot.remaining().unwrap() - 2.0 * ENCODER_TICK).abs() < 1e-9);
}

#[test]
fn encoders_count_what_the_wheels_rolled() {
    let (mut robot, _) = start(&open_floor(START), SimOptions::ideal());
    robot.straight(-0.5, 0.3).unwrap();
    robot.wait_done().unwrap();
    let expected = -0.5 / ENCODER_TICK;
    for motor in [1, 2] {
        assert!((robot.encoder(motor).unwrap() as f64 - expected).abs() <= 1.0);
        robot.reset_encoder(motor).unwrap();
        assert_eq!(robot.encoder(motor).unwrap(), 0);
    }
    assert!((robot.pose().unwrap().x + 0.5).abs() < 2.0 * ENCODER_TICK);
}

#[test]
fn a_turn_of_several_rounds_is_not_cut_short() {
    let (mut robot, _) = start(&open_floor(START), SimOptions::ideal());
    robot.turn(3.0 * TAU, 2.0).unwrap();
    robot.wait_done().unwrap();
    let rolled = robot.encoder(2).unwrap() as f64 * ENCODER_TICK;
    assert!((rolled - 0.045 * 3.0 * TAU).abs() <= ENCODER_TICK, "{rolled}");
}

/// A robot on an empty floor with other motors.
fn with_motor(time_constant: f64, max_acceleration: f64) -> Scene {
    let spec = RobotSpec { motor: MotorSpec { time_constant, max_acceleration }, ..RobotSpec::s4() };
    Scene::with_robot(World::empty(9.0, 9.0), spec, START)
}

#[test]
fn wheels_follow_a_step_with_their_lag() {
    for lag in [0.05, 0.1, 0.2, 0.3] {
        let (mut robot, _) = start(&with_motor(lag, 100.0), exact());
        robot.set_speed(Twist::new(0.3, 0.0)).unwrap();
        robot.wait(lag).unwrap();
        let part = robot.speed().unwrap().linear / 0.3;
        let expected = 1.0 - math::exp(-1.0);
        assert!((part - expected).abs() < 1e-9, "{lag}: {part}");
    }
}

#[test]
fn wheels_keep_to_their_acceleration() {
    let (mut robot, _) = start(&with_motor(0.0, 0.5), exact());
    robot.set_speed(Twist::new(0.5, 0.0)).unwrap();
    let mut last = 0.0;
    for tick in 1..=120 {
        robot.wait(TICK - 2e-4).unwrap();
        let speed = robot.speed().unwrap().linear;
        assert!(speed - last <= 0.5 * TICK + 1e-12, "tick {tick}: {last} to {speed}");
        last = speed;
    }
    assert!((last - 0.5).abs() < 1e-12);
}

#[test]
fn weak_motors_still_stop_at_the_target() {
    for acceleration in [0.2, 0.5, 5.0] {
        let (mut robot, truth) = start(&with_motor(0.1, acceleration), exact());
        robot.straight(1.0, 0.6).unwrap();
        robot.wait_done().unwrap();
        let driven = (truth.pose(0).unwrap().position() - START.position()).norm();
        assert!((driven - 1.0).abs() < 1e-3, "{acceleration}: {driven}");
        // It did not go to and fro.
        assert!((truth.robot(0).unwrap().path_length - driven).abs() < 1e-4, "{acceleration}");
    }
}

#[test]
fn trails_hold_the_truth_at_whole_intervals() {
    let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::ideal() };
    let (mut robot, truth) = start(&open_floor(START), options);
    robot.straight(0.5, 0.2).unwrap();
    robot.wait(1.0).unwrap();
    let told = truth.robot(0).unwrap();
    assert_eq!(
        told.trail.iter().map(|p| p.time).collect::<Vec<_>>(),
        [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    );
    assert_eq!(told.trail.last().unwrap().pose, told.pose);
}
