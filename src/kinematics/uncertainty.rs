use nalgebra::{Matrix2, Matrix3, SMatrix, Vector3};

use super::integrate::sinc;
use super::{Differential, Displacement, advance};
use crate::geometry::{Point, Pose, Vector, math};

/// Deviation beyond which a measurement is an outlier (standard deviations).
pub(crate) const OUTLIER: f64 = 4.0;
/// Minimum standard deviation of a range, which accounts for unmodelled errors (m).
pub(crate) const LEAST_RANGE_ERROR: f64 = 0.001;
/// Standard deviation of odometry along the path (fraction of the distance).
pub(crate) const DISTANCE_ERROR: f64 = 0.01;
/// Standard deviation of odometry in turns (fraction of the angle).
pub(crate) const TURN_ERROR: f64 = 0.006;
/// Standard deviation of an unknown wheel size (relative).
pub(crate) const SCALE_ERROR: f64 = 0.015;

/// How wrong the odometry of a differential drive is, as standard deviations.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OdometryErrors {
    /// Common relative error of both wheel diameters; constant for a robot.
    pub wheel_scale: f64,
    /// Relative difference between the wheel diameters; constant for a robot.
    pub wheel_mismatch: f64,
    /// Relative error of the track; constant for a robot.
    pub track: f64,
    /// Slip of each wheel after one metre (m); it grows with the square root of the distance.
    pub slip: f64,
}

/// Odometry with the covariance of its error.
///
/// Two kinds of error accumulate differently. Slip is independent in every step, so its variance grows with
/// the distance. A wheel that is 1 % too large is so in every step, and its effect on the way out may cancel
/// on the way back. Therefore the derivatives of the pose with respect to the three systematic errors are
/// propagated, and become a covariance only at the end. The distinction follows J. Borenstein and L. Feng,
/// "Measurement and correction of systematic odometry errors in mobile robots", 1996; the propagation follows
/// K. S. Chong and L. Kleeman, "Accurate odometry and error modelling for a mobile robot", 1997.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::kinematics::{Differential, Displacement, OdometryErrors, OdometryUncertainty};
/// let errors = OdometryErrors { wheel_scale: 0.01, ..OdometryErrors::default() };
/// let mut odometry = OdometryUncertainty::new(Pose::default(), Differential { track: 0.09 }, errors);
/// odometry.advance(Displacement { length: 2.0, angle: 0.0 });
/// // 1 % of 2 m, along the path.
/// assert!((odometry.covariance()[(0, 0)].sqrt() - 0.02).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OdometryUncertainty {
    drive: Differential,
    errors: OdometryErrors,
    pose: Pose,
    /// Covariance due to slip.
    random: Matrix3<f64>,
    /// Derivatives of the true pose with respect to scale, mismatch and track.
    systematic: Matrix3<f64>,
}

impl OdometryUncertainty {
    /// Odometry that starts at a known pose.
    pub fn new(pose: Pose, drive: Differential, errors: OdometryErrors) -> Self {
        Self { drive, errors, pose, random: Matrix3::zeros(), systematic: Matrix3::zeros() }
    }

    /// Pose by odometry.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Advances by a measured motion. Slip is assumed uniform over the step, which holds for turns of less
    /// than about 0.5 rad.
    pub fn advance(&mut self, motion: Displacement) {
        let step = OdometryStep::new(self.pose, motion, self.drive, &self.errors);
        self.random = step.by_pose * self.random * step.by_pose.transpose() + step.slip;
        self.systematic = step.by_pose * self.systematic + step.by_errors;
        self.pose = step.end;
    }

    /// Advances to the pose that odometry reports now, as one arc.
    pub fn advance_to(&mut self, pose: Pose) {
        self.advance(arc_between(self.pose, pose));
        // An arc may miss the pose by a rounding error, or by one tick of a wheel.
        self.pose = pose;
    }

    /// Covariance of x, y and heading (m, rad).
    pub fn covariance(&self) -> Matrix3<f64> {
        let OdometryErrors { wheel_scale, wheel_mismatch, track, .. } = self.errors;
        let squares = Vector3::new(wheel_scale, wheel_mismatch, track).map(|sigma| sigma * sigma);
        self.random + self.systematic * Matrix3::from_diagonal(&squares) * self.systematic.transpose()
    }

    /// Squared Mahalanobis distance of a true position from that of odometry: above 5.99 for 5 % of all
    /// robots. Infinite for a position that is impossible without errors.
    pub fn distance_squared(&self, position: Point) -> f64 {
        let covariance = self.covariance().fixed_view::<2, 2>(0, 0).into_owned();
        let away = position - self.pose.position();
        match covariance.try_inverse() {
            Some(inverse) => (away.transpose() * inverse * away)[0],
            None if away == Vector::zeros() => 0.0,
            None => f64::INFINITY,
        }
    }
}

/// A step of odometry with the derivatives of its end pose.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OdometryStep {
    /// End pose, if odometry is right.
    pub(crate) end: Pose,
    /// Derivatives with respect to the start pose.
    pub(crate) by_pose: Matrix3<f64>,
    /// Derivatives with respect to scale, mismatch and track.
    pub(crate) by_errors: Matrix3<f64>,
    /// Covariance added by slip.
    pub(crate) slip: Matrix3<f64>,
}

impl OdometryStep {
    pub(crate) fn new(
        pose: Pose,
        motion: Displacement,
        drive: Differential,
        errors: &OdometryErrors,
    ) -> Self {
        let end = advance(pose, motion);
        let moved = end.position() - pose.position();
        let by_pose = Matrix3::new(1.0, 0.0, -moved.y, 0.0, 1.0, moved.x, 0.0, 0.0, 1.0);
        let by_motion = by_motion(pose, motion);

        // Derivatives of length and angle with respect to the wheel distances and the systematic errors.
        let track = drive.track;
        let by_wheels = Matrix2::new(0.5, 0.5, -1.0 / track, 1.0 / track);
        let half = 0.5 * track * motion.angle;
        let [left, right] = [motion.length - half, motion.length + half].map(f64::abs);
        let variance = errors.slip * errors.slip;
        let slip = by_motion * by_wheels;
        let by_systematic = SMatrix::<f64, 2, 3>::new(
            motion.length,
            0.25 * track * motion.angle,
            0.0,
            motion.angle,
            motion.length / track,
            -motion.angle,
        );
        Self {
            end,
            by_pose,
            by_errors: by_motion * by_systematic,
            slip: slip * Matrix2::new(variance * left, 0.0, 0.0, variance * right) * slip.transpose(),
        }
    }
}

/// Derivatives of the pose after an arc with respect to its length and angle.
fn by_motion(pose: Pose, motion: Displacement) -> SMatrix<f64, 3, 2> {
    let half = 0.5 * motion.angle;
    let (sin, cos) = math::sin_cos(pose.heading + half);
    let chord = sinc(half);
    let (bend, shorter) = (0.5 * motion.length * chord, 0.5 * motion.length * sinc_slope(half, chord));
    SMatrix::<f64, 3, 2>::new(
        chord * cos,
        shorter * cos - bend * sin,
        chord * sin,
        shorter * sin + bend * cos,
        0.0,
        1.0,
    )
}

/// Derivative of `sin(x) / x`, given its value.
fn sinc_slope(x: f64, sinc: f64) -> f64 {
    // The truncated series errs by less than 4e-11 here; the quotient would lose more.
    if x.abs() < 0.01 { -x / 3.0 * (1.0 - 0.1 * x * x) } else { (math::cos(x) - sinc) / x }
}

/// Arc from one pose to another; exact only if they lie on one.
pub(crate) fn arc_between(from: Pose, to: Pose) -> Displacement {
    let angle = crate::geometry::angle_difference(to.heading, from.heading);
    let (sin, cos) = math::sin_cos(from.heading + 0.5 * angle);
    let chord = (to.x - from.x) * cos + (to.y - from.y) * sin;
    Displacement { length: chord / sinc(0.5 * angle), angle }
}

#[cfg(test)]
mod tests;
