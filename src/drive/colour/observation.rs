use image::RgbImage;

use crate::geometry::Pose;
use crate::io::LidarScan;

/// What a colour-driven behaviour is told at each step.
#[derive(Debug, Clone, Copy)]
pub struct ColourObservation<'a> {
    /// Seconds since the start.
    pub time: f64,
    /// What the camera sees, straight ahead and level.
    pub image: &'a RgbImage,
    /// What the lidar sees at the same time.
    pub scan: &'a LidarScan,
    /// Where odometry takes the robot to be.
    pub pose: Pose,
}
