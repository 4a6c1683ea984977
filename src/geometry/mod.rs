//! Poses, twists, angles and unit conversions, shared by all modules.
//!
//! Conventions follow ROS REP 103: metres and radians, x forward, y left, angles counter-clockwise. The book,
//! EyeSim's files and the command line use millimetres and degrees; only this module converts them.

mod disc;
mod line;
pub mod math;
mod pose;
mod pose3;
mod shapes;
mod side;
pub mod units;

pub use disc::{free_distance, meeting};
pub use line::FittedLine;
pub use pose::{Pose, Twist, angle_difference, normalize_angle};
pub use pose3::Pose3;
pub use shapes::{Aabb, Segment};
pub use side::WallSide;

/// A point in the plane (m).
pub type Point = nalgebra::Point2<f64>;

/// A vector in the plane (m).
pub type Vector = nalgebra::Vector2<f64>;

/// A point in space (m).
pub type Point3 = nalgebra::Point3<f64>;

/// A vector in space (m).
pub type Vector3 = nalgebra::Vector3<f64>;

/// The z component of the cross product, `a.x * b.y - a.y * b.x`: positive if `b` lies counter-clockwise of
/// `a`.
///
/// ```
/// use roverlab::geometry::{Vector, cross};
/// assert_eq!(cross(Vector::new(1.0, 0.0), Vector::new(0.0, 2.0)), 2.0, "the second one points to the left");
/// ```
#[inline]
pub fn cross(a: Vector, b: Vector) -> f64 {
    a.x * b.y - a.y * b.x
}

/// Unit vector in the direction `angle` (rad).
///
/// ```
/// use roverlab::geometry::direction;
/// let north = direction(std::f64::consts::FRAC_PI_2);
/// assert!(north.x.abs() < 1e-12 && north.y == 1.0);
/// ```
#[inline]
pub fn direction(angle: f64) -> Vector {
    let (sin, cos) = math::sin_cos(angle);
    Vector::new(cos, sin)
}

/// Length of a way along straight lines between points; 0 for fewer than two.
pub(crate) fn way_length(points: &[Point]) -> f64 {
    // An empty sum is -0.
    points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, |length, step| length + step)
}
