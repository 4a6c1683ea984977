use proptest::prelude::*;

use super::{CALLS, busy_robot, call};
use crate::geometry::{Pose, Twist, angle_difference};
use crate::io::wrappers::{Fault, FaultKind, Faulty, Sensor};
use crate::io::{
    Camera, Clock, Display, DistanceSensors, Drive, Error, ErrorKind, Lidar, LidarScan, MockRobot, Odometry,
    Psd, Resolution, Script,
};

/// A robot whose readings are functions of time and whose calls take no time.
fn robot() -> MockRobot {
    let scan = |time: f64| LidarScan { range_max: 99.0, ranges: vec![time, 2.0], ..LidarScan::default() };
    MockRobot::new()
        .with_distance(Psd::FRONT, Script::function(Ok))
        .with_distance(Psd::LEFT, Script::function(|time| Ok(10.0 + time)))
        .with_scan(Script::function(move |time| Ok(scan(time))))
        .with_pose(Script::function(|time| Ok(Pose::new(time, 0.0, 0.0))))
        .with_speed(Script::function(|time| Ok(Twist::new(time, 0.0))))
}

fn faulty(text: &str) -> Faulty<MockRobot> {
    Faulty::new(robot(), text.split(' ').map(|fault| fault.parse().unwrap()).collect())
}

/// The front distances at several times.
fn front(robot: &mut Faulty<MockRobot>, times: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut readings = vec![];
    for time in times {
        let now = robot.inner().time();
        robot.wait(time - now).unwrap();
        readings.push(robot.distance(Psd::FRONT).unwrap());
    }
    readings
}

fn kind<T: std::fmt::Debug>(result: Result<T, Error>) -> ErrorKind {
    result.unwrap_err().kind()
}

#[test]
fn a_stuck_sensor_repeats_its_last_reading_until_it_is_well() {
    let mut robot = faulty("stuck:front@2-4");
    assert_eq!(front(&mut robot, [0.0, 1.0, 2.0, 3.0, 4.0]), [0.0, 1.0, 1.0, 1.0, 4.0]);
}

#[test]
fn a_sensor_stuck_from_the_start_repeats_its_first_reading() {
    let mut robot = faulty("stuck:front@0");
    assert_eq!(front(&mut robot, [1.0, 2.0, 3.0]), [1.0, 1.0, 1.0]);
    assert_eq!(robot.distance(Psd::LEFT).unwrap(), 13.0);
}

#[test]
fn stuck_covers_lidar_and_odometry() {
    let mut robot = faulty("stuck@1");
    let first = (robot.scan().unwrap(), robot.pose().unwrap(), robot.speed().unwrap());
    robot.wait(1.5).unwrap();
    assert_eq!((robot.scan().unwrap(), robot.pose().unwrap(), robot.speed().unwrap()), first);
}

#[test]
fn a_camera_gets_stuck_late_dark_and_lost() {
    let shade = |robot: &mut Faulty<MockRobot>| robot.image().map(|image| image.as_raw()[0]);
    let camera = |faults: &str| {
        let scene = |time: f64| Ok(image::RgbImage::from_pixel(2, 2, image::Rgb([10 * time as u8 + 10; 3])));
        let faults = faults.split(' ').map(|fault| fault.parse().unwrap()).collect();
        Faulty::new(MockRobot::new().with_image(Script::function(scene)), faults)
    };
    let at = |robot: &mut Faulty<MockRobot>| {
        let shades = (0..4).map(|_| {
            let seen = shade(robot);
            robot.wait(1.0).unwrap();
            seen.unwrap()
        });
        shades.collect::<Vec<u8>>()
    };
    assert_eq!(at(&mut camera("stuck:camera@1-3")), [10, 10, 10, 40]);
    assert_eq!(at(&mut camera("late:camera=1@2")), [10, 20, 20, 30]);
    assert_eq!(at(&mut camera("nan:camera@1-2")), [10, 0, 30, 40]);
    assert_eq!(at(&mut camera("stuck:lidar@0")), [10, 20, 30, 40]);
    let mut lost = camera("lost:camera@0");
    assert_eq!(shade(&mut lost).unwrap_err().to_string(), "the camera is gone");
    assert_eq!(kind(lost.set_resolution(Resolution::Vga)), ErrorKind::Disconnected);
    assert_eq!(kind(lost.resolution()), ErrorKind::Disconnected);
}

#[test]
fn a_lost_device_is_disconnected_and_named() {
    let mut robot = faulty("lost:left@1 lost:odometry@1 lost:lidar@1-2");
    assert!(robot.distance(Psd::LEFT).is_ok());
    robot.wait(1.0).unwrap();
    let error = robot.distance(Psd::LEFT).unwrap_err();
    assert_eq!(
        (error.kind(), error.to_string()),
        (ErrorKind::Disconnected, "the left PSD is gone".to_owned())
    );
    assert!(robot.distance(Psd::FRONT).is_ok());
    assert_eq!(kind(robot.pose()), ErrorKind::Disconnected);
    assert_eq!(kind(robot.speed()), ErrorKind::Disconnected);
    assert_eq!(kind(robot.set_pose(Pose::default())), ErrorKind::Disconnected);
    assert_eq!(kind(robot.scan()), ErrorKind::Disconnected);
    assert!(robot.set_speed(Twist::STOP).is_ok());
    robot.wait(1.0).unwrap();
    assert!(robot.scan().is_ok());
}

#[test]
fn nan_readings_are_not_numbers() {
    let mut robot = faulty("nan@1-2");
    robot.wait(1.0).unwrap();
    assert!(robot.distance(Psd::FRONT).unwrap().is_nan());
    let scan = robot.scan().unwrap();
    assert!(scan.ranges.len() == 2 && scan.ranges.iter().all(|r| r.is_nan()));
    assert!(!robot.pose().unwrap().is_finite() && !robot.speed().unwrap().is_finite());
    robot.wait(1.0).unwrap();
    assert_eq!(robot.distance(Psd::FRONT).unwrap(), 2.0);
}

#[test]
fn odometry_jumps_and_goes_on_from_there() {
    let mock = MockRobot::new().with_ideal_drive();
    let jump = Pose::new(0.0, 0.5, std::f64::consts::FRAC_PI_2);
    let mut robot = Faulty::new(mock, vec![Fault::new(1.0, FaultKind::Jump(jump))]);
    robot.set_speed(Twist::new(1.0, 0.0)).unwrap();
    robot.wait(1.0).unwrap();
    assert_eq!(robot.pose().unwrap(), Pose::new(1.0, 0.5, jump.heading));
    robot.wait(2.0).unwrap();
    // It keeps driving straight on, which is upwards now.
    let pose = robot.pose().unwrap();
    assert!((pose.x - 1.0).abs() < 1e-12 && (pose.y - 2.5).abs() < 1e-12, "{pose:?}");
    robot.set_pose(Pose::default()).unwrap();
    assert_eq!(robot.pose().unwrap(), Pose::default());
}

#[test]
fn a_jump_that_ends_leaves_the_truth() {
    let mut robot = faulty("jump=100,0,0@1-2");
    robot.wait(1.5).unwrap();
    assert!((robot.pose().unwrap().x - 1.6).abs() < 1e-12);
    robot.wait(1.0).unwrap();
    assert_eq!(robot.pose().unwrap().x, 2.5);
}

#[test]
fn late_readings_are_old() {
    let mut robot = faulty("late:front=1@2");
    let times = [0.0, 0.5, 1.0, 1.5, 2.0, 2.25, 2.5, 4.0];
    // The newest reading at least a second old; at 2.25 s this is the one of 1 s.
    assert_eq!(front(&mut robot, times), [0.0, 0.5, 1.0, 1.5, 1.0, 1.0, 1.5, 2.5]);

    let mut robot = faulty("late=1@0");
    assert_eq!(robot.scan().unwrap().ranges[0], 0.0);
    robot.wait(0.5).unwrap();
    // No reading is old enough yet.
    assert_eq!(robot.scan().unwrap().ranges[0], 0.0);
    assert_eq!(robot.pose().unwrap().x, 0.5);
    robot.wait(1.0).unwrap();
    assert_eq!((robot.scan().unwrap().ranges[0], robot.pose().unwrap().x), (0.5, 0.5));
}

#[test]
fn a_lost_link_fails_every_call_and_returns() {
    for number in 0..CALLS {
        let mut robot = Faulty::new(busy_robot(), vec!["link@1-1.9".parse().unwrap()]);
        robot.wait(1.0).unwrap();
        let answer = call(&mut robot, number);
        assert!(answer.contains("the link to the robot is gone"), "call {number}: {answer}");
        // Failing waits take their time, so that the link can come back.
        assert_eq!(kind(robot.wait(0.5)), ErrorKind::Disconnected);
        let _ = robot.wait(0.5);
        assert!(robot.distance(Psd::FRONT).is_ok());
    }
}

#[test]
fn a_hang_delays_one_call() {
    let mut robot = faulty("hang=3@1");
    assert_eq!(robot.now().unwrap(), 0.0);
    robot.wait(1.0).unwrap();
    assert_eq!(robot.distance(Psd::FRONT).unwrap(), 4.0);
    assert_eq!(robot.now().unwrap(), 4.0);

    let mut robot = faulty("hang@1-3");
    robot.wait(2.0).unwrap();
    robot.print("x").unwrap();
    assert_eq!(robot.now().unwrap(), 4.0);
}

#[test]
fn a_clock_stands_still_or_jumps() {
    let mut robot = faulty("clock@1-3");
    let shown: Vec<f64> = (0..5)
        .map(|_| {
            let now = robot.now().unwrap();
            robot.wait(0.8).unwrap();
            now
        })
        .collect();
    let expected = [0.0, 0.8, 1.0, 1.0, 3.2];
    assert!(shown.iter().zip(expected).all(|(s, e)| (s - e).abs() < 1e-12), "{shown:?}");

    let mut robot = faulty("clock=-5@1");
    robot.wait(1.5).unwrap();
    assert_eq!(robot.now().unwrap(), -3.5);
}

#[test]
fn several_faults_act_together() {
    let mut robot = faulty("late:front=1@0 stuck:front@3 lost:front@5-6");
    assert_eq!(front(&mut robot, [0.0, 1.0, 2.0, 3.0, 4.0]), [0.0, 0.0, 1.0, 1.0, 1.0]);
    robot.wait(1.0).unwrap();
    assert_eq!(kind(robot.distance(Psd::FRONT)), ErrorKind::Disconnected);
    robot.wait(1.0).unwrap();
    assert_eq!(robot.distance(Psd::FRONT).unwrap(), 1.0);
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn a_fault_of_one_sensor_leaves_the_others(numbers in proptest::collection::vec(0..CALLS, 0..30)) {
        let about = Sensor::Psd(Psd(77));
        let faults = [FaultKind::Stuck(about), FaultKind::Lost(about), FaultKind::Nan(about), FaultKind::Late(about, 0.3)];
        let faults = faults.map(|kind| Fault::new(0.0, kind)).to_vec();
        let mut bare = busy_robot().with_call_charge(0.0);
        let mut faulty = Faulty::new(busy_robot().with_call_charge(0.0), faults);
        for number in numbers {
            prop_assert_eq!(call(&mut faulty, number), call(&mut bare, number));
        }
    }

    #[test]
    fn jumps_keep_distances(x in -1.0..1.0f64, y in -1.0..1.0f64, heading in -3.0..3.0f64) {
        let jump = Fault::new(1.0, FaultKind::Jump(Pose::new(x, y, heading)));
        let mut robot = Faulty::new(MockRobot::new().with_ideal_drive(), vec![jump]);
        robot.set_speed(Twist::new(0.3, 0.7)).unwrap();
        robot.wait(1.0).unwrap();
        let (seen, truth) = (robot.pose().unwrap(), robot.inner().ideal_pose().unwrap());
        robot.wait(1.0).unwrap();
        let (seen_later, truth_later) = (robot.pose().unwrap(), robot.inner().ideal_pose().unwrap());
        let gap = (seen_later.position() - seen.position()).norm() - (truth_later.position() - truth.position()).norm();
        prop_assert!(gap.abs() < 1e-9);
        let turn = angle_difference(seen_later.heading, seen.heading);
        prop_assert!((turn - angle_difference(truth_later.heading, truth.heading)).abs() < 1e-9);
    }
}
