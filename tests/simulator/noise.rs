//! Whether errors have the sizes that the noise model says.

use nalgebra::{Matrix3, Vector3};
use roverlab::geometry::{Pose, angle_difference};
use roverlab::io::sim::{NoiseModel, SimOptions};
use roverlab::io::{DistanceSensors, Lidar, Manoeuvres, Odometry, Psd};
use roverlab::kinematics::{Displacement, advance};
use roverlab::world::{RobotSpec, Scene, World};

use crate::common::{ENCODER_TICK, open_floor, start};

/// The S4's track in metres.
const TRACK: f64 = 0.09;
const SEEDS: u64 = 1000;
const START: Pose = Pose::new(5.0, 5.0, 0.0);

fn exact(noise: NoiseModel, seed: u64) -> SimOptions {
    SimOptions { seed, noise, ideal_encoders: true, ..SimOptions::default() }
}

/// The true pose at the end of a manoeuvre, as seen from where it should have ended.
fn error_of(motion: Displacement, noise: NoiseModel, seed: u64) -> Pose {
    let (mut robot, truth) = start(&open_floor(START), exact(noise, seed));
    robot.curve(motion.length, motion.angle, 0.5).unwrap();
    robot.wait_done().unwrap();
    advance(START, motion).inverse().compose(&truth.pose(0).unwrap())
}

/// A sum of `n` squares of standard normal numbers is within five of its standard deviations.
fn assert_chi_square(sum: f64, n: f64, what: &str) {
    assert!((sum - n).abs() < 5.0 * (2.0 * n).sqrt(), "{what}: {sum} for {n}");
}

/// The errors at the end of a straight drive: of the length, aside, and of the heading.
fn straight_covariance(noise: &NoiseModel, length: f64) -> Matrix3<f64> {
    // Both wheels' slips move the robot on by their mean and turn it by their difference.
    let slip = noise.slip * noise.slip * length;
    let turned_by_slip = 2.0 * slip / (TRACK * TRACK);
    let turned_by_wheels = square(noise.wheel_mismatch * length / TRACK);
    let along = square(noise.wheel_scale * length) + 0.5 * slip;
    // A heading error that grows steadily carries the robot aside by half of it times the way; one that comes
    // in small independent parts has a third of its variance.
    let aside = length * length * (0.25 * turned_by_wheels + turned_by_slip / 3.0);
    let both = 0.5 * length * (turned_by_wheels + turned_by_slip);
    let turned = turned_by_wheels + turned_by_slip;
    Matrix3::new(along, 0.0, 0.0, 0.0, aside, both, 0.0, both, turned)
}

fn square(x: f64) -> f64 {
    x * x
}

#[test]
fn straight_drives_err_as_the_model_predicts() {
    for (factor, length) in [(1.0, 1.0), (0.5, 3.0), (3.0, 0.5)] {
        let noise = NoiseModel::real().scaled(factor);
        let covariance = straight_covariance(&noise, length);
        let inverse = covariance.try_inverse().unwrap();
        let (mut sum, mut squares, mut distances) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        let (mut cross, mut cross_along) = (0.0, 0.0);
        for seed in 0..SEEDS {
            let error = error_of(Displacement { length, angle: 0.0 }, noise, seed);
            let error = Vector3::new(error.x, error.y, error.heading);
            sum += error;
            squares += error.component_mul(&error);
            cross += error.y * error.z;
            cross_along += error.x * error.z;
            distances += error.dot(&(inverse * error));
        }
        let n = SEEDS as f64;
        for (i, what) in ["along", "aside", "heading"].into_iter().enumerate() {
            let variance = covariance[(i, i)];
            assert!(
                (sum[i] / n).abs() < 4.0 * (variance / n).sqrt(),
                "{what} at factor {factor}: mean {}",
                sum[i] / n
            );
            assert_chi_square(squares[i] / variance, n, &format!("{what} at factor {factor}"));
        }
        assert_chi_square(distances, 3.0 * n, &format!("all at factor {factor}"));
        // The standard error of this estimate is at most the root of 2 / n.
        let correlation = |sum: f64, i: usize| sum / n / (covariance[(i, i)] * covariance[(2, 2)]).sqrt();
        let expected = covariance[(1, 2)] / (covariance[(1, 1)] * covariance[(2, 2)]).sqrt();
        assert!((correlation(cross, 1) - expected).abs() < 0.2, "{} {expected}", correlation(cross, 1));
        assert!(correlation(cross_along, 0).abs() < 0.16, "{}", correlation(cross_along, 0));
    }
}

#[test]
fn turns_err_as_the_model_predicts() {
    let (noise, angle) = (NoiseModel::real(), 3.0);
    // Wheels that are too large turn the robot too far, a track that is too wide not far enough.
    let scale = noise.wheel_scale * angle;
    let track = noise.track * angle;
    let slip = 2.0 * noise.slip * noise.slip * (0.5 * TRACK * angle) / (TRACK * TRACK);
    let variance = scale * scale + track * track + slip;
    let errors = (0..SEEDS).map(|seed| error_of(Displacement { length: 0.0, angle }, noise, seed).heading);
    let squares: f64 = errors.map(|error| error * error).sum();
    assert_chi_square(squares / variance, SEEDS as f64, "turn");
}

#[test]
fn no_part_of_the_model_stands_in_for_another() {
    let ideal = NoiseModel::ideal();
    let motion = Displacement { length: 1.0, angle: 0.0 };
    let sum_of = |noise: NoiseModel, part: fn(Pose) -> f64| -> f64 {
        (0..300).map(|seed| part(error_of(motion, noise, seed))).map(|e| e * e).sum()
    };
    let scale = NoiseModel { wheel_scale: 0.01, ..ideal };
    assert_chi_square(sum_of(scale, |e| e.x / 0.01), 300.0, "scale");
    assert!(sum_of(scale, |e| e.heading) < 1e-15);
    let mismatch = NoiseModel { wheel_mismatch: 0.0003, ..ideal };
    assert_chi_square(sum_of(mismatch, |e| e.heading * TRACK / 0.0003), 300.0, "mismatch");
    let slip = NoiseModel { slip: 0.0005, ..ideal };
    assert_chi_square(
        sum_of(slip, |e| e.heading * TRACK / (0.0005 * std::f64::consts::SQRT_2)),
        300.0,
        "slip",
    );
    let track = NoiseModel { track: 0.003, ..ideal };
    assert!(sum_of(track, |e| e.x.abs() + e.heading.abs()) < 1e-6, "a track does not matter straight on");
}

#[test]
fn range_errors_have_their_size() {
    let scene = Scene::with_robot(World::walled(3.0, 3.0), RobotSpec::s4(), Pose::new(1.2, 1.7, 0.4));
    let readings = |noise: NoiseModel, seed: u64| {
        let (mut robot, _) = start(&scene, exact(noise, seed));
        let mut all: Vec<f64> = Vec::new();
        for _ in 0..10 {
            all.extend(robot.scan().unwrap().ranges);
            all.extend((0..40).map(|i| robot.distance(Psd(1 + i % 4)).unwrap()));
        }
        all
    };
    let ideal = readings(NoiseModel::ideal(), 1);
    for factor in [0.5, 1.0, 3.0] {
        let noisy = readings(NoiseModel::real().scaled(factor), 7);
        let errors = || noisy.iter().zip(&ideal).map(|(a, b)| (a - b) / (0.010 * factor));
        let n = ideal.len() as f64;
        assert_chi_square(errors().map(|e| e * e).sum(), n, &format!("factor {factor}"));
        assert!((errors().sum::<f64>() / n).abs() < 4.0 / n.sqrt());
        let tails = errors().filter(|e| e.abs() > 2.0).count() as f64 / n;
        assert!((0.035..0.056).contains(&tails), "{tails}: not a normal distribution");
    }
    assert!(ideal.iter().all(|r| r.is_finite()));
}

#[test]
fn no_return_stays_no_return() {
    let options = SimOptions::with_noise(5.0, 1);
    let (mut robot, _) = start(&open_floor(START), options);
    assert!(robot.scan().unwrap().ranges.iter().all(|&range| range == f64::INFINITY));
    assert_eq!(robot.distance(Psd::LEFT).unwrap(), f64::INFINITY);
}

#[test]
fn the_textbook_preset_draws_anew_for_each_command() {
    let mut lengths = Vec::new();
    for seed in 0..200 {
        let (mut robot, truth) = start(&open_floor(START), exact(NoiseModel::textbook(), seed));
        for _ in 0..3 {
            let before = truth.pose(0).unwrap();
            robot.straight(0.5, 0.5).unwrap();
            robot.wait_done().unwrap();
            let driven = (truth.pose(0).unwrap().position() - before.position()).norm();
            lengths.push((driven / 0.5 - 1.0) / 0.015);
            assert!(
                angle_difference(truth.pose(0).unwrap().heading, 0.0) == 0.0,
                "straight on means straight on"
            );
        }
        let odometry = robot.pose().unwrap();
        assert!((odometry.x - 1.5).abs() < 1e-3, "odometry knows nothing of it");
    }
    let n = lengths.len() as f64;
    assert_chi_square(lengths.iter().map(|e| e * e).sum(), n, "lengths");
    let neighbours: f64 = lengths.chunks(3).map(|c| c[0] * c[1] + c[1] * c[2]).sum();
    assert!((neighbours / 400.0).abs() < 5.0 / 400.0_f64.sqrt(), "independent: {neighbours}");
}

#[test]
fn encoders_count_whole_ticks_unless_they_are_ideal() {
    for ideal_encoders in [false, true] {
        let options = SimOptions { ideal_encoders, ..SimOptions::ideal() };
        let (mut robot, _) = start(&open_floor(START), options);
        robot.straight(1.0, 0.2).unwrap();
        let mut whole = true;
        for _ in 0..20 {
            roverlab::io::Clock::wait(&mut robot, 0.0373).unwrap();
            let ticks = robot.pose().unwrap().x / ENCODER_TICK;
            whole &= (ticks - ticks.round()).abs() < 1e-6;
        }
        assert_eq!(whole, !ideal_encoders);
    }
}
