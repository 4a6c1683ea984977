use std::io;

use proptest::prelude::*;

use super::{CALLS, busy_robot, calls};
use crate::geometry::{Pose, Twist};
use crate::io::wrappers::{Faulty, Limited, Limits, Noise, Noisy, Stamp, Traced};
use crate::io::{
    Clock, Display, DisplayImage, DistanceSensors, Drive, Lidar, LidarScan, MockRobot, Odometry, Psd, Radio,
    Viewport,
};
use crate::random::Stream;

fn trace(numbers: &[u8]) -> (Vec<u8>, u64) {
    let mut robot = Traced::new(busy_robot(), Vec::new()).whole_scans();
    calls(&mut robot, numbers);
    let digest = robot.digest();
    (robot.finish().1.unwrap(), digest)
}

/// Reference implementation of FNV-1a.
fn fnv_1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(14_695_981_039_346_656_037, |hash: u64, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(1_099_511_628_211)
    })
}

proptest! {
    #![proptest_config(crate::testing::cases(48))]

    #[test]
    fn equal_runs_give_equal_bytes(numbers in proptest::collection::vec(0..CALLS, 0..60)) {
        let (bytes, digest) = trace(&numbers);
        prop_assert_eq!(&(bytes.clone(), digest), &trace(&numbers));
        prop_assert_eq!(digest, fnv_1a(&bytes));
        let text = String::from_utf8(bytes).unwrap();
        prop_assert!(text.lines().count() >= numbers.len());
    }

    #[test]
    fn floats_read_back_as_the_same_bits(value in any::<f64>().prop_filter("a number", |v| !v.is_nan())) {
        let mut robot = Traced::new(MockRobot::new().with_distance(Psd(5), value), Vec::new());
        robot.distance(Psd(5)).unwrap();
        let text = String::from_utf8(robot.finish().1.unwrap()).unwrap();
        let written = text.trim_end().rsplit(' ').next().unwrap();
        prop_assert_eq!(written.parse::<f64>().unwrap().to_bits(), value.to_bits());
    }
}

/// The digest of one run on a stack of all wrappers.
fn stacked_digest(seed: u64, numbers: &[u8]) -> u64 {
    let limits = Limits { linear: 0.15, linear_acceleration: 0.5, ..Limits::default() };
    let faults =
        "late:front=0.2@0.5 jump@1 stuck:lidar@1.5-3".split(' ').map(|f| f.parse().unwrap()).collect();
    let robot = Noisy::new(busy_robot(), Noise::default(), &Stream::new(seed)).unwrap();
    let robot = Limited::new(Faulty::new(robot, faults), limits).unwrap();
    let mut robot = Traced::new(robot, io::sink()).whole_scans();
    calls(&mut robot, numbers);
    robot.digest()
}

/// This number must never change, on any platform: recorded runs are compared with it.
#[test]
fn a_run_on_a_stack_has_a_fixed_digest() {
    let numbers: Vec<u8> = (0..42).chain(0..20).chain([1, 1, 14, 17, 4, 1, 17, 4, 3]).collect();
    assert_eq!(stacked_digest(1, &numbers), stacked_digest(1, &numbers));
    assert_ne!(stacked_digest(1, &numbers), stacked_digest(2, &numbers));
    assert_eq!(stacked_digest(1, &numbers), 0x4161_0c63_c1df_1c61);
}

#[test]
fn a_trace_sees_what_is_inside_of_it() {
    let robot = || MockRobot::new().with_distance(Psd::FRONT, 0.5);
    let stream = Stream::new(9);
    let mut outside = Traced::new(Noisy::new(robot(), Noise::default(), &stream).unwrap(), Vec::new());
    let noisy = outside.distance(Psd::FRONT).unwrap();
    let mut inside = Noisy::new(Traced::new(robot(), Vec::new()), Noise::default(), &stream).unwrap();
    assert_eq!(inside.distance(Psd::FRONT).unwrap(), noisy);
    let text = |bytes: io::Result<Vec<u8>>| String::from_utf8(bytes.unwrap()).unwrap();
    assert_eq!(text(outside.finish().1), format!("0.0 distance(1) -> {noisy:?}\n"));
    assert_eq!(text(inside.into_inner().finish().1), "0.0 distance(1) -> 0.5\n");
}

#[test]
fn known_digests() {
    assert_eq!(Traced::new(busy_robot(), io::sink()).digest(), 0xcbf2_9ce4_8422_2325);
    assert_eq!(fnv_1a(b"foobar"), 0x8594_4171_f739_67e8);
}

#[test]
fn every_line_has_its_fixed_form() {
    let scan = LidarScan {
        angle_min: -0.5,
        angle_increment: 1.0,
        range_max: 4.0,
        ranges: vec![0.1, f64::INFINITY],
        ..LidarScan::default()
    };
    let mock = MockRobot::new()
        .with_scan(scan)
        .with_pose(Pose::new(0.1, -0.0, 1e-7))
        .with_distance(Psd::FRONT, f64::NAN);
    let mut robot = Traced::new(mock, Vec::new()).whole_scans();
    robot.wait(0.1).unwrap();
    robot.pose().unwrap();
    robot.distance(Psd::FRONT).unwrap();
    assert!(robot.distance(Psd(9)).is_err());
    robot.scan().unwrap();
    robot.print("a \"b\"\n").unwrap();
    robot.pixel((-1, 0)).unwrap();
    robot.set_menu(["", "b", "c", "END"]).unwrap();
    let gray = image::GrayImage::new(3, 2);
    robot.draw_image(DisplayImage::Binary(&gray), Viewport::new((1, -2), 3, 4)).unwrap();
    robot.send(2, b"\x00hi\n").unwrap();
    robot.set_speed(Twist::new(1.0 / 3.0, 0.0)).unwrap();
    let text = String::from_utf8(robot.finish().1.unwrap()).unwrap();
    let expected = r#"0.0 wait(0.1) -> ok
0.1 pose() -> (0.1, -0.0, 1e-7)
0.1 distance(1) -> NaN
0.1 distance(9) -> error Unsupported "no script says what the PSD 9 reads"
0.1 scan_into() -> 2 beams 0e276b3c83337db9 from -0.5 by 1.0 to 4.0 at (0.0, 0.0, 0.0) [0.1, inf]
0.1 print("a \"b\"\n") -> ok
0.1 pixel((-1, 0)) -> none
0.1 set_menu(["", "b", "c", "END"]) -> ok
0.1 draw_image(binary 3x2 d7e4fcfa299d713d, ((1, -2), 3, 4)) -> ok
0.1 send(2, "\x00hi\n") -> ok
0.1 set_speed((0.3333333333333333, 0.0)) -> ok
"#;
    assert_eq!(text, expected);
}

#[test]
fn a_trace_can_leave_the_clock_alone() {
    let mut robot = Traced::new(busy_robot(), Vec::new()).with_stamp(Stamp::LastKnown);
    robot.distance(Psd::LEFT).unwrap();
    robot.now().unwrap();
    robot.distance(Psd::LEFT).unwrap();
    let text = String::from_utf8(robot.finish().1.unwrap()).unwrap();
    assert_eq!(text, "? distance(2) -> inf\n0.002 now() -> 0.002\n0.002 distance(2) -> inf\n");
}

#[test]
fn a_time_that_the_robot_cannot_tell_is_a_question_mark() {
    let faulty = Faulty::new(busy_robot(), vec!["link@0".parse().unwrap()]);
    let mut robot = Traced::new(faulty, Vec::new());
    assert!(robot.print("x").is_err());
    assert!(robot.now().is_err());
    let text = String::from_utf8(robot.finish().1.unwrap()).unwrap();
    assert_eq!(
        text,
        "? print(\"x\") -> error Disconnected \"the link to the robot is gone\"\n\
         ? now() -> error Disconnected \"the link to the robot is gone\"\n"
    );
}

/// Accepts some bytes, then fails, each time with another message.
struct Full {
    room: usize,
    failures: usize,
}

impl io::Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.room >= bytes.len() {
            self.room -= bytes.len();
            return Ok(bytes.len());
        }
        self.failures += 1;
        Err(io::Error::other(format!("failure {}", self.failures)))
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_failing_writer_does_not_disturb_the_run() {
    let numbers: Vec<u8> = (0..CALLS).collect();
    let mut healthy = Traced::new(busy_robot(), Vec::new());
    let expected = calls(&mut healthy, &numbers);
    let mut failing = Traced::new(busy_robot(), Full { room: 100, failures: 0 });
    assert_eq!(calls(&mut failing, &numbers), expected);
    assert_eq!(failing.digest(), healthy.digest());
    let (robot, written) = failing.finish();
    assert_eq!(robot.calls(), healthy.inner().calls());
    assert_eq!(written.err().unwrap().to_string(), "failure 1");
}

#[test]
fn a_writer_that_cannot_flush_is_an_error() {
    struct Unflushable;
    impl io::Write for Unflushable {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            Ok(bytes.len())
        }
        fn flush(&mut self) -> io::Result<()> {
            Err(io::Error::other("no room"))
        }
    }
    let mut robot = Traced::new(busy_robot(), Unflushable);
    robot.wait(0.1).unwrap();
    assert_eq!(robot.finish().1.err().unwrap().to_string(), "no room");
}
