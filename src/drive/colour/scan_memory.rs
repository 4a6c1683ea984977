use std::collections::BTreeMap;

use super::steering::Exempt;
use crate::geometry::{Point, Pose};
use crate::io::LidarScan;

/// Recent lidar points, including those hidden now: a pushed object hides most of what is behind it.
#[derive(Debug, Clone, Default)]
pub(super) struct ScanMemory {
    /// One point per cell in the odometry frame, with the time it was last seen (s).
    cells: BTreeMap<(i32, i32), (Point, f64)>,
}

/// Cell size (m).
const CELL: f64 = 0.03;
/// Time for which a point is kept (s).
const MEMORY: f64 = 60.0;

impl ScanMemory {
    /// Adds a scan without the exempt points, and forgets old and exempt ones.
    pub(super) fn see(&mut self, scan: &LidarScan, pose: Pose, time: f64, exempt: Exempt) {
        for point in scan.points().map(|point| pose.to_world(point)) {
            let cell = [point.x, point.y].map(|along| (along / CELL).floor() as i32);
            self.cells.insert(cell.into(), (point, time));
        }
        self.cells.retain(|_, (point, seen)| time - *seen < MEMORY && !exempt.contains(point));
    }

    /// All remembered points relative to a place, along the odometry axes.
    pub(super) fn from(&self, place: Point, points: &mut Vec<Point>) {
        points.clear();
        points.extend(self.cells.values().map(|(point, _)| point - place.coords));
    }
}
