//! Keeping the lane by what a camera sees (book, section 13.3).
//!
//! [`LaneKeeper`] steers by the road that [`LaneFinder`](crate::vision::lane_markings::LaneFinder) fits to the markings: ahead
//! by the lane's curvature, back by offset and heading, and as fast as grip, bends and sight allow. [`BookLaneKeeper`] is the
//! book's pipeline as printed: edges by Canny, lines by Hough, and a proportional controller.

mod book;
mod keeper;

pub use book::{BookLaneKeeper, BookLaneParameters};
pub use keeper::{LaneKeeper, LaneKeeperParameters};

use image::RgbImage;

use crate::geometry::Pose;
use crate::io::control::halts;
use crate::io::{Camera, Odometry, Result};
use crate::vision::lane_markings::RoadCamera;
use crate::world::CameraSpec;

/// What a lane keeper is told at each step.
#[derive(Debug, Clone, Default)]
pub struct LaneObservation {
    /// What the camera sees.
    pub image: RgbImage,
    /// Where odometry takes the robot to be.
    pub odometry: Pose,
    /// Metres per second, by odometry.
    pub speed: f64,
}

impl LaneObservation {
    fn read<R: Camera + Odometry + ?Sized>(&mut self, robot: &mut R) -> Result<()> {
        robot.image_into(&mut self.image)?;
        (self.odometry, self.speed) = (robot.pose()?, robot.speed()?.linear);
        Ok(())
    }
}

/// How keeping a lane ended: it has no end of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LaneOutcome {
    /// The time was over.
    TimedOut,
    /// Who watches has seen enough.
    Stopped,
}

halts!(LaneOutcome {});

impl From<&CameraSpec> for RoadCamera {
    fn from(spec: &CameraSpec) -> Self {
        Self {
            field_of_view: spec.field_of_view,
            fisheye: spec.fisheye,
            tilt: spec.tilt,
            height: spec.mount.z,
            ahead: spec.mount.x,
        }
    }
}
