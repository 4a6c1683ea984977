use std::f64::consts::{PI, TAU};

use super::{Point, Vector, direction, math, units};

/// Position and heading in the plane.
///
/// As a transformation it maps points of its own frame (x forward, y left) to its parent frame:
///
/// ```
/// use roverlab::geometry::{Point, Pose};
/// let robot = Pose::new(1.0, 2.0, std::f64::consts::FRAC_PI_2);
/// let ahead = robot.to_world(Point::new(0.5, 0.0));
/// assert!((ahead - Point::new(1.0, 2.5)).norm() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// x coordinate (m).
    pub x: f64,
    /// y coordinate (m).
    pub y: f64,
    /// Angle from the x axis, counter-clockwise (rad).
    pub heading: f64,
}

impl Pose {
    /// A pose from metres and radians.
    pub const fn new(x: f64, y: f64, heading: f64) -> Self {
        Self { x, y, heading }
    }

    /// A pose from millimetres and degrees.
    pub fn from_mm_deg(x: f64, y: f64, heading: f64) -> Self {
        Self::new(units::from_mm(x), units::from_mm(y), units::from_deg(heading))
    }

    /// Position.
    #[inline]
    pub fn position(&self) -> Point {
        Point::new(self.x, self.y)
    }

    /// Unit vector along the heading.
    #[inline]
    pub fn forward(&self) -> Vector {
        direction(self.heading)
    }

    /// Transforms a point from the pose's own frame to the parent frame.
    pub fn to_world(&self, local: Point) -> Point {
        let (sin, cos) = math::sin_cos(self.heading);
        Point::new(self.x + cos * local.x - sin * local.y, self.y + sin * local.x + cos * local.y)
    }

    /// Transforms a point from the parent frame to the pose's own frame.
    pub fn to_local(&self, world: Point) -> Point {
        let (sin, cos) = math::sin_cos(self.heading);
        let (dx, dy) = (world.x - self.x, world.y - self.y);
        Point::new(cos * dx + sin * dy, cos * dy - sin * dx)
    }

    /// Transforms the pose `other` from this pose's own frame to the parent frame.
    #[must_use]
    pub fn compose(&self, other: &Pose) -> Pose {
        let position = self.to_world(other.position());
        Pose::new(position.x, position.y, normalize_angle(self.heading + other.heading))
    }

    /// Inverse transformation: `p.compose(&p.inverse())` is the origin.
    #[must_use]
    pub fn inverse(&self) -> Pose {
        let origin = self.to_local(Point::origin());
        Pose::new(origin.x, origin.y, normalize_angle(-self.heading))
    }

    /// Bearing of a point relative to the heading, in `-pi..=pi` (rad).
    pub fn bearing_to(&self, point: Point) -> f64 {
        normalize_angle(math::atan2(point.y - self.y, point.x - self.x) - self.heading)
    }

    /// Distance to a point (m).
    pub fn distance_to(&self, point: Point) -> f64 {
        (point - self.position()).norm()
    }

    /// Whether all components are finite.
    pub fn is_finite(&self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.heading.is_finite()
    }
}

/// Velocity in the plane: the v-omega of RoBIOS and the planar part of a ROS `Twist`.
///
/// ```
/// use roverlab::geometry::Twist;
/// let circle = Twist::new(0.2, 0.5);
/// assert_eq!(circle.linear / circle.angular, 0.4, "the radius in metres");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twist {
    /// Forward speed (m/s).
    pub linear: f64,
    /// Angular velocity, counter-clockwise (rad/s).
    pub angular: f64,
}

impl Twist {
    /// Zero velocity.
    pub const STOP: Twist = Twist { linear: 0.0, angular: 0.0 };

    /// A twist from m/s and rad/s.
    pub const fn new(linear: f64, angular: f64) -> Self {
        Self { linear, angular }
    }

    /// Whether both components are finite.
    pub fn is_finite(&self) -> bool {
        self.linear.is_finite() && self.angular.is_finite()
    }
}

/// The equivalent angle in `-pi..=pi`.
///
/// ```
/// use roverlab::geometry::normalize_angle;
/// use std::f64::consts::PI;
/// assert!((normalize_angle(2.5 * PI) - 0.5 * PI).abs() < 1e-12);
/// ```
#[inline]
pub fn normalize_angle(angle: f64) -> f64 {
    if (-PI..=PI).contains(&angle) {
        return angle;
    }
    angle - TAU * (angle / TAU).round()
}

/// Angle from direction `from` to direction `to`, in `-pi..=pi`.
///
/// ```
/// use roverlab::geometry::angle_difference;
/// let turn = angle_difference(170_f64.to_radians(), (-170_f64).to_radians());
/// assert!((turn + 20_f64.to_radians()).abs() < 1e-12, "20 degrees to the right, past 180");
/// ```
#[inline]
pub fn angle_difference(to: f64, from: f64) -> f64 {
    normalize_angle(to - from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pose() -> impl Strategy<Value = Pose> {
        (-10.0..10.0, -10.0..10.0, -PI..PI).prop_map(|(x, y, heading)| Pose::new(x, y, heading))
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn composing_with_the_inverse_is_the_identity(p in pose()) {
            let id = p.compose(&p.inverse());
            prop_assert!(id.position().coords.norm() < 1e-12 && id.heading.abs() < 1e-12);
        }

        #[test]
        fn world_and_local_undo_each_other(p in pose(), x in -5.0..5.0, y in -5.0..5.0) {
            let point = Point::new(x, y);
            prop_assert!((p.to_local(p.to_world(point)) - point).norm() < 1e-12);
        }

        #[test]
        fn normalised_angles_point_the_same_way(angle in -100.0..100.0f64) {
            let n = normalize_angle(angle);
            prop_assert!((-PI..=PI).contains(&n));
            prop_assert!((direction(n) - direction(angle)).norm() < 1e-9);
        }
    }
}
