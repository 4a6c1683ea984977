use super::*;
use crate::random::Stream;
use proptest::prelude::*;

/// Distance between the wheels (m).
const TRACK: f64 = 0.09;
const ERRORS: OdometryErrors =
    OdometryErrors { wheel_scale: 0.01, wheel_mismatch: 0.0003, track: 0.003, slip: 0.0005 };

fn odometry(errors: OdometryErrors) -> OdometryUncertainty {
    OdometryUncertainty::new(Pose::new(0.5, 0.2, 0.4), Differential { track: TRACK }, errors)
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn arcs_are_found_again(heading in -3.0..3.0f64, length in -0.5..0.5f64, angle in -2.0..2.0f64) {
        let start = Pose::new(1.0, 2.0, heading);
        let arc = arc_between(start, advance(start, Displacement { length, angle }));
        prop_assert!((arc.length - length).abs() < 1e-9 && (arc.angle - angle).abs() < 1e-9);
    }
}

#[test]
fn there_and_back_undoes_systematic_errors() {
    let mut odometry = odometry(OdometryErrors { slip: 0.0, ..ERRORS });
    let motion = Displacement { length: 0.3, angle: 0.4 };
    odometry.advance(motion);
    assert!(odometry.covariance().norm() > 1e-7);
    odometry.advance(Displacement { length: -motion.length, angle: -motion.angle });
    assert!(odometry.covariance().norm() < 1e-20, "{}", odometry.covariance());
}

/// Compares robots with random errors to the prediction: a turn on the spot, an arc and a line.
#[test]
fn drawn_errors_have_the_predicted_covariance() {
    let steps: Vec<Displacement> = [(0.0, 0.03, 30), (0.01, 0.02, 80), (0.01, 0.0, 100)]
        .into_iter()
        .flat_map(|(length, angle, count)| vec![Displacement { length, angle }; count])
        .collect();
    let mut predicted = odometry(ERRORS);
    for &step in &steps {
        predicted.advance(step);
    }
    let mut stream = Stream::new(1);
    let (robots, mut inside, mut sum) = (4000, 0, Matrix3::zeros());
    for _ in 0..robots {
        let end = drawn(&steps, &mut stream);
        inside += usize::from(predicted.distance_squared(end.position()) <= 5.991);
        let odometry = predicted.pose();
        let error = Vector3::new(end.x - odometry.x, end.y - odometry.y, end.heading - odometry.heading);
        sum += error * error.transpose() / f64::from(robots);
    }
    let (share, covariance) = (inside as f64 / f64::from(robots), predicted.covariance());
    assert!((0.94..0.96).contains(&share), "{share}");
    for i in 0..3 {
        let ratio = sum[(i, i)] / covariance[(i, i)];
        assert!((0.92..1.08).contains(&ratio), "{i}: {ratio}");
    }
}

/// End pose of a robot with random errors whose odometry measures these steps.
fn drawn(steps: &[Displacement], stream: &mut Stream) -> Pose {
    let scale = ERRORS.wheel_scale * stream.normal();
    let mismatch = 0.5 * ERRORS.wheel_mismatch * stream.normal();
    let actual = Differential { track: TRACK * (1.0 + ERRORS.track * stream.normal()) };
    let mut pose = odometry(ERRORS).pose();
    for step in steps {
        let half = 0.5 * TRACK * step.angle;
        let [left, right] = [(step.length - half, -mismatch), (step.length + half, mismatch)].map(
            |(roll, mismatch): (f64, f64)| {
                roll * (1.0 + scale + mismatch) + ERRORS.slip * roll.abs().sqrt() * stream.normal()
            },
        );
        pose = advance(pose, actual.displacement(left, right));
    }
    pose
}
