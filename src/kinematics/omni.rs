use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::{PlanarMotion, PlanarTwist};
use crate::ParameterError;
use crate::geometry::{Point, cross, direction};
use crate::parameter::{require, require_positive};

/// A wheel with passive rollers on its rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollerWheel {
    /// Position in the robot frame (m).
    pub position: Point,
    /// Rolling direction in the robot frame when the motor turns forward (rad).
    pub heading: f64,
    /// Direction of the axis of the roller that touches the floor, in the robot frame (rad): 45 degrees to
    /// the heading for Mecanum wheels, along the heading for omni-wheels.
    pub roller_axis: f64,
}

/// An omnidirectional drive with `N` roller wheels (book, section 7.2).
///
/// A roller turns freely about its axis, so a wheel transmits force only along that axis. Wheels are numbered
/// as the motors; four Mecanum wheels are front left, front right, back left, back right.
///
/// ```
/// use roverlab::kinematics::{Omni, PlanarTwist};
/// let drive = Omni::mecanum(0.2, 0.2).unwrap();
/// // To the left: the book's pattern back, forth, forth, back.
/// let speeds = drive.inverse(PlanarTwist::new(0.0, 0.1, 0.0));
/// assert_eq!(speeds.map(|v| (v * 1e6).round() / 1e6), [-0.1, 0.1, 0.1, -0.1]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Omni<const N: usize> {
    /// Maps a twist to rim speeds: one row per wheel.
    inverse: SMatrix<f64, N, 3>,
    /// Maps rim speeds to a twist, by least squares.
    forward: SMatrix<f64, 3, N>,
}

impl Omni<4> {
    /// Four Mecanum wheels at the corners of a rectangle. The roller axes on the floor are at -45 degrees
    /// front left and back right, at 45 degrees front right and back left.
    ///
    /// `track` is the distance between left and right wheels, `wheelbase` between front and back wheels (m).
    ///
    /// # Errors
    ///
    /// If a length is not positive and finite.
    pub fn mecanum(track: f64, wheelbase: f64) -> Result<Self, ParameterError> {
        require_positive("track", track)?;
        require_positive("wheelbase", wheelbase)?;
        let wheel = |front: f64, left: f64| RollerWheel {
            position: Point::new(0.5 * wheelbase * front, 0.5 * track * left),
            heading: 0.0,
            roller_axis: -FRAC_PI_4 * front * left,
        };
        Self::new([wheel(1.0, 1.0), wheel(1.0, -1.0), wheel(-1.0, 1.0), wheel(-1.0, -1.0)])
    }
}

impl Omni<3> {
    /// Three omni-wheels on a circle of `radius` (m), 120 degrees apart, each rolling along it
    /// counter-clockwise: left front, back, right front.
    ///
    /// # Errors
    ///
    /// If the radius is not positive and finite.
    pub fn three_wheels(radius: f64) -> Result<Self, ParameterError> {
        require_positive("radius", radius)?;
        Self::new([1.0, 3.0, 5.0].map(|sixths| {
            let angle = TAU / 6.0 * sixths;
            let heading = angle + FRAC_PI_2;
            RollerWheel { position: Point::from(direction(angle) * radius), heading, roller_axis: heading }
        }))
    }

    /// Three Mecanum wheels on a circle, placed as in [`three_wheels`](Omni::three_wheels), with rollers at
    /// 45 degrees to the rolling direction.
    ///
    /// # Errors
    ///
    /// If the radius is not positive and finite.
    pub fn three_mecanum_wheels(radius: f64) -> Result<Self, ParameterError> {
        require_positive("radius", radius)?;
        Self::new([1.0, 3.0, 5.0].map(|sixths| {
            let angle = TAU / 6.0 * sixths;
            let heading = angle + FRAC_PI_2;
            let position = Point::from(direction(angle) * radius);
            RollerWheel { position, heading, roller_axis: heading + FRAC_PI_4 }
        }))
    }
}

impl<const N: usize> Omni<N> {
    /// A drive with any wheels.
    ///
    /// # Errors
    ///
    /// If the rollers of a wheel roll in the direction of the wheel, or the wheels leave a direction
    /// unconstrained: fewer than three, or roller axes that all meet in a point or are parallel.
    pub fn new(wheels: [RollerWheel; N]) -> Result<Self, ParameterError> {
        let mut inverse = SMatrix::<f64, N, 3>::zeros();
        for (row, wheel) in wheels.iter().enumerate() {
            let grip = direction(wheel.roller_axis);
            let share = direction(wheel.heading).dot(&grip);
            let expected = "rollers that do not roll in the direction of their wheel";
            require("roller axis", wheel.roller_axis, share.abs() > 1e-6, expected)?;
            let turning = cross(wheel.position.coords, grip);
            inverse.set_row(row, &(nalgebra::RowVector3::new(grip.x, grip.y, turning) / share));
        }
        // Scale rotation by the size of the drive, so that the test does not depend on it.
        let size = wheels.iter().map(|wheel| wheel.position.coords.norm()).fold(1e-9, f64::max);
        let scaled = inverse * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 1.0 / size));
        let grip = (scaled.transpose() * scaled).determinant();
        require("grip of the wheels", grip, grip > 1e-6, "wheels that hold the robot in every direction")?;
        let normal = inverse.transpose() * inverse;
        let forward = normal.try_inverse().unwrap_or_else(Matrix3::zeros) * inverse.transpose();
        Ok(Self { inverse, forward })
    }

    /// Forward kinematics, by least squares: more than three wheels can be inconsistent, and some then slip.
    pub fn forward(&self, wheels: [f64; N]) -> PlanarTwist {
        let twist = self.forward * SVector::from(wheels);
        PlanarTwist::new(twist.x, twist.y, twist.z)
    }

    /// Inverse kinematics.
    pub fn inverse(&self, twist: PlanarTwist) -> [f64; N] {
        (self.inverse * Vector3::new(twist.forward, twist.left, twist.angular)).into()
    }

    /// Rim speeds for driving in a direction (rad, counter-clockwise from straight ahead) without turning
    /// (book, section 7.4).
    pub fn inverse_along(&self, heading: f64, speed: f64) -> [f64; N] {
        let along = direction(heading) * speed;
        self.inverse(PlanarTwist::new(along.x, along.y, 0.0))
    }

    /// Inverse kinematics within a limit: all rim speeds are scaled down where one would exceed `limit`
    /// (m/s), which preserves direction and curvature.
    pub fn inverse_limited(&self, twist: PlanarTwist, limit: f64) -> [f64; N] {
        let wheels = self.inverse(twist);
        let fastest = wheels.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        if fastest <= limit { wheels } else { wheels.map(|v| v * (limit / fastest)) }
    }

    /// Motion while the wheels roll these distances (m), each at a constant speed.
    pub fn displacement(&self, rolls: [f64; N]) -> PlanarMotion {
        self.forward(rolls).during(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::kinematics::advance_planar;
    use proptest::prelude::*;

    fn twist() -> impl Strategy<Value = PlanarTwist> {
        (-1.0..1.0f64, -1.0..1.0f64, -6.0..6.0f64).prop_map(|(x, y, w)| PlanarTwist::new(x, y, w))
    }

    fn near(a: PlanarTwist, b: PlanarTwist) -> bool {
        let differences = [a.forward - b.forward, a.left - b.left, a.angular - b.angular];
        differences.iter().all(|d| d.abs() < 1e-11)
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn forward_undoes_inverse(t in twist(), track in 0.1..0.5f64, wheelbase in 0.1..0.5f64) {
            let four = Omni::mecanum(track, wheelbase).unwrap();
            prop_assert!(near(four.forward(four.inverse(t)), t));
            for three in [Omni::three_wheels(track).unwrap(), Omni::three_mecanum_wheels(track).unwrap()] {
                prop_assert!(near(three.forward(three.inverse(t)), t));
            }
        }

        #[test]
        fn limits_keep_the_direction_of_motion(t in twist(), limit in 0.05..0.5f64) {
            let drive = Omni::mecanum(0.2, 0.25).unwrap();
            let wheels = drive.inverse_limited(t, limit);
            prop_assert!(wheels.iter().all(|v| v.abs() <= limit + 1e-12));
            let slower = drive.forward(wheels);
            prop_assert!((slower.forward * t.left - slower.left * t.forward).abs() < 1e-11);
            prop_assert!((slower.forward * t.angular - slower.angular * t.forward).abs() < 1e-10);
            prop_assert!(slower.forward * t.forward >= 0.0);
        }

        /// Integrates the constraint that the floor imposes on each wheel, step by step.
        #[test]
        fn fine_integration_agrees(rolls in prop::array::uniform3(-0.5..0.5f64)) {
            let drive = Omni::three_wheels(0.15).unwrap();
            let exact = advance_planar(Pose::default(), drive.displacement(rolls));
            let rate = drive.forward(rolls);
            let velocity = |heading: f64| {
                let (ahead, aside) = (direction(heading), direction(heading + FRAC_PI_2));
                ahead * rate.forward + aside * rate.left
            };
            let (steps, mut pose) = (2000, Pose::default());
            let h = 1.0 / f64::from(steps);
            for _ in 0..steps {
                let at = |t: f64| velocity(pose.heading + t * h * rate.angular);
                let step = (at(0.0) + at(0.5) * 4.0 + at(1.0)) * (h / 6.0);
                pose = Pose::new(pose.x + step.x, pose.y + step.y, pose.heading + h * rate.angular);
            }
            prop_assert!((exact.position() - pose.position()).norm() < 1e-9);
        }
    }

    #[test]
    fn the_patterns_of_the_book() {
        let drive = Omni::mecanum(0.2, 0.3).unwrap();
        let signs =
            |t: PlanarTwist| drive.inverse(t).map(|v| if v.abs() < 1e-12 { 0 } else { v.signum() as i32 });
        assert_eq!(signs(PlanarTwist::new(0.1, 0.0, 0.0)), [1, 1, 1, 1]);
        assert_eq!(signs(PlanarTwist::new(0.0, -0.1, 0.0)), [1, -1, -1, 1]);
        assert_eq!(signs(PlanarTwist::new(0.1, 0.1, 0.0)), [0, 1, 1, 0]);
        assert_eq!(signs(PlanarTwist::new(0.0, 0.0, 1.0)), [-1, 1, -1, 1]);
        let (left, also) =
            (drive.inverse_along(FRAC_PI_2, 0.1), drive.inverse(PlanarTwist::new(0.0, 0.1, 0.0)));
        assert!(left.iter().zip(also).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    #[test]
    fn wheels_that_leave_a_direction_free_are_refused() {
        let wheel = |x: f64, y: f64, roller_axis: f64| RollerWheel {
            position: Point::new(x, y),
            heading: 0.0,
            roller_axis,
        };
        // All transmit force along x only.
        assert!(Omni::new([wheel(0.1, 0.1, 0.0), wheel(-0.1, 0.1, 0.0), wheel(0.0, -0.1, 0.0)]).is_err());
        assert!(Omni::new([wheel(0.1, 0.1, 0.7), wheel(-0.1, 0.1, -0.7)]).is_err());
        // Rollers that roll in the direction of the wheel.
        assert!(
            Omni::new([wheel(0.1, 0.1, FRAC_PI_2), wheel(-0.1, 0.1, 0.7), wheel(0.0, -0.1, -0.7)]).is_err()
        );
        assert!(Omni::mecanum(f64::NAN, 0.1).is_err());
    }
}
