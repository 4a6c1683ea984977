use nalgebra::{Matrix3, RowVector3, Vector3};

use crate::geometry::{FittedLine, Point, Pose, math};
use crate::kinematics::OUTLIER;

/// A wall on the left as a parabola in the robot's frame, `y = a + b x + c x² / 2`, estimated by a Kalman
/// filter: odometry predicts it, points of the side sensor correct it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WallTracker {
    state: Vector3<f64>,
    covariance: Matrix3<f64>,
    /// Running mean of the normalised innovations; reveals a bend of the wall.
    bias: f64,
}

/// Relation of a reading to the tracked wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reading {
    /// A point of the wall.
    Wall,
    /// Farther away: the wall may have ended.
    Beyond,
    /// Nearer: something stands in front of the wall.
    Before,
}

/// Variance added per metre of wall to its distance, slope and curvature.
const WANDER: [f64; 3] = [2e-5, 8e-3, 120.0];
/// Maximum credible curvature, and its initial standard deviation (1/m).
const TIGHTEST: f64 = 3.0;

/// Distance up to which points belong to one surface (m). A reading that deviates by more may not be of the
/// wall; a new wall whose line passes the corner by less begins there.
pub(super) const ONE_SURFACE: f64 = 0.05;
/// Sum of innovations above which the wall has a bend, ...
const BEND: f64 = 1.1;
/// ... and the standard deviations of slope and curvature that are then added.
const BEND_SPREAD: [f64; 2] = [0.12, 1.0];
/// Weight of a new innovation in the running mean.
const MEMORY: f64 = 0.12;

impl WallTracker {
    /// A wall along a known line in the robot's frame.
    pub(super) fn of_line(line: &FittedLine, range_error: f64) -> Self {
        let slope = line.direction.y / line.direction.x.max(0.1);
        let distance = line.middle.y - slope * line.middle.x;
        let count = line.points.max(2) as f64;
        let error = range_error.max(line.rms).max(1e-4);
        let of_slope = 3.5 * error / (line.length.max(0.02) * count.sqrt());
        let of_distance = error / count.sqrt() + of_slope * line.middle.x.abs();
        Self::with_spread(distance, slope, [of_distance, of_slope.min(0.5), TIGHTEST])
    }

    /// A wall roughly along a line, with its points still to be added.
    pub(super) fn like_line(line: &FittedLine) -> Self {
        let slope = line.direction.y / line.direction.x.max(0.1);
        Self::with_spread(line.middle.y - slope * line.middle.x, slope, [0.05, 0.3, TIGHTEST])
    }

    /// A wall at a distance (m), assumed parallel to the robot.
    pub(super) fn beside(distance: f64, range_error: f64) -> Self {
        Self::with_spread(distance, 0.0, [range_error.max(1e-3), 0.3, TIGHTEST])
    }

    fn with_spread(distance: f64, slope: f64, spread: [f64; 3]) -> Self {
        Self {
            state: Vector3::new(distance, slope, 0.0),
            covariance: Matrix3::from_diagonal(&Vector3::from(spread.map(|s| s * s))),
            bias: 0.0,
        }
    }

    /// Predicts the wall after the robot's motion, given in the previous robot frame.
    pub(super) fn predict(&mut self, motion: &Pose) {
        let [a, b, c] = self.state.into();
        let (x, turn) = (motion.x, motion.heading);
        let stretch = 1.0 + b * b;
        self.state = Vector3::new(a + b * x + 0.5 * c * x * x - motion.y, b + c * x - turn * stretch, c);
        let carried = Matrix3::new(1.0, x, 0.5 * x * x, 0.0, 1.0 - 2.0 * b * turn, x, 0.0, 0.0, 1.0);
        let distance = math::hypot(motion.x, motion.y);
        let added = Vector3::from(WANDER) * distance + Vector3::new(0.0, 1e-4 * turn.abs(), 0.0);
        self.covariance = carried * self.covariance * carried.transpose() + Matrix3::from_diagonal(&added);
    }

    /// Updates the wall with a point of the side sensor, if it belongs to the wall.
    pub(super) fn update(&mut self, point: Point, range_error: f64) -> Reading {
        let measured = RowVector3::new(1.0, point.x, 0.5 * point.x * point.x);
        let innovation = point.y - (measured * self.state)[0];
        let noise = range_error.max(1e-3);
        let spread = (measured * self.covariance * measured.transpose())[0] + noise * noise;
        let gate = ONE_SURFACE.max(OUTLIER * noise).max(OUTLIER * spread.sqrt());
        if innovation > gate {
            return Reading::Beyond;
        }
        if innovation < -gate {
            return Reading::Before;
        }
        self.bias += MEMORY * (innovation / spread.sqrt() - self.bias);
        if self.bias.abs() > BEND {
            self.covariance[(1, 1)] += BEND_SPREAD[0] * BEND_SPREAD[0];
            self.covariance[(2, 2)] += BEND_SPREAD[1] * BEND_SPREAD[1];
            self.bias *= 0.5;
        }
        let spread = (measured * self.covariance * measured.transpose())[0] + noise * noise;
        let gain = self.covariance * measured.transpose() / spread;
        self.state += gain * innovation;
        let rest = Matrix3::identity() - gain * measured;
        self.covariance =
            rest * self.covariance * rest.transpose() + gain * gain.transpose() * (noise * noise);
        self.state.z = self.state.z.clamp(-TIGHTEST, TIGHTEST);
        Reading::Wall
    }

    /// The wall's direction relative to the robot's heading.
    pub(super) fn angle(&self) -> f64 {
        math::atan(self.state.y)
    }

    /// Distance from the robot's centre to the wall (m).
    pub(super) fn distance(&self) -> f64 {
        self.state.x * math::cos(self.angle())
    }

    /// Curvature of the wall (1/m); positive where it recedes to the left.
    pub(super) fn curvature(&self) -> f64 {
        let stretch = 1.0 + self.state.y * self.state.y;
        self.state.z / (stretch * stretch.sqrt())
    }

    /// The wall's point at a forward coordinate in the robot's frame (m).
    pub(super) fn point_at(&self, x: f64) -> Point {
        let [a, b, c] = self.state.into();
        Point::new(x, a + b * x + 0.5 * c * x * x)
    }
}
