use super::busy_robot;
use crate::geometry::{Pose, Twist};
use crate::io::wrappers::{Fault, Faulty, Noise, Noisy};
use crate::io::{Camera, DistanceSensors, ErrorKind, Lidar, LidarScan, MockRobot, Odometry, Psd};
use crate::random::Stream;

fn noisy(robot: MockRobot, noise: Noise) -> Noisy<MockRobot> {
    Noisy::new(robot, noise, &Stream::new(5)).unwrap()
}

fn mean_and_deviation(samples: &[f64]) -> (f64, f64) {
    let n = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / n;
    let variance = samples.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n;
    (mean, variance.sqrt())
}

#[test]
fn every_reading_has_the_deviation_that_was_asked_for() {
    let noise = Noise {
        distance: 0.01,
        lidar: 0.02,
        image: 2.0,
        position: 0.03,
        heading: 0.04,
        linear: 0.05,
        angular: 0.06,
    };
    let scan = LidarScan { range_max: 9.0, ranges: vec![1.0], ..LidarScan::default() };
    let robot = MockRobot::new()
        .with_distance(Psd::FRONT, 1.0)
        .with_scan(scan)
        .with_pose(Pose::new(1.0, 1.0, 1.0))
        .with_speed(Twist::new(1.0, 1.0));
    let mut robot = noisy(robot, noise);
    let mut samples = vec![vec![]; 7];
    for _ in 0..5000 {
        let (pose, speed) = (robot.pose().unwrap(), robot.speed().unwrap());
        let range = robot.scan().unwrap().ranges[0];
        let distance = robot.distance(Psd::FRONT).unwrap();
        let readings = [distance, range, pose.x, pose.y, pose.heading, speed.linear, speed.angular];
        samples.iter_mut().zip(readings).for_each(|(s, r)| s.push(r));
    }
    for (samples, sigma) in samples.iter().zip([0.01, 0.02, 0.03, 0.03, 0.04, 0.05, 0.06]) {
        let (mean, deviation) = mean_and_deviation(samples);
        assert!((mean - 1.0).abs() < 0.05 * sigma, "{mean} {sigma}");
        assert!((deviation / sigma - 1.0).abs() < 0.05, "{deviation} {sigma}");
    }
}

#[test]
fn images_have_noise_that_keeps_to_bytes() {
    let level =
        |level| MockRobot::new().with_image(image::RgbImage::from_pixel(60, 50, image::Rgb([level; 3])));
    let samples = |value: u8, sigma: f64| {
        let mut robot = noisy(level(value), Noise { image: sigma, ..Noise::NONE });
        robot.image().unwrap().iter().map(|&v| f64::from(v)).collect::<Vec<f64>>()
    };
    let (mean, deviation) = mean_and_deviation(&samples(100, 5.0));
    assert!((mean - 100.0).abs() < 0.3 && (deviation - 5.0).abs() < 0.25, "{mean} {deviation}");
    let (dark, bright) = (samples(0, 200.0), samples(255, 200.0));
    assert!(dark.contains(&0.0) && dark.contains(&255.0) && bright.contains(&0.0) && bright.contains(&255.0));
    assert_eq!(samples(100, 0.0), vec![100.0; 9000]);
}

#[test]
fn sensors_have_their_own_streams() {
    let robot = || MockRobot::new().with_distance(Psd::FRONT, 1.0).with_distance(Psd::LEFT, 1.0);
    let mut one = noisy(robot(), Noise::default());
    let mut other = noisy(robot(), Noise::default());
    (0..10).for_each(|_| assert!(other.distance(Psd::LEFT).is_ok()));
    assert_eq!(one.distance(Psd::FRONT).unwrap(), other.distance(Psd::FRONT).unwrap());
    assert_ne!(one.distance(Psd::FRONT).unwrap(), one.distance(Psd::LEFT).unwrap());
}

#[test]
fn noise_keeps_readings_possible() {
    let noise = Noise { distance: 10.0, lidar: 10.0, ..Noise::NONE };
    let scan = LidarScan { range_max: 5.0, ranges: vec![0.1, 4.9, f64::INFINITY], ..LidarScan::default() };
    let mut robot = noisy(
        MockRobot::new()
            .with_distance(Psd::FRONT, 0.1)
            .with_distance(Psd::BACK, f64::INFINITY)
            .with_scan(scan),
        noise,
    );
    for _ in 0..200 {
        assert!(robot.distance(Psd::FRONT).unwrap() >= 0.0);
        assert_eq!(robot.distance(Psd::BACK).unwrap(), f64::INFINITY);
        let ranges = robot.scan().unwrap().ranges;
        assert!(ranges[..2].iter().all(|r| (0.0..=5.0).contains(r)), "{ranges:?}");
        assert_eq!(ranges[2], f64::INFINITY);
    }
}

#[test]
fn the_order_of_a_stack_matters() {
    let stuck = || vec!["stuck:front@0".parse::<Fault>().unwrap()];
    let stream = Stream::new(2);
    let steady = |robot: &mut dyn DistanceSensors| {
        robot.distance(Psd::FRONT).unwrap() == robot.distance(Psd::FRONT).unwrap()
    };
    // A stuck sensor repeats its noisy reading; noise over a stuck sensor still changes.
    let mut outside = Faulty::new(Noisy::new(busy_robot(), Noise::default(), &stream).unwrap(), stuck());
    let mut inside = Noisy::new(Faulty::new(busy_robot(), stuck()), Noise::default(), &stream).unwrap();
    assert!(steady(&mut outside) && !steady(&mut inside));
}

#[test]
fn impossible_deviations_are_refused() {
    for sigma in [-0.1, f64::NAN, f64::INFINITY] {
        let noise = Noise { heading: sigma, ..Noise::NONE };
        let error = Noisy::new(busy_robot(), noise, &Stream::new(1)).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidInput);
        assert!(error.to_string().starts_with("noise of the heading is "), "{error}");
    }
}
