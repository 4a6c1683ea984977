use nalgebra::{Matrix2, Matrix3, SMatrix, Vector3};

use super::integrate::sinc;
use super::{Differential, Displacement, advance};
use crate::geometry::{Point, Pose, Vector, math};

/// Standard deviations beyond which a measurement is of something else than what it is held to be of.
pub(crate) const OUTLIER: f64 = 4.0;
/// The least standard deviation of a range, in metres, which keeps filters open for what they do not know about.
pub(crate) const LEAST_RANGE_ERROR: f64 = 0.001;
/// What odometry misses of a way, as a share: a standard deviation.
pub(crate) const DISTANCE_ERROR: f64 = 0.01;
/// What it misses of a turn, as a share: a standard deviation.
pub(crate) const TURN_ERROR: f64 = 0.006;
/// The standard deviation of the size of wheels, as a share, of which nothing is known.
pub(crate) const SCALE_ERROR: f64 = 0.015;

/// How wrong the odometry of a differential drive is, as standard deviations.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OdometryErrors {
    /// Relative error of both wheels' diameters together; stays the same for a robot.
    pub wheel_scale: f64,
    /// Relative difference between the left and the right wheel's diameter; stays the same for a robot.
    pub wheel_mismatch: f64,
    /// Relative error of the track; stays the same for a robot.
    pub track: f64,
    /// Slip of each wheel, in metres after one metre; it grows with the square root of the distance.
    pub slip: f64,
}

/// The pose by odometry with the covariance of its error, step by step.
///
/// Two sorts of errors add up differently. Slip is new in every step, so that its variance grows with the distance. A
/// wheel that is 1 % too large is so in every step, and what it does on the way there it may undo on the way back; so the
/// derivatives of the pose by the three systematic errors are carried along, and make a covariance at the end only
/// (after J. Borenstein and L. Feng, "Measurement and correction of systematic odometry errors in mobile robots", 1996,
/// who tell the two sorts apart, with the propagation of K. S. Chong and L. Kleeman, "Accurate odometry and error modelling
/// for a mobile robot", 1997).
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
    /// The covariance by slip alone.
    random: Matrix3<f64>,
    /// Derivatives of the true pose by scale, mismatch and track.
    systematic: Matrix3<f64>,
}

impl OdometryUncertainty {
    /// Odometry that starts at a known pose.
    pub fn new(pose: Pose, drive: Differential, errors: OdometryErrors) -> Self {
        Self { drive, errors, pose, random: Matrix3::zeros(), systematic: Matrix3::zeros() }
    }

    /// The pose by odometry.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Goes on by what odometry measured in a step. Slip is taken as coming evenly over a short step: one that turns by
    /// less than about half a radian.
    pub fn advance(&mut self, motion: Displacement) {
        let step = OdometryStep::new(self.pose, motion, self.drive, &self.errors);
        self.random = step.by_pose * self.random * step.by_pose.transpose() + step.slip;
        self.systematic = step.by_pose * self.systematic + step.by_errors;
        self.pose = step.end;
    }

    /// Goes on to where odometry is now, as one step along an arc.
    pub fn advance_to(&mut self, pose: Pose) {
        self.advance(arc_between(self.pose, pose));
        // An arc may miss the pose by a rounding error, or by what a tick of one wheel does.
        self.pose = pose;
    }

    /// The covariance of x, y and heading: how far the true pose may be from odometry's. Metres and radians.
    pub fn covariance(&self) -> Matrix3<f64> {
        let OdometryErrors { wheel_scale, wheel_mismatch, track, .. } = self.errors;
        let squares = Vector3::new(wheel_scale, wheel_mismatch, track).map(|sigma| sigma * sigma);
        self.random + self.systematic * Matrix3::from_diagonal(&squares) * self.systematic.transpose()
    }

    /// The squared Mahalanobis distance of a true position from odometry's: above 5.99 for 5 of 100 robots. Infinite for
    /// a position that an error-free robot cannot be at.
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

/// A step of odometry, and how the pose after it depends on what may be wrong.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OdometryStep {
    /// The pose after it, if odometry is right.
    pub(crate) end: Pose,
    /// Derivatives by the pose before it.
    pub(crate) by_pose: Matrix3<f64>,
    /// Derivatives by scale, mismatch and track.
    pub(crate) by_errors: Matrix3<f64>,
    /// The covariance that slip adds.
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

        // How length and angle depend on how far the left and the right wheel go, and on the systematic errors.
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

/// Derivatives of the pose after an arc by the arc's length and angle.
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

/// The derivative of `sin(x) / x`, whose value is at hand.
fn sinc_slope(x: f64, sinc: f64) -> f64 {
    // What the series leaves out is below 4e-11 there, and the quotient would lose more.
    if x.abs() < 0.01 { -x / 3.0 * (1.0 - 0.1 * x * x) } else { (math::cos(x) - sinc) / x }
}

/// The arc that leads from one pose to the next, for poses that lie on one.
pub(crate) fn arc_between(from: Pose, to: Pose) -> Displacement {
    let angle = crate::geometry::angle_difference(to.heading, from.heading);
    let (sin, cos) = math::sin_cos(from.heading + 0.5 * angle);
    let chord = (to.x - from.x) * cos + (to.y - from.y) * sin;
    Displacement { length: chord / sinc(0.5 * angle), angle }
}

#[cfg(test)]
mod tests;
