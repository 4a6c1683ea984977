//! The robot behind a RoBIOS C library.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use roverlab::geometry::Pose;
use roverlab::world::InertialSpec;

use super::{Driven, Failure, StageTruth};

/// The robot of a library, until it is taken, and its ground truth.
pub(super) struct Library {
    path: PathBuf,
    robot: Mutex<Option<Driven>>,
    truth: Mutex<Option<StageTruth>>,
}

impl fmt::Debug for Library {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Library").field("path", &self.path).finish_non_exhaustive()
    }
}

impl Library {
    /// Opens a library, with the robot's start pose and the channels of its inertial unit.
    #[cfg(feature = "native")]
    pub(super) fn open(path: &Path, start: Pose, inertial: InertialSpec) -> Result<Self, Failure> {
        let robot = roverlab::io::robios::RobiosRobot::open(path).map_err(Failure::input)?;
        let robot = robot.with_inertial(inertial);
        let truth: StageTruth = Box::new(robot.truth(start));
        let robot: Driven = Box::new(robot);
        Ok(Self { path: path.into(), robot: Mutex::new(Some(robot)), truth: Mutex::new(Some(truth)) })
    }

    /// Browsers have no libraries.
    #[cfg(not(feature = "native"))]
    pub(super) fn open(path: &Path, _start: Pose, _inertial: InertialSpec) -> Result<Self, Failure> {
        Err(Failure::input(format!(
            "{}: found a library; expected a program that can load one",
            path.display()
        )))
    }

    /// Takes the robot, once.
    pub(super) fn robot(&self) -> Result<Driven, Failure> {
        take(&self.robot).ok_or_else(|| alone(&self.path))
    }

    /// Takes its ground truth, once.
    pub(super) fn truth(&self) -> Result<StageTruth, Failure> {
        take(&self.truth).ok_or_else(|| alone(&self.path))
    }
}

fn take<T>(slot: &Mutex<Option<T>>) -> Option<T> {
    slot.lock().unwrap_or_else(PoisonError::into_inner).take()
}

/// The error for several robots: a library has only one.
pub(super) fn alone(library: &Path) -> Failure {
    let library = library.display();
    Failure::input(format!(
        "--robios {library}: found several robots that drive; expected a run of one robot"
    ))
}
