use image::RgbImage;

use crate::geometry::Pose;
use crate::io::reading::{check_image, check_pose, check_scan};
use crate::io::{Camera, Lidar, LidarScan, Odometry, Result, StallDetector};

/// Observation of the colour-driven behaviours.
#[derive(Debug, Clone, Default)]
pub struct ColourObservation {
    /// Camera image; the camera points straight ahead and level.
    pub image: RgbImage,
    /// Lidar scan of the same moment.
    pub scan: LidarScan,
    /// Pose by odometry.
    pub pose: Pose,
    /// Whether the drive has stalled.
    pub stalled: bool,
}

impl ColourObservation {
    pub(super) fn read<R: Camera + Odometry + StallDetector + Lidar + ?Sized>(
        &mut self,
        robot: &mut R,
        looks: bool,
    ) -> Result<()> {
        if looks {
            robot.image_into(&mut self.image)?;
        }
        robot.scan_into(&mut self.scan)?;
        (self.pose, self.stalled) = (robot.pose()?, robot.is_stalled()?);
        Ok(())
    }

    pub(super) fn check(&self) -> Result<()> {
        check_pose(&self.pose)?;
        check_scan(&self.scan)?;
        // Behaviours that do not need the camera at the moment leave the image as it is.
        if self.image.is_empty() { Ok(()) } else { check_image(&self.image) }
    }

    pub(super) fn at(&self, time: f64) -> Sight<'_> {
        Sight { time, image: &self.image, scan: &self.scan, pose: self.pose }
    }
}

/// An observation with its time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight<'a> {
    pub(super) time: f64,
    pub(super) image: &'a RgbImage,
    pub(super) scan: &'a LidarScan,
    /// Estimated pose of the robot.
    pub(super) pose: Pose,
}
