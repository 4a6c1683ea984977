use std::f64::consts::{FRAC_PI_2, PI};

use proptest::prelude::*;

use super::*;
use crate::geometry::{Pose, Twist};
use crate::io::{
    Camera, Clock, DepthSensor, Display, DistanceSensors, Drive, Encoders, Error, ErrorKind, Inertial, Key,
    Keys, Lidar, LidarScan, Manoeuvres, Odometry, Psd, Radio, RadioMessage, Resolution, StallDetector,
};

#[test]
fn unscripted_readings_are_errors_that_name_the_sensor() {
    let mut robot = MockRobot::new();
    let errors = [
        ("front PSD", robot.distance(Psd::FRONT).unwrap_err()),
        ("PSD 12", robot.distance(Psd(12)).unwrap_err()),
        ("lidar", robot.scan().unwrap_err()),
        ("camera", robot.image().unwrap_err()),
        ("pose", robot.pose().unwrap_err()),
        ("speed", robot.speed().unwrap_err()),
        ("rest of the manoeuvre", robot.is_done().unwrap_err()),
        ("stall detector", robot.is_stalled().unwrap_err()),
        ("encoder 2", robot.encoder(2).unwrap_err()),
        ("depth sensor", robot.depth().unwrap_err()),
        ("attitude", robot.attitude().unwrap_err()),
        ("turn rates", robot.turn_rates().unwrap_err()),
        ("acceleration", robot.acceleration().unwrap_err()),
        ("keypad", robot.read_key().unwrap_err()),
        ("keypad", robot.wait_key().unwrap_err()),
        ("touch screen", robot.read_touch().unwrap_err()),
        ("radio", robot.radio_id().unwrap_err()),
        ("radio", robot.radio_peers().unwrap_err()),
        ("radio", robot.receive().unwrap_err()),
    ];
    for (name, error) in errors {
        assert_eq!(error.kind(), ErrorKind::Unsupported);
        assert_eq!(error.to_string(), format!("no script says what the {name} reads"));
    }
}

#[test]
fn a_lenient_robot_reads_quiet_answers() {
    let mut robot = MockRobot::new().lenient();
    assert_eq!(robot.distance(Psd(3)).unwrap(), f64::INFINITY);
    assert_eq!(robot.scan().unwrap(), LidarScan::default());
    assert_eq!(robot.resolution().unwrap(), Resolution::Qqvga);
    assert_eq!(robot.image().unwrap(), image::RgbImage::new(160, 120));
    assert_eq!((robot.pose().unwrap(), robot.speed().unwrap()), (Pose::default(), Twist::STOP));
    assert!(robot.is_done().unwrap() && !robot.is_stalled().unwrap());
    assert_eq!((robot.read_key().unwrap(), robot.read_touch().unwrap()), (None, None));
    assert_eq!((robot.radio_peers().unwrap(), robot.receive().unwrap()), (vec![1], None));
    // Waiting for ever has no quiet answer.
    assert!(robot.wait_key().is_err());
}

#[test]
fn queues_end_and_functions_see_the_time() {
    let mut robot = MockRobot::new().with_encoder(1, [3, 4]).with_distance(
        Psd::LEFT,
        Script::function(|time| if time < 1.0 { Ok(time) } else { Err(Error::unsupported("left PSD")) }),
    );
    assert_eq!((robot.encoder(1).unwrap(), robot.encoder(1).unwrap()), (3, 4));
    let error = robot.encoder(1).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::EndOfLog);
    assert_eq!(error.to_string(), "the script of the encoder 1 ended after 2 readings");
    robot.wait(0.5).unwrap();
    assert_eq!(robot.distance(Psd::LEFT).unwrap(), 0.5);
    robot.wait(0.5).unwrap();
    assert_eq!(robot.distance(Psd::LEFT).unwrap_err().to_string(), "the robot has no left PSD");
}

#[test]
fn time_moves_by_waiting_and_by_the_charge_alone() {
    let mut robot = MockRobot::new().with_distance(Psd::LEFT, 1.0);
    robot.distance(Psd::LEFT).unwrap();
    robot.wait(-1.0).unwrap();
    assert_eq!(robot.now().unwrap(), 0.0);
    assert_eq!(robot.wait(f64::NAN).unwrap_err().kind(), ErrorKind::InvalidInput);
    let mut robot = MockRobot::new().with_distance(Psd::LEFT, 1.0).with_call_charge(0.25);
    robot.distance(Psd::LEFT).unwrap();
    robot.print("x").unwrap();
    robot.wait(1.0).unwrap();
    assert_eq!(robot.now().unwrap(), 2.0);
}

#[test]
fn keys_and_messages_come_at_their_times() {
    let message = |from| RadioMessage { from, data: vec![1] };
    let mut robot = MockRobot::new()
        .with_keys([(2.0, Key::Key4), (1.0, Key::Key1)])
        .with_touches([(0.5, (10, 20))])
        .with_radio(3, [1, 2, 3], [(1.0, message(1)), (1.0, message(2))]);
    assert_eq!((robot.read_key().unwrap(), robot.receive().unwrap()), (None, None));
    assert_eq!(robot.wait_key().unwrap(), Key::Key1);
    assert_eq!(robot.now().unwrap(), 1.0);
    assert_eq!(robot.read_touch().unwrap(), Some((10, 20)));
    assert_eq!(robot.receive().unwrap(), Some(message(1)));
    assert_eq!(robot.receive().unwrap(), Some(message(2)));
    assert_eq!(robot.receive().unwrap(), None);
    assert_eq!(robot.wait_key().unwrap(), Key::Key4);
    assert_eq!(robot.wait_key().unwrap_err().kind(), ErrorKind::EndOfLog);
    assert_eq!(robot.radio_id().unwrap(), 3);
}

#[test]
fn the_ideal_drive_does_what_it_is_told() {
    let mut robot = MockRobot::new().with_ideal_drive();
    robot.straight(1.0, 0.5).unwrap();
    robot.wait(0.5).unwrap();
    assert_eq!((robot.remaining().unwrap(), robot.is_done().unwrap()), (0.75, false));
    assert_eq!(robot.speed().unwrap(), Twist::new(0.5, 0.0));
    robot.wait_done().unwrap();
    assert_eq!((robot.now().unwrap(), robot.pose().unwrap().x), (2.0, 1.0));
    robot.turn(-FRAC_PI_2, -PI).unwrap();
    robot.wait_done().unwrap();
    assert_eq!((robot.now().unwrap(), robot.pose().unwrap().heading), (2.5, -FRAC_PI_2));
    // A half circle of 1 m radius to the left, which ends where x is 3.
    robot.curve(PI, PI, PI).unwrap();
    robot.wait(7.0).unwrap();
    let pose = robot.pose().unwrap();
    assert!((pose.x - 3.0).abs() < 1e-12 && pose.y.abs() < 1e-12, "{pose:?}");
    assert!(robot.is_done().unwrap() && robot.speed().unwrap() == Twist::STOP);
    robot.set_pose(Pose::default()).unwrap();
    robot.set_speed(Twist::new(-0.25, 0.0)).unwrap();
    robot.wait(2.0).unwrap();
    assert_eq!(robot.pose().unwrap(), Pose::new(-0.5, 0.0, 0.0));
}

#[test]
fn the_ideal_drive_refuses_what_is_no_motion() {
    let mut robot = MockRobot::new().with_ideal_drive();
    let results = [
        robot.straight(1.0, 0.0),
        robot.straight(f64::NAN, 1.0),
        robot.turn(1.0, f64::INFINITY),
        robot.set_speed(Twist::new(0.0, f64::NAN)),
    ];
    for result in results {
        assert_eq!(result.unwrap_err().kind(), ErrorKind::InvalidInput);
    }
    robot.straight(0.0, 1.0).unwrap();
    robot.wait_done().unwrap();
    assert_eq!(robot.now().unwrap(), 0.0);
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn how_a_wait_is_cut_does_not_matter(
        length in -2.0..2.0f64, angle in -3.0..3.0f64, cuts in proptest::collection::vec(0.01..1.0f64, 1..8),
    ) {
        prop_assume!(length.abs() > 1e-3);
        let drive = || {
            let mut robot = MockRobot::new().with_ideal_drive();
            robot.curve(length, angle, 0.3).unwrap();
            robot
        };
        let (mut once, mut often) = (drive(), drive());
        once.wait(cuts.iter().sum()).unwrap();
        for &seconds in &cuts {
            often.wait(seconds).unwrap();
        }
        let (a, b) = (once.pose().unwrap(), often.pose().unwrap());
        prop_assert!((a.position() - b.position()).norm() < 1e-9);
        prop_assert!((once.remaining().unwrap() - often.remaining().unwrap()).abs() < 1e-9);
    }
}

#[test]
fn a_failed_expectation_shows_both_lists() {
    let actual = [Call::Wait(0.5), Call::WaitDone];
    assert_eq!(call::difference(&actual, &actual), None);
    assert_eq!(
        call::difference(&[Call::Wait(0.5), Call::Straight(1.0, 0.2)], &actual).unwrap(),
        "the calls differ from number 2 on\n\
         expected:\n    1 Wait(0.5)\n>   2 Straight(1.0, 0.2)\n\
         actual:\n    1 Wait(0.5)\n>   2 WaitDone"
    );
    assert_eq!(
        call::difference(&actual[..1], &actual).unwrap(),
        "the calls differ from number 2 on\n\
         expected:\n    1 Wait(0.5)\n>     (no more calls)\n\
         actual:\n    1 Wait(0.5)\n>   2 WaitDone"
    );
}

#[test]
#[should_panic(
    expected = "the calls differ from number 1 on\nexpected:\n>   1 WaitDone\nactual:\n>     (no more calls)"
)]
fn an_expectation_that_fails_panics() {
    MockRobot::new().assert_calls(&[Call::WaitDone]);
}

#[test]
fn calls_can_be_checked_in_parts() {
    let mut robot = MockRobot::new();
    robot.wait(1.0).unwrap();
    assert_eq!(robot.take_calls(), [Call::Wait(1.0)]);
    robot.print_at(1, 2, "x").unwrap();
    robot.assert_calls(&[Call::SetCursor(1, 2), Call::Print("x".to_owned())]);
    assert_eq!(robot.display().frame().get_pixel(0, 0).0, [0; 3]);
    assert_eq!(robot.cursor().unwrap(), (1, 3));
}
