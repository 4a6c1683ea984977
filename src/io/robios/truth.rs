use std::sync::{Arc, Mutex, PoisonError};

use super::library::Functions;
use super::numbers::{metres, radians};
use crate::geometry::Pose;
use crate::io::{Error, ErrorKind, GroundTruth, Result, RobotTruth};

/// The latest readings from a library.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Told {
    pub(super) odometry: Pose,
    pub(super) time: f64,
}

/// Ground truth of the robot behind a library, as far as known: the true pose if the library is a simulator
/// that reports it (`SIMGetRobot`), otherwise the last pose by odometry that the program read. Reading it
/// takes no robot time.
///
/// Contacts are not counted, and the path length is measured along the poses read.
#[derive(Debug)]
pub struct RobiosTruth {
    robios: Arc<Functions>,
    told: Arc<Mutex<Told>>,
    start: Pose,
    last: Option<Pose>,
    path_length: f64,
}

impl RobiosTruth {
    pub(super) fn new(robios: Arc<Functions>, told: Arc<Mutex<Told>>, start: Pose) -> Self {
        Self { robios, told, start, last: None, path_length: 0.0 }
    }

    fn told(&self) -> Told {
        *self.told.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn locate(&mut self) -> Pose {
        let pose = simulated_pose(&self.robios).unwrap_or_else(|| self.start.compose(&self.told().odometry));
        self.path_length += self.last.map_or(0.0, |last| last.distance_to(pose.position()));
        self.last = Some(pose);
        pose
    }
}

/// The true pose of a robot, if its library is a simulator that reports it.
fn simulated_pose(robios: &Functions) -> Option<Pose> {
    let (mut x, mut y, mut z, mut phi) = (0, 0, 0, 0);
    let function = robios.SIMGetRobot().ok()?;
    // SAFETY: the library is loaded, and the numbers live until the function returns.
    unsafe { function(0, &raw mut x, &raw mut y, &raw mut z, &raw mut phi) };
    Some(Pose::new(metres(x), metres(y), radians(phi)))
}

fn only_one(robot: usize) -> Result<()> {
    if robot == 0 { Ok(()) } else { Err(Error::invalid_input("robot", robot, "0: a library has one robot")) }
}

impl GroundTruth for RobiosTruth {
    /// Time of the program's last clock reading (s).
    fn time(&mut self) -> Result<f64> {
        Ok(self.told().time)
    }

    fn pose(&mut self, robot: usize) -> Result<Pose> {
        only_one(robot)?;
        Ok(self.locate())
    }

    fn robot(&mut self, robot: usize) -> Result<RobotTruth> {
        only_one(robot)?;
        Ok(RobotTruth {
            pose: self.locate(),
            odometry: self.told().odometry,
            contacts: 0,
            contact_places: Vec::new(),
            path_length: self.path_length,
            trail: Vec::new(),
        })
    }

    fn object(&mut self, object: usize) -> Result<Pose> {
        let message = format!("where object {object} is; RoBIOS does not tell");
        Err(Error::new(ErrorKind::Unsupported, message))
    }
}
