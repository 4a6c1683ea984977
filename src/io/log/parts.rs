use image::RgbImage;

use super::values::{Put, Take, Taking, Values};
use crate::geometry::Pose;
use crate::io::LidarScan;

/// A scan without its ranges, which are stored on the lidar's topic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ScanHead {
    angle_min: f64,
    angle_increment: f64,
    range_max: f64,
    mount: Pose,
}

impl ScanHead {
    pub(super) fn of(scan: &LidarScan) -> Self {
        let &LidarScan { angle_min, angle_increment, range_max, mount, .. } = scan;
        Self { angle_min, angle_increment, range_max, mount }
    }

    /// Fills a scan from head and ranges; reuses its memory.
    pub(super) fn fill(self, scan: &mut LidarScan, ranges: impl Iterator<Item = f64>) {
        let Self { angle_min, angle_increment, range_max, mount } = self;
        (scan.angle_min, scan.angle_increment, scan.range_max) = (angle_min, angle_increment, range_max);
        scan.mount = mount;
        scan.ranges.clear();
        scan.ranges.extend(ranges);
    }
}

impl Put for ScanHead {
    fn put(&self, out: &mut Values) {
        out.numbers.extend([self.angle_min, self.angle_increment, self.range_max]);
        self.mount.put(out);
    }
}

impl Take for ScanHead {
    fn take(from: &mut Taking<'_>) -> Option<Self> {
        Some(Self {
            angle_min: f64::take(from)?,
            angle_increment: f64::take(from)?,
            range_max: f64::take(from)?,
            mount: Pose::take(from)?,
        })
    }
}

/// An image without its pixels, which are stored on the camera's topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Size(pub(super) u32, pub(super) u32);

impl Size {
    pub(super) fn of(image: &RgbImage) -> Self {
        Self(image.width(), image.height())
    }
}

impl Put for Size {
    fn put(&self, out: &mut Values) {
        self.0.put(out);
        self.1.put(out);
    }
}

impl Take for Size {
    fn take(from: &mut Taking<'_>) -> Option<Self> {
        Some(Self(u32::take(from)?, u32::take(from)?))
    }
}
