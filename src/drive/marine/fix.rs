use nalgebra::{Matrix3, RowVector3, Vector3};

use crate::geometry::{Aabb, Point, Pose, Vector, direction, math};

/// The position in a pool with four sides, and how sure it is: an extended Kalman filter of the place and the
/// compass's error, moved by the log and corrected by distances to the sides (Thrun et al., *Probabilistic
/// Robotics*, 2005, section 3.3).
#[derive(Debug, Clone)]
pub(super) struct Fix {
    /// Place, and what the compass reads too much (rad).
    state: Vector3<f64>,
    covariance: Matrix3<f64>,
    /// The sides of the pool; without them, there is only the log.
    sides: Option<Aabb>,
    odometry: Option<Pose>,
    heading: f64,
    velocity: Vector,
}

/// Standard deviations: of the place at the start (m), the compass's error (rad) and its drift (rad/√s), the
/// log's scale and its walk (m/√s), and a distance (m).
const START: f64 = 0.05;
const COMPASS: f64 = 0.01;
const DRIFT: f64 = 0.001;
const SCALE: f64 = 0.005;
const WALK: f64 = 0.004;
const RANGE: f64 = 0.015;
/// The most standard deviations that a distance may be off: what is nearer is no side.
const GATE: f64 = 4.0;

impl Fix {
    pub(super) fn new(start: Pose, sides: Option<Aabb>) -> Self {
        let covariance = Vector3::new(START * START, START * START, COMPASS * COMPASS);
        Self {
            state: Vector3::new(start.x, start.y, 0.0),
            covariance: Matrix3::from_diagonal(&covariance),
            sides,
            odometry: None,
            heading: start.heading,
            velocity: Vector::zeros(),
        }
    }

    pub(super) fn pose(&self) -> Pose {
        Pose::new(self.state.x, self.state.y, self.heading - self.state.z)
    }

    /// The larger standard deviation of the place along x and y (m).
    pub(super) fn sigma(&self) -> f64 {
        self.covariance[(0, 0)].max(self.covariance[(1, 1)]).sqrt()
    }

    /// The speed forward and to the left by the log (m/s).
    pub(super) fn velocity(&self) -> Vector {
        self.velocity
    }

    /// Moves on by the log, along the heading that the compass reads.
    pub(super) fn advance(&mut self, odometry: Pose, heading: f64, seconds: f64) {
        self.heading = heading;
        let Some(before) = self.odometry.replace(odometry) else { return };
        let way = before.to_local(odometry.position()).coords;
        self.velocity = way / seconds;
        let ahead = direction(self.pose().heading);
        let moved = Vector::new(ahead.x * way.x - ahead.y * way.y, ahead.y * way.x + ahead.x * way.y);
        (self.state.x, self.state.y) = (self.state.x + moved.x, self.state.y + moved.y);
        // What the compass reads too much turns the way back.
        let mut turn = Matrix3::identity();
        (turn[(0, 2)], turn[(1, 2)]) = (moved.y, -moved.x);
        let step = SCALE * SCALE * way.norm_squared() + WALK * WALK * seconds;
        let noise = Matrix3::from_diagonal(&Vector3::new(step, step, DRIFT * DRIFT * seconds));
        self.covariance = turn * self.covariance * turn.transpose() + noise;
    }

    /// Takes in a distance read by a sensor at a pose on the craft.
    pub(super) fn see(&mut self, sensor: &Pose, range: f64) {
        let Some(sides) = self.sides else { return };
        let expected = |state: &Vector3<f64>| {
            let pose = Pose::new(state.x, state.y, self.heading - state.z).compose(sensor);
            to_side(&sides, pose.position(), pose.heading)
        };
        let Some(there) = expected(&self.state) else { return };
        let slope = |axis: usize| {
            let mut moved = self.state;
            moved[axis] += DELTA;
            expected(&moved).map_or(0.0, |moved| (moved - there) / DELTA)
        };
        let slopes = RowVector3::new(slope(0), slope(1), slope(2));
        let spread = (slopes * self.covariance * slopes.transpose())[0] + RANGE * RANGE;
        let off = range - there;
        if off * off > GATE * GATE * spread {
            return;
        }
        let gain = self.covariance * slopes.transpose() / spread;
        self.state += gain * off;
        self.covariance = (Matrix3::identity() - gain * slopes) * self.covariance;
    }
}

/// The step by which slopes are measured (m, rad).
const DELTA: f64 = 1e-4;

/// Metres from a place inside a rectangle to its side in a direction; `None` from outside.
fn to_side(sides: &Aabb, from: Point, heading: f64) -> Option<f64> {
    let (sin, cos) = math::sin_cos(heading);
    let until = |from: f64, way: f64, low: f64, high: f64| {
        if way > 0.0 {
            (high - from) / way
        } else if way < 0.0 {
            (low - from) / way
        } else {
            f64::INFINITY
        }
    };
    let across = until(from.x, cos, sides.min.x, sides.max.x);
    let along = until(from.y, sin, sides.min.y, sides.max.y);
    sides.contains(from).then(|| across.min(along))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_sides_correct_the_place_and_the_covariance_says_how_well() {
        let sides = Aabb::new(Point::origin(), Point::new(8.0, 6.0));
        let mut fix = Fix::new(Pose::new(3.1, 2.05, 0.0), Some(sides));
        let before = fix.sigma();
        for _ in 0..20 {
            fix.see(&Pose::new(0.5, 0.0, 0.0), 4.5);
            fix.see(&Pose::new(0.0, 0.3, std::f64::consts::FRAC_PI_2), 3.7);
        }
        let pose = fix.pose();
        assert!((pose.x - 3.0).abs() < 0.01 && (pose.y - 2.0).abs() < 0.01, "{pose:?}");
        assert!(fix.sigma() < 0.2 * before);
        // Something in the way is not taken for a side.
        fix.see(&Pose::new(0.5, 0.0, 0.0), 1.0);
        assert_eq!(fix.pose(), pose);
    }

    #[test]
    fn without_sides_the_uncertainty_grows() {
        let mut fix = Fix::new(Pose::default(), None);
        for step in 0..100 {
            fix.advance(Pose::new(0.05 * f64::from(step), 0.0, 0.0), 0.0, 0.1);
        }
        assert!((fix.pose().x - 4.95).abs() < 1e-9 && fix.sigma() > 0.06, "{}", fix.sigma());
    }
}
