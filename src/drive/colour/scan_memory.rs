use std::collections::BTreeMap;

use super::steering::Exempt;
use crate::geometry::{Point, Pose};
use crate::io::LidarScan;

/// What the lidar has met of late, also where something hides it now: whoever pushes a thing sees little of what is behind
/// it.
#[derive(Debug, Clone, Default)]
pub(super) struct ScanMemory {
    /// One point a cell, in odometry's frame, and when it was seen last.
    cells: BTreeMap<(i32, i32), (Point, f64)>,
}

/// Metres across a cell.
const CELL: f64 = 0.03;
/// Seconds for which a point is kept.
const MEMORY: f64 = 60.0;

impl ScanMemory {
    /// Takes in a scan, without what is exempt in odometry's frame, and forgets what is old or belongs to that.
    pub(super) fn see(&mut self, scan: &LidarScan, pose: Pose, time: f64, exempt: Exempt) {
        for point in scan.points().map(|point| pose.to_world(point)) {
            let cell = [point.x, point.y].map(|along| (along / CELL).floor() as i32);
            self.cells.insert(cell.into(), (point, time));
        }
        self.cells.retain(|_, (point, seen)| time - *seen < MEMORY && !exempt.contains(point));
    }

    /// All that is remembered, from a place, along odometry's axes.
    pub(super) fn from(&self, place: Point, points: &mut Vec<Point>) {
        points.clear();
        points.extend(self.cells.values().map(|(point, _)| point - place.coords));
    }
}
