//! Driving among things that the lidar sees.

use std::f64::consts::PI;

use crate::geometry::{Point, Twist, direction, free_distance, normalize_angle};
use crate::io::LidarScan;

/// How a round robot drives in a direction without touching anything.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Steering {
    /// Metres from the robot's middle to its rim, and what it keeps free beside it.
    pub(super) radius: f64,
    pub(super) margin: f64,
    /// Metres and radians per second.
    pub(super) speed: f64,
    pub(super) turn_speed: f64,
}

/// What may be touched: all within some metres of a place.
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
    /// How far the robot can drive straight on in a direction, at most `reach` metres.
    pub(super) fn free(&self, points: &[Point], angle: f64, reach: f64) -> f64 {
        let (free, _) = free_distance(points, direction(angle), self.radius + self.margin);
        free.clamp(0.0, reach)
    }

    /// The direction nearest to a wished one in which the robot can drive so far; `None` if it cannot anywhere.
    pub(super) fn way(&self, points: &[Point], wished: f64, reach: f64) -> Option<f64> {
        directions(wished).find(|&angle| self.free(points, angle, reach) >= reach)
    }

    /// The speed towards a direction: turning on the spot where it is far aside.
    pub(super) fn towards(&self, angle: f64, fastest: f64) -> Twist {
        let angular = (3.0 * angle).clamp(-self.turn_speed, self.turn_speed);
        let share = (1.0 - angle.abs() / 0.5).max(0.0);
        Twist::new(fastest.min(self.speed) * share, angular)
    }
}

/// All directions in steps of 5 degrees, the nearest to a wished one first.
pub(super) fn directions(wished: f64) -> impl Iterator<Item = f64> {
    let turns = (0..=36).map(|i| f64::from(i) * (PI / 36.0));
    turns.flat_map(move |turn| [wished + turn, wished - turn]).map(normalize_angle)
}

/// What a scan shows, in the robot's frame, without what is exempt.
pub(super) fn obstacles(scan: &LidarScan, exempt: Option<Exempt>, points: &mut Vec<Point>) {
    points.clear();
    let belongs = |point: &Point| exempt.is_some_and(|exempt| exempt.contains(point));
    points.extend(scan.points().filter(|point| !belongs(point)));
}

/// The nearest point of a scan within some radians of a direction.
pub(super) fn nearest(scan: &LidarScan, bearing: f64, half: f64) -> Option<Point> {
    let ahead = direction(bearing);
    let within = |point: &Point| {
        let length = point.coords.norm();
        length > 0.0 && ahead.dot(&point.coords) >= length * crate::geometry::math::cos(half)
    };
    scan.points().filter(within).min_by(|a, b| a.coords.norm().total_cmp(&b.coords.norm()))
}
