use std::f64::consts::TAU;

use super::Result;
use crate::ParameterError;
use crate::geometry::{Point, Pose, direction};
use crate::parameter::require;

/// One turn of a laser scanner, laid out as ROS's `LaserScan`: counter-clockwise, in the robot's frame, no return is
/// +infinity (REP 117).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LidarScan {
    /// The direction of the first beam, in radians counter-clockwise from straight ahead.
    pub angle_min: f64,
    /// Radians from one beam to the next.
    pub angle_increment: f64,
    /// The farthest distance that the scanner reports, in metres.
    pub range_max: f64,
    /// Where the scanner sits in the robot's frame; the heading is that of its straight-ahead beam.
    pub mount: Pose,
    /// Metres from the scanner to what each beam hits.
    pub ranges: Vec<f64>,
}

impl LidarScan {
    /// The direction of a beam relative to the scanner's mount, in radians.
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

    /// The points that the beams hit, in the robot's frame; beams without a finite range are left out.
    pub fn points(&self) -> impl Iterator<Item = Point> + '_ {
        self.ranges.iter().enumerate().filter(|(_, range)| range.is_finite()).map(|(i, &range)| {
            let angle = self.mount.heading + self.angle(i);
            self.mount.position() + direction(angle) * range
        })
    }
}

/// How a scan is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LidarSettings {
    /// The angle that a scan covers, centred on straight ahead, in radians: more than 0, at most a full turn.
    pub field_of_view: f64,
    /// Radians by which the beams point above the horizontal.
    pub tilt: f64,
    /// Beams in a scan.
    pub points: usize,
}

impl LidarSettings {
    /// The largest number of beams that a scan may have.
    pub const MAX_POINTS: usize = 100_000;

    /// The direction of the first beam and the angle between beams. A full turn leaves out the last beam, which
    /// would repeat the first; a smaller field of view has a beam on either edge.
    pub fn beams(&self) -> (f64, f64) {
        let full_turn = self.field_of_view > TAU - 1e-9;
        let gaps = if full_turn { self.points } else { self.points.saturating_sub(1).max(1) };
        let first = if self.points == 1 && !full_turn { 0.0 } else { -0.5 * self.field_of_view };
        (first, self.field_of_view / gaps as f64)
    }

    /// Fails with the name of the setting that is out of range.
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
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Lidar {
    /// Takes a scan into an existing one, whose memory is used again.
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()>;

    /// Takes a scan.
    fn scan(&mut self) -> Result<LidarScan> {
        let mut scan = LidarScan::default();
        self.scan_into(&mut scan)?;
        Ok(scan)
    }

    /// Changes how scans are taken from now on.
    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()>;
}
