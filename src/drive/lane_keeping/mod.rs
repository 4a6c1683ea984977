//! Lane keeping by camera (book, section 13.3).
//!
//! [`LaneKeeper`] steers by the road that
//! [`LaneMarkingFinder`](crate::vision::lane_markings::LaneMarkingFinder) fits to the markings: ahead by the
//! lane's curvature, back by offset and heading, and as fast as grip, bends and sight allow.
//! [`BookLaneKeeper`] is the book's pipeline as printed: edges by Canny, lines by Hough, and a proportional
//! controller.
//!
//! ```
//! use roverlab::drive::lane_keeping::{BookLaneKeeper, BookLaneParameters, LaneKeeper, LaneKeeperParameters};
//! use roverlab::drive::traffic::{FreeDrive, FreeDriveRules};
//! use roverlab::io::control::run;
//! use roverlab::io::sim::{SimOptions, Simulation};
//! use roverlab::vision::lane_markings::RoadModel;
//! use roverlab::world::road::{Appearance, RoadCourseOptions, generate};
//! use roverlab::world::{RobotSpec, Scene};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let course = generate(2, &RoadCourseOptions::default())?;
//! let world = course.world(&Appearance { pixel: 0.004, ..Appearance::default() })?;
//! let spec = RobotSpec::road_car();
//! let scene = Scene::with_robot(world, spec.clone(), course.start());
//! let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
//! let (mut car, truth) = (simulation.robot(0)?, simulation.truth());
//! let mut referee = FreeDrive::new(course, &spec, FreeDriveRules::default())?;
//!
//! let camera = spec.camera.as_ref().expect("the car has one").into();
//! let mut keeper = LaneKeeper::new(camera, RoadModel::default(), LaneKeeperParameters::default())?;
//! run(&mut car, &mut keeper, 2.0, |_, _, _| {
//!     referee.see(truth.time(), &truth.pose(0).expect("there is a car"));
//! })?;
//! assert!(referee.score().distance > 2.0 && referee.score().departures == 0);
//!
//! // The book's lane keeper, for another half second.
//! let mut book = BookLaneKeeper::new(BookLaneParameters::default())?;
//! run(&mut car, &mut book, 0.5, |_, _, _| ())?;
//! # Ok(())
//! # }
//! // The book's lane keeper, for another half second.

mod book;
mod keeper;

pub use book::{BookLaneKeeper, BookLaneParameters};
pub(in crate::drive) use keeper::Guide;
pub use keeper::{LaneKeeper, LaneKeeperParameters};

use image::RgbImage;

use crate::geometry::{Pose, Twist};
use crate::io::control::halts;
use crate::io::reading::{check_image, check_pose, check_speed};
use crate::io::{Camera, Odometry, Result};
use crate::vision::lane_markings::RoadCamera;
use crate::world::CameraSpec;

/// Observation of a lane keeper.
#[derive(Debug, Clone, Default)]
pub struct LaneObservation {
    /// Camera image.
    pub image: RgbImage,
    /// Pose by odometry.
    pub odometry: Pose,
    /// Speed by odometry (m/s).
    pub speed: f64,
}

impl LaneObservation {
    pub(in crate::drive) fn read<R: Camera + Odometry + ?Sized>(&mut self, robot: &mut R) -> Result<()> {
        robot.image_into(&mut self.image)?;
        (self.odometry, self.speed) = (robot.pose()?, robot.speed()?.linear);
        Ok(())
    }

    /// Fails for readings that are none.
    pub(in crate::drive) fn check(&self) -> Result<()> {
        check_image(&self.image)?;
        check_pose(&self.odometry)?;
        check_speed(&Twist::new(self.speed, 0.0))
    }
}

/// Outcome of lane keeping, which has no end of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LaneOutcome {
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
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
