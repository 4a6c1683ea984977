use image::RgbImage;

use crate::geometry::Pose;
use crate::io::{Camera, Lidar, LidarScan, Odometry, Result, StallDetector};

/// What a colour-driven behaviour is told at each step.
#[derive(Debug, Clone, Default)]
pub struct ColourObservation {
    /// What the camera sees, straight ahead and level.
    pub image: RgbImage,
    /// What the lidar sees at the same time.
    pub scan: LidarScan,
    /// Where odometry takes the robot to be.
    pub pose: Pose,
    /// Whether something holds it.
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

    pub(super) fn at(&self, time: f64) -> Sight<'_> {
        Sight { time, image: &self.image, scan: &self.scan, pose: self.pose }
    }
}

/// An observation at a time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight<'a> {
    pub(super) time: f64,
    pub(super) image: &'a RgbImage,
    pub(super) scan: &'a LidarScan,
    /// Where the robot is taken to be.
    pub(super) pose: Pose,
}
