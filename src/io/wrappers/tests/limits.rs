use proptest::prelude::*;

use super::busy_robot;
use crate::geometry::Twist;
use crate::io::wrappers::{Excess, Limited, Limits};
use crate::io::{
    Call, Clock, DistanceSensors, Drive, ErrorKind, Manoeuvres, MockRobot, Motors, Odometry, Psd, Script,
};

fn limited(limits: Limits) -> Limited<MockRobot> {
    let robot = MockRobot::new().with_ideal_drive().with_distance(Psd::FRONT, 1.0);
    Limited::new(robot, limits).unwrap()
}

fn speeds(robot: &MockRobot) -> Vec<Twist> {
    let speed = |call: &Call| if let Call::SetSpeed(twist) = call { Some(*twist) } else { None };
    robot.calls().iter().filter_map(speed).collect()
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn speeds_are_kept_with_their_curvature(v in -2.0..2.0f64, w in -6.0..6.0f64, linear in 0.05..1.0f64, angular in 0.1..3.0f64) {
        let mut robot = limited(Limits { linear, angular, ..Limits::default() });
        robot.set_speed(Twist::new(v, w)).unwrap();
        let given = speeds(robot.inner())[0];
        prop_assert!(given.linear.abs() <= linear && given.angular.abs() <= angular);
        prop_assert!((given.linear * w - given.angular * v).abs() < 1e-12);
        let at_a_limit = given.linear.abs() == linear || given.angular.abs() == angular;
        prop_assert!(given == Twist::new(v, w) || at_a_limit);
    }

    #[test]
    fn speed_changes_are_kept(
        steps in proptest::collection::vec((-1.0..1.0f64, -3.0..3.0f64, 0.0..0.4f64), 1..8),
    ) {
        let limits = Limits { linear_acceleration: 0.5, angular_acceleration: 2.0, ..Limits::default() };
        let mut robot = limited(limits);
        for (v, w, seconds) in steps {
            robot.set_speed(Twist::new(v, w)).unwrap();
            robot.wait(seconds).unwrap();
        }
        let (mut time, mut before) = (0.0, (0.0, Twist::STOP));
        for call in robot.inner().calls() {
            match call {
                Call::Wait(seconds) => time += seconds,
                Call::SetSpeed(twist) => {
                    let room = time - before.0 + 1e-9;
                    prop_assert!((twist.linear - before.1.linear).abs() <= 0.5 * room);
                    prop_assert!((twist.angular - before.1.angular).abs() <= 2.0 * room);
                    before = (time, *twist);
                }
                other => prop_assert!(false, "{other:?}"),
            }
        }
    }
}

#[test]
fn a_speed_is_reached_while_the_program_waits() {
    let mut robot = limited(Limits { linear_acceleration: 0.5, ..Limits::default() });
    robot.set_speed(Twist::new(0.25, 1.0)).unwrap();
    assert_eq!(robot.speed().unwrap(), Twist::new(0.0, 1.0));
    robot.wait(0.2).unwrap();
    assert!((robot.speed().unwrap().linear - 0.1).abs() < 1e-9);
    robot.wait(10.0).unwrap();
    assert_eq!(robot.speed().unwrap(), Twist::new(0.25, 1.0));
    assert!((robot.now().unwrap() - 10.2).abs() < 1e-9);
}

#[test]
fn a_loop_on_a_sensor_gets_up_to_speed_too() {
    let robot = busy_robot().with_call_charge(0.01);
    let mut robot = Limited::new(robot, Limits { linear_acceleration: 0.5, ..Limits::default() }).unwrap();
    robot.set_speed(Twist::new(0.1, 0.0)).unwrap();
    (0..30).for_each(|_| assert!(robot.distance(Psd::FRONT).is_ok()));
    assert_eq!(robot.speed().unwrap().linear, 0.1);
}

#[test]
fn manoeuvres_are_slowed_and_cancel_a_ramp() {
    let limits = Limits { linear: 0.2, angular: 0.5, linear_acceleration: 0.5, ..Limits::default() };
    let mut robot = limited(limits);
    robot.set_speed(Twist::new(0.2, 0.0)).unwrap();
    robot.straight(1.0, 0.9).unwrap();
    robot.wait(0.1).unwrap();
    robot.turn(-1.0, 2.0).unwrap();
    robot.curve(1.0, 5.0, 0.9).unwrap();
    robot.curve(1.0, -0.1, 0.9).unwrap();
    robot.drive_to(1.0, 0.0, 0.9).unwrap();
    robot.inner().assert_calls(&[
        Call::SetSpeed(Twist::STOP),
        Call::Straight(1.0, 0.2),
        Call::Wait(0.1),
        Call::Turn(-1.0, 0.5),
        Call::Curve(1.0, 5.0, 0.1),
        Call::Curve(1.0, -0.1, 0.2),
        Call::Curve(1.0, 0.0, 0.2),
    ]);
}

#[test]
fn excess_can_be_refused() {
    let limits =
        Limits { linear: 0.2, angular: 0.5, motor: 0.3, excess: Excess::Refuse, ..Limits::default() };
    let mut robot = limited(limits);
    let refused = [
        robot.set_speed(Twist::new(-0.3, 0.0)),
        robot.set_speed(Twist::new(0.0, 0.6)),
        robot.straight(1.0, 0.3),
        robot.turn(1.0, 0.6),
        robot.curve(1.0, 5.0, 0.2),
        robot.set_motor(1, -0.4),
    ];
    for result in refused {
        assert_eq!(result.unwrap_err().kind(), ErrorKind::InvalidInput);
    }
    robot.inner().assert_calls(&[]);
    robot.set_speed(Twist::new(0.2, -0.5)).unwrap();
    robot.set_motor(2, 0.3).unwrap();
    assert_eq!(
        robot.straight(1.0, 0.3).unwrap_err().to_string(),
        "speed is 0.3; expected at most 0.2 either way"
    );
}

#[test]
fn a_refused_change_of_speed_leaves_the_robot_as_it_was() {
    let limits = Limits { linear_acceleration: 0.5, excess: Excess::Refuse, ..Limits::default() };
    let mut robot = limited(limits);
    robot.set_speed(Twist::STOP).unwrap();
    robot.wait(0.1).unwrap();
    assert_eq!(robot.set_speed(Twist::new(0.06, 0.0)).unwrap_err().kind(), ErrorKind::InvalidInput);
    robot.set_speed(Twist::new(0.04, 0.0)).unwrap();
    assert_eq!(speeds(robot.inner()), [Twist::STOP, Twist::new(0.04, 0.0)]);
}

#[test]
fn single_motors_are_clamped() {
    let mut robot = limited(Limits { motor: 0.3, ..Limits::default() });
    robot.set_motor(1, -1.0).unwrap();
    robot.inner().assert_calls(&[Call::SetMotor(1, -0.3)]);
}

#[test]
fn numbers_that_are_none_reach_the_robot_which_refuses_them() {
    let mut robot = limited(Limits { linear: 0.2, linear_acceleration: 1.0, ..Limits::default() });
    assert_eq!(robot.set_speed(Twist::new(f64::NAN, 0.0)).unwrap_err().kind(), ErrorKind::InvalidInput);
    assert_eq!(robot.straight(1.0, f64::NAN).unwrap_err().kind(), ErrorKind::InvalidInput);
}

#[test]
fn limits_that_make_no_sense_are_refused() {
    for limits in [
        Limits { linear: -1.0, ..Limits::default() },
        Limits { angular: f64::NAN, ..Limits::default() },
        Limits { angular_acceleration: 0.0, ..Limits::default() },
    ] {
        let robot = MockRobot::new();
        assert_eq!(Limited::new(robot, limits).unwrap_err().kind(), ErrorKind::InvalidInput);
    }
}

#[test]
fn an_error_while_reaching_a_speed_is_returned() {
    let speed = Script::function(|_| Err(crate::io::Error::unsupported("odometry")));
    let robot = MockRobot::new().with_speed(speed);
    let mut robot = Limited::new(robot, Limits { linear_acceleration: 1.0, ..Limits::default() }).unwrap();
    assert_eq!(robot.set_speed(Twist::new(0.1, 0.0)).unwrap_err().kind(), ErrorKind::Unsupported);
}
