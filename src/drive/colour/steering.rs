//! Driving among the points of a lidar scan.

use std::f64::consts::PI;

use crate::geometry::{Point, Twist, direction, free_distance, normalize_angle};
use crate::io::LidarScan;

/// Collision-free driving of a round robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Steering {
    /// Radius of the robot, and clearance kept beside it (m).
    pub(super) radius: f64,
    pub(super) margin: f64,
    /// Maximum speed (m/s) and turn rate (rad/s).
    pub(super) speed: f64,
    pub(super) turn_speed: f64,
}

/// Points that may be touched: those within a distance of a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Exempt {
    pub(super) place: Point,
    pub(super) reach: f64,
}

impl Exempt {
    pub(super) fn contains(&self, point: &Point) -> bool {
        (point - self.place).norm() <= self.reach
    }
}

impl Steering {
    /// Free distance straight on in a direction, at most `reach` (m).
    pub(super) fn free(&self, points: &[Point], angle: f64, reach: f64) -> f64 {
        let (free, _) = free_distance(points, direction(angle), self.radius + self.margin);
        free.max(0.0).min(reach)
    }

    /// The direction nearest to `wished` with `reach` metres free; `None` if there is none.
    pub(super) fn way(&self, points: &[Point], wished: f64, reach: f64) -> Option<f64> {
        directions(wished).find(|&angle| self.free(points, angle, reach) >= reach)
    }

    /// Velocity towards a direction; turns on the spot if it is far aside.
    pub(super) fn towards(&self, angle: f64, fastest: f64) -> Twist {
        let angular = (3.0 * angle).clamp(-self.turn_speed, self.turn_speed);
        let share = (1.0 - angle.abs() / 0.5).max(0.0);
        Twist::new(fastest.min(self.speed) * share, angular)
    }
}

/// All directions in steps of 5 degrees, starting nearest to `wished`.
pub(super) fn directions(wished: f64) -> impl Iterator<Item = f64> {
    let turns = (0..=36).map(|i| f64::from(i) * (PI / 36.0));
    turns.flat_map(move |turn| [wished + turn, wished - turn]).map(normalize_angle)
}

/// The points of a scan in the robot's frame, without the exempt ones.
pub(super) fn obstacles(scan: &LidarScan, exempt: Option<Exempt>, points: &mut Vec<Point>) {
    points.clear();
    let belongs = |point: &Point| exempt.is_some_and(|exempt| exempt.contains(point));
    points.extend(scan.points().filter(|point| !belongs(point)));
}

/// The nearest point of a scan within `half` radians of a direction.
pub(super) fn nearest(scan: &LidarScan, bearing: f64, half: f64) -> Option<Point> {
    let ahead = direction(bearing);
    let within = |point: &Point| {
        let length = point.coords.norm();
        length > 0.0 && ahead.dot(&point.coords) >= length * crate::geometry::math::cos(half)
    };
    scan.points().filter(within).min_by(|a, b| a.coords.norm().total_cmp(&b.coords.norm()))
}
