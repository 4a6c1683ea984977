use std::f64::consts::TAU;

use super::Result;
use crate::ParameterError;
use crate::geometry::{Point, Pose, direction};
use crate::parameter::require;

/// One turn of a laser scanner, laid out like ROS's `LaserScan`: counter-clockwise, in the robot's frame,
/// with +infinity for no return (REP 117).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LidarScan {
    /// Direction of the first beam (rad), counter-clockwise from straight ahead.
    pub angle_min: f64,
    /// Angle between neighbouring beams (rad).
    pub angle_increment: f64,
    /// Maximum range of the scanner (m).
    pub range_max: f64,
    /// Mounting pose in the robot's frame; the heading is that of the straight-ahead beam.
    pub mount: Pose,
    /// Range of each beam (m).
    pub ranges: Vec<f64>,
}

impl LidarScan {
    /// Direction of a beam relative to the scanner's mount (rad).
    #[inline]
    pub fn angle(&self, index: usize) -> f64 {
        self.angle_min + self.angle_increment * index as f64
    }

    /// The beam nearest to a direction relative to the scanner's mount; `None` outside the scan.
    pub fn beam_at(&self, angle: f64) -> Option<usize> {
        if self.ranges.is_empty() || self.angle_increment == 0.0 {
            return None;
        }
        let offset = crate::geometry::normalize_angle(angle - self.angle_min);
        let offset = if offset < -0.5 * self.angle_increment { offset + TAU } else { offset };
        let index = (offset / self.angle_increment).round() as usize;
        let beams = self.ranges.len();
        let covers_a_full_turn = (self.angle_increment * beams as f64 - TAU).abs() < 1e-6;
        if index < beams {
            Some(index)
        } else if covers_a_full_turn {
            Some(index % beams)
        } else {
            None
        }
    }

    /// The points hit by the beams, in the robot's frame; beams without a finite range are omitted.
    pub fn points(&self) -> impl Iterator<Item = Point> + '_ {
        self.ranges.iter().enumerate().filter(|(_, range)| range.is_finite()).map(|(i, &range)| {
            let angle = self.mount.heading + self.angle(i);
            self.mount.position() + direction(angle) * range
        })
    }
}

/// Settings of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LidarSettings {
    /// Field of view, centred on straight ahead (rad): more than 0, at most a full turn.
    pub field_of_view: f64,
    /// Elevation of the beams above the horizontal (rad).
    pub tilt: f64,
    /// Number of beams per scan.
    pub points: usize,
}

impl LidarSettings {
    /// Maximum number of beams per scan.
    pub const MAX_POINTS: usize = 100_000;

    /// Direction of the first beam, and angle between beams. A full turn omits the last beam, which would
    /// repeat the first; a smaller field of view has a beam on either edge.
    pub fn beams(&self) -> (f64, f64) {
        let full_turn = self.field_of_view > TAU - 1e-9;
        let gaps = if full_turn { self.points } else { self.points.saturating_sub(1).max(1) };
        let first = if self.points == 1 && !full_turn { 0.0 } else { -0.5 * self.field_of_view };
        (first, self.field_of_view / gaps as f64)
    }

    /// Checks every setting; the error names the one out of range.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        let fov = self.field_of_view;
        let good = fov > 0.0 && fov <= TAU * (1.0 + 1e-9);
        require("lidar field of view", fov, good, "more than 0 and at most a full turn")?;
        let good = self.tilt.abs() <= TAU / 4.0;
        require("lidar tilt", self.tilt, good, "at most a quarter turn up or down")?;
        let good = (1..=Self::MAX_POINTS).contains(&self.points);
        require("lidar points", self.points as f64, good, "1 to 100000")
    }
}

/// A laser scanner.
///
/// # For implementers
///
/// Replace the scan's whole content and keep its memory. Beams without a return are infinity.
/// `configure_lidar` fails for settings out of range ([`LidarSettings::validate`]) and for those that
/// the lidar lacks.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Lidar {
    /// Takes a scan into an existing one; its memory is reused.
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()>;

    /// Takes a scan.
    fn scan(&mut self) -> Result<LidarScan> {
        let mut scan = LidarScan::default();
        self.scan_into(&mut scan)?;
        Ok(scan)
    }

    /// Changes the settings of later scans.
    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()>;
}
