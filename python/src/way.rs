//! Robots on the centre line of their scene.

use std::sync::Arc;

use roverlab::geometry::{Point, Pose, angle_difference, math};
use roverlab::world::{Footprint, RobotPlacement};

/// Cross-sections of a closed track or lane: x, y and heading of its centre line, and its widths to the left
/// and
/// right.
pub(crate) type CentreLine = Arc<[[f64; 5]]>;

/// Columns before those of the points ahead.
pub(crate) const COLUMNS: usize = 5;
/// Number of stations to either side among which a robot's own is looked for at a time.
const WINDOW: usize = 6;

/// The robots of a world on its centre line.
#[derive(Debug)]
pub(crate) struct Way {
    line: CentreLine,
    /// Distance between two stations, and of the whole round (m).
    spacing: f64,
    length: f64,
    /// Distances of the points ahead, in stations.
    ahead: Vec<usize>,
    /// The middle of each robot's outline ahead of its origin (m), and its last station.
    robots: Vec<(f64, usize)>,
}

impl Way {
    /// Robots at their start. `None` if the line has no stations.
    pub(crate) fn new(line: &CentreLine, robots: &[RobotPlacement], ahead: &[f64]) -> Option<Self> {
        let next = line.iter().cycle().skip(1);
        let length = line.iter().zip(next).map(|(a, b)| (place(b) - place(a)).norm()).sum::<f64>();
        let spacing = length / line.len() as f64;
        if spacing.is_nan() || spacing <= 0.0 {
            return None;
        }
        let ahead = ahead.iter().map(|metres| (metres / spacing).round() as usize).collect();
        let begin = |robot: &RobotPlacement| {
            let middle = match &robot.spec.footprint {
                Footprint::Rectangle(outline) => 0.5 * (outline.min.x + outline.max.x),
                _ => 0.0,
            };
            let from = robot.pose.to_world(Point::new(middle, 0.0));
            let off = |station: &usize| (place(&line[*station]) - from).norm_squared();
            let nearest = (0..line.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
            (middle, nearest.unwrap_or_default())
        };
        let robots = robots.iter().map(begin).collect();
        Some(Self { line: Arc::clone(line), spacing, length, ahead, robots })
    }

    /// Finds a robot near its last station, and writes distance along the line, length of the line, distance
    /// to
    /// the left, turn from the line's direction, distance from the nearer edge, and the points ahead.
    pub(crate) fn look(&mut self, robot: usize, pose: Pose, row: &mut [f64]) {
        let stations = self.line.len();
        let (middle, at) = &mut self.robots[robot];
        let from = pose.to_world(Point::new(*middle, 0.0));
        let off = |station: usize| (place(&self.line[station]) - from).norm_squared();
        loop {
            let first = *at + stations - WINDOW % stations;
            let near = (first..=first + 2 * WINDOW).map(|station| station % stations);
            let best = near.min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(*at);
            if off(best) >= off(*at) {
                break;
            }
            *at = best;
        }
        let station = &self.line[*at];
        let here = Pose::new(station[0], station[1], station[2]).to_local(from);
        let along = *at as f64 * self.spacing + here.x;
        let edge = (station[3] - here.y).min(station[4] + here.y);
        let turn = angle_difference(pose.heading, station[2]);
        row[..COLUMNS].copy_from_slice(&[along, self.length, here.y, turn, edge]);
        let (sin, cos) = (math::sin(pose.heading), math::cos(pose.heading));
        for (ahead, point) in self.ahead.iter().zip(row[COLUMNS..].chunks_exact_mut(2)) {
            let away = place(&self.line[(*at + ahead) % stations]) - pose.position();
            point.copy_from_slice(&[cos * away.x + sin * away.y, cos * away.y - sin * away.x]);
        }
    }
}

fn place(station: &[f64; 5]) -> Point {
    Point::new(station[0], station[1])
}
