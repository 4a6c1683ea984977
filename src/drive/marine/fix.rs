use nalgebra::{Matrix4, RowVector4, Vector4};

use super::reckoning::{halfway, way};
use crate::geometry::{Aabb, Point, Pose, Vector, math};

/// The position in a pool with four sides, and how sure it is: an extended Kalman filter of the place and of the
/// errors of compass and log, moved by the log and corrected by distances to the sides (Thrun et al.,
/// *Probabilistic Robotics*, 2005, section 3.3).
#[derive(Debug, Clone)]
pub(super) struct Fix {
    /// Place (m), what the compass reads too much (rad), and the share by which the log does.
    state: Vector4<f64>,
    covariance: Matrix4<f64>,
    /// The sides of the pool; without them, there is only the log.
    sides: Option<Aabb>,
    odometry: Option<Pose>,
    heading: f64,
    velocity: Vector,
}

/// Standard deviation of the position at the start (m).
const START: f64 = 0.05;
/// Standard deviation of the compass's error at the start (rad).
const COMPASS: f64 = 0.01;
/// Drift of the compass's error (rad/√s): half a degree in a minute.
const DRIFT: f64 = 0.0011;
/// Standard deviation of the log's scale error, relative to the distance.
const SCALE: f64 = 0.005;
/// Walk of the position by the log (m/√s).
const WALK: f64 = 0.004;
/// Standard deviation of a measured distance (m).
const RANGE: f64 = 0.1;
/// The most standard deviations that a distance may be off: what is nearer is no side.
const GATE: f64 = 4.0;

impl Fix {
    pub(super) fn new(start: Pose, sides: Option<Aabb>) -> Self {
        let deviations = Vector4::new(START, START, COMPASS, SCALE);
        Self {
            state: Vector4::new(start.x, start.y, 0.0, 0.0),
            covariance: Matrix4::from_diagonal(&deviations.component_mul(&deviations)),
            sides,
            odometry: None,
            heading: start.heading,
            velocity: Vector::zeros(),
        }
    }

    pub(super) fn pose(&self) -> Pose {
        Pose::new(self.state.x, self.state.y, self.heading - self.state.z)
    }

    /// The standard deviations of the place along x and y (m).
    pub(super) fn sigma(&self) -> Vector {
        Vector::new(self.covariance[(0, 0)].sqrt(), self.covariance[(1, 1)].sqrt())
    }

    /// The sides that tell the place.
    pub(super) fn sides(&self) -> Option<Aabb> {
        self.sides
    }

    /// The speed forward and to the left by the log (m/s).
    pub(super) fn velocity(&self) -> Vector {
        self.velocity
    }

    /// Moves on by the log, along the heading that the compass reads.
    pub(super) fn advance(&mut self, odometry: Pose, heading: f64, seconds: f64) {
        let middle = halfway(self.heading, heading);
        self.heading = heading;
        let Some(before) = self.odometry.replace(odometry) else { return };
        let log = way(&before, &odometry);
        self.velocity = log / seconds;
        let (sin, cos) = math::sin_cos(middle - self.state.z);
        let read = Vector::new(cos * log.x - sin * log.y, sin * log.x + cos * log.y);
        let moved = read * (1.0 - self.state.w);
        (self.state.x, self.state.y) = (self.state.x + moved.x, self.state.y + moved.y);
        // What the compass reads too much turns the way back, and what the log does shortens it.
        let mut turn = Matrix4::identity();
        (turn[(0, 2)], turn[(1, 2)]) = (moved.y, -moved.x);
        (turn[(0, 3)], turn[(1, 3)]) = (-read.x, -read.y);
        let step = WALK * WALK * seconds;
        let noise = Matrix4::from_diagonal(&Vector4::new(step, step, DRIFT * DRIFT * seconds, 0.0));
        self.covariance = turn * self.covariance * turn.transpose() + noise;
    }

    /// Takes in a distance read by a sensor at a pose on the craft.
    pub(super) fn see(&mut self, sensor: &Pose, range: f64) {
        let Some(sides) = self.sides else { return };
        let expected = |state: &Vector4<f64>| {
            let pose = Pose::new(state.x, state.y, self.heading - state.z).compose(sensor);
            to_side(&sides, pose.position(), pose.heading)
        };
        let Some(there) = expected(&self.state) else { return };
        let slope = |axis: usize| {
            let mut moved = self.state;
            moved[axis] += DELTA;
            expected(&moved).map_or(0.0, |moved| (moved - there) / DELTA)
        };
        let slopes = RowVector4::new(slope(0), slope(1), slope(2), 0.0);
        let spread = (slopes * self.covariance * slopes.transpose())[0] + RANGE * RANGE;
        let off = range - there;
        if off * off > GATE * GATE * spread {
            return;
        }
        let gain = self.covariance * slopes.transpose() / spread;
        self.state += gain * off;
        self.covariance = (Matrix4::identity() - gain * slopes) * self.covariance;
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
    use crate::random::Stream;

    #[test]
    fn two_sides_correct_the_place_and_the_covariance_says_how_well() {
        let sides = Aabb::new(Point::origin(), Point::new(8.0, 6.0));
        let mut fix = Fix::new(Pose::new(3.1, 2.05, 0.0), Some(sides));
        let before = fix.sigma();
        for _ in 0..200 {
            fix.see(&Pose::new(0.5, 0.0, 0.0), 4.5);
            fix.see(&Pose::new(0.0, 0.3, std::f64::consts::FRAC_PI_2), 3.7);
        }
        let pose = fix.pose();
        assert!((pose.x - 3.0).abs() < 0.01 && (pose.y - 2.0).abs() < 0.01, "{pose:?}");
        assert!(fix.sigma().norm() < 0.2 * before.norm());
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
        assert!((fix.pose().x - 4.95).abs() < 1e-9 && fix.sigma().x > 0.055, "{}", fix.sigma());
    }

    /// The mean of the squared errors of the place in terms of the covariance (NEES), after lanes in a pool
    /// whose far sides are out of range, of many craft with errors of their own: 2 of a filter that knows its
    /// errors.
    #[test]
    fn the_covariance_is_that_of_the_errors() {
        let sides = Aabb::new(Point::origin(), Point::new(14.0, 30.0));
        let (mut sum, mut count) = (0.0, 0.0);
        for seed in 0..40 {
            let mut stream = Stream::new(seed);
            let mut off = |sigma: f64| sigma * stream.normal();
            let start = Pose::new(3.0, 2.0, std::f64::consts::FRAC_PI_2);
            let mut fix =
                Fix::new(Pose::new(start.x + off(START), start.y + off(START), start.heading), Some(sides));
            let (mut compass, scale) = (off(COMPASS), 1.0 + off(SCALE));
            let (mut truth, mut log) = (start, Pose::default());
            for step in 0..2400_u32 {
                // Along a lane and back again, turning on the spot.
                let turn = if step % 800 < 740 { 0.0 } else { std::f64::consts::PI / 60.0 };
                let ahead = if turn == 0.0 { 0.035 } else { 0.0 };
                truth = truth.compose(&Pose::new(ahead, 0.0, turn));
                compass += off(DRIFT * 0.1_f64.sqrt());
                let walk = WALK * 0.1_f64.sqrt();
                log = log.compose(&Pose::new(ahead * scale + off(walk), off(walk), turn));
                fix.advance(log, truth.heading + compass, 0.1);
                for bearing in [0.0, 1.0, 2.0, 3.0].map(|quarter| quarter * std::f64::consts::FRAC_PI_2) {
                    let range = to_side(&sides, truth.position(), truth.heading + bearing);
                    if let Some(range) = range.filter(|range| *range < 10.0) {
                        fix.see(&Pose::new(0.0, 0.0, bearing), range + off(RANGE));
                    }
                }
                if step % 100 == 99 {
                    let error = fix.pose().position() - truth.position();
                    let own = fix.covariance.fixed_view::<2, 2>(0, 0).try_inverse().unwrap();
                    sum += error.dot(&(own * error));
                    count += 1.0;
                }
            }
        }
        let nees = sum / count;
        assert!((1.4..2.8).contains(&nees), "{nees}");
    }
}
