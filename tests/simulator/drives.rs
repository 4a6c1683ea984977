//! Cars and robots on Mecanum wheels, driven by motors, servos and the v-omega interface.

use std::f64::consts::{FRAC_PI_2, PI};

use proptest::prelude::*;
use roverlab::geometry::{Pose, Twist};
use roverlab::io::sim::{SimOptions, SimRobot, Truth};
use roverlab::io::{Clock, Drive, Encoders, ErrorKind, Manoeuvres, Motors, Odometry, Servos};
use roverlab::kinematics::{Displacement, PlanarTwist, advance, advance_planar};
use roverlab::world::{RobotSpec, Scene, World};

use crate::common::{degrees_between, start};

const START: Pose = Pose::new(5.0, 5.0, 0.7);

/// The car's turning circle: 260 mm between the axles, 30 degrees of steering.
const TURNING_RADIUS: f64 = 0.4503;

fn on_the_floor(spec: RobotSpec, options: SimOptions) -> (SimRobot, Truth) {
    start(&Scene::with_robot(World::empty(10.0, 10.0), spec, START), options)
}

fn exact() -> SimOptions {
    SimOptions { ideal_encoders: true, ..SimOptions::ideal() }
}

fn motors(robot: &mut SimRobot, fractions: [f64; 4]) {
    for (motor, fraction) in (1..).zip(fractions) {
        robot.set_motor(motor, fraction).unwrap();
    }
}

fn assert_odometry_is_true(truth: &Truth) {
    let robot = truth.robot(0).unwrap();
    let believed = START.compose(&robot.odometry);
    assert!((believed.position() - robot.pose.position()).norm() < 1e-9, "{robot:?}");
    assert!(degrees_between(believed.heading, robot.pose.heading) < 1e-7, "{robot:?}");
}

/// The book's patterns for the four motors: where each takes the robot, in its own frame.
#[test]
fn mecanum_wheels_drive_every_way() {
    let speed = 0.6 * 0.03 * 5.0 * PI;
    // Half the sum of the wheel distances, 180 and 160 mm, is the lever of a turn.
    let turn = speed / 0.17;
    let diagonal = 0.5 * speed;
    for (pattern, expected) in [
        ([1.0, 1.0, 1.0, 1.0], PlanarTwist::new(speed, 0.0, 0.0)),
        ([-1.0, 1.0, 1.0, -1.0], PlanarTwist::new(0.0, speed, 0.0)),
        ([1.0, -1.0, -1.0, 1.0], PlanarTwist::new(0.0, -speed, 0.0)),
        ([0.0, 1.0, 1.0, 0.0], PlanarTwist::new(diagonal, diagonal, 0.0)),
        ([-1.0, 1.0, -1.0, 1.0], PlanarTwist::new(0.0, 0.0, turn)),
        ([1.0, 0.5, 1.0, 0.5], PlanarTwist::new(0.75 * speed, 0.0, -0.25 * turn)),
    ] {
        let (mut robot, truth) = on_the_floor(RobotSpec::omni(), exact());
        motors(&mut robot, pattern.map(|part| 0.6 * part));
        robot.wait(2.0).unwrap();
        motors(&mut robot, [0.0; 4]);
        robot.wait(3.0).unwrap();
        let pose = truth.pose(0).unwrap();
        let end = advance_planar(START, expected.during(2.0));
        assert!((pose.position() - end.position()).norm() < 5e-3, "{pattern:?}: {pose:?} {end:?}");
        assert!(degrees_between(pose.heading, end.heading) < 1.0, "{pattern:?}: {pose:?} {end:?}");
        assert_odometry_is_true(&truth);
    }
}

#[test]
fn a_sideways_path_has_its_length_and_ends_at_a_wall() {
    let scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::omni(), Pose::new(1.0, 1.0, 0.0));
    let (mut robot, truth) = start(&scene, SimOptions::ideal());
    motors(&mut robot, [-0.5, 0.5, 0.5, -0.5]);
    robot.wait(10.0).unwrap();
    let robot = truth.robot(0).unwrap();
    assert_eq!(robot.contacts, 1);
    // The outline reaches 120 mm to the side.
    assert!((robot.pose.y - 1.87).abs() < 0.011 && (robot.pose.x - 1.0).abs() < 1e-3, "{robot:?}");
    assert!((robot.path_length - (robot.pose.y - 1.0)).abs() < 0.01, "{robot:?}");
}

#[test]
fn a_car_turns_in_its_turning_circle() {
    for (servo, side) in [(-1.0, 1.0), (1.0, -1.0)] {
        let (mut robot, truth) = on_the_floor(RobotSpec::car(), exact());
        robot.set_servo(1, servo).unwrap();
        // The servo takes a second for 30 degrees.
        robot.wait(1.1).unwrap();
        robot.set_motor(1, 0.4).unwrap();
        for _ in 0..100 {
            robot.wait(0.1).unwrap();
            let local = START.to_local(truth.pose(0).unwrap().position());
            let radius = (local.coords - nalgebra::Vector2::new(0.0, side * TURNING_RADIUS)).norm();
            assert!((radius - TURNING_RADIUS).abs() < 1e-3, "{radius}");
        }
        assert_odometry_is_true(&truth);
        assert!(robot.encoder(1).unwrap() > 1000);
    }
}

#[test]
fn the_v_omega_interface_steers_a_car_as_far_as_it_goes() {
    let (mut robot, truth) = on_the_floor(RobotSpec::car(), exact());
    robot.set_speed(Twist::new(0.2, 2.0)).unwrap();
    robot.wait(3.0).unwrap();
    let speed = robot.speed().unwrap();
    assert!((speed.angular - speed.linear / TURNING_RADIUS).abs() < 1e-3, "{speed:?}");
    robot.set_speed(Twist::new(0.0, 1.0)).unwrap();
    robot.wait(3.0).unwrap();
    let before = truth.pose(0).unwrap();
    robot.wait(2.0).unwrap();
    assert_eq!(truth.pose(0).unwrap(), before);
}

#[test]
fn what_a_car_cannot_do_is_refused() {
    let (mut robot, _) = on_the_floor(RobotSpec::car(), exact());
    assert_eq!(robot.turn(1.0, 1.0).unwrap_err().kind(), ErrorKind::Unsupported);
    let tight = robot.curve(0.3, 1.0, 0.2).unwrap_err();
    assert_eq!(tight.kind(), ErrorKind::InvalidInput);
    assert!(tight.to_string().contains("turning circle"), "{tight}");
    assert_eq!(robot.set_servo(1, 1.5).unwrap_err().kind(), ErrorKind::InvalidInput);
    // Behind the steering come the two servos of the camera.
    assert_eq!(robot.set_servo(4, 0.5).unwrap_err().kind(), ErrorKind::Unsupported);
    assert_eq!(robot.set_motor(2, 0.5).unwrap_err().kind(), ErrorKind::Unsupported);
    let (mut robot, _) = on_the_floor(RobotSpec::s4(), exact());
    assert_eq!(robot.set_servo(3, 0.5).unwrap_err().kind(), ErrorKind::Unsupported);
    let (mut robot, _) = on_the_floor(RobotSpec::omni(), exact());
    assert_eq!(robot.set_motor(5, 0.5).unwrap_err().kind(), ErrorKind::Unsupported);
    assert_eq!(robot.encoder(0).unwrap_err().kind(), ErrorKind::Unsupported);
}

proptest! {
    #![proptest_config(crate::cases::cases(24))]
    #[test]
    fn manoeuvres_of_a_car_end_where_they_should(length in -1.0..1.0f64, share in -0.99..0.99f64) {
        let (mut robot, truth) = on_the_floor(RobotSpec::car(), exact());
        let motion = Displacement { length, angle: share * length / TURNING_RADIUS };
        robot.curve(motion.length, motion.angle, 0.2).unwrap();
        robot.wait_done().unwrap();
        robot.wait(1.0).unwrap();
        let (pose, goal) = (truth.pose(0).unwrap(), advance(START, motion));
        prop_assert!((pose.position() - goal.position()).norm() < 1e-3, "{pose:?} {goal:?}");
        prop_assert!(degrees_between(pose.heading, goal.heading) < 0.1);
    }

    #[test]
    fn manoeuvres_on_mecanum_wheels_end_where_they_should(length in -1.0..1.0f64, angle in -3.0..3.0f64) {
        let (mut robot, truth) = on_the_floor(RobotSpec::omni(), exact());
        robot.curve(length, angle, 0.2).unwrap();
        robot.wait_done().unwrap();
        robot.wait(1.0).unwrap();
        let (pose, goal) = (truth.pose(0).unwrap(), advance(START, Displacement { length, angle }));
        prop_assert!((pose.position() - goal.position()).norm() < 1e-3, "{pose:?} {goal:?}");
        prop_assert!(degrees_between(pose.heading, goal.heading) < 0.1);
    }
}

#[test]
fn noise_bends_the_way_of_every_drive() {
    for (spec, fractions) in [(RobotSpec::car(), vec![0.4]), (RobotSpec::omni(), vec![0.4; 4])] {
        let (mut robot, truth) = on_the_floor(spec, SimOptions::with_noise(1.0, 3));
        for (motor, &fraction) in (1..).zip(&fractions) {
            robot.set_motor(motor, fraction).unwrap();
        }
        robot.wait(10.0).unwrap();
        let robot = truth.robot(0).unwrap();
        let believed = START.compose(&robot.odometry);
        let away = (believed.position() - robot.pose.position()).norm();
        assert!((1e-3..0.2).contains(&away), "{away}");
        assert!(degrees_between(believed.heading, robot.pose.heading) < FRAC_PI_2);
    }
}
