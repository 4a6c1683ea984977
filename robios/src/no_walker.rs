//! Where there is no physics engine, no robot walks.

use roverlab::geometry::Pose;
use roverlab::io::Result;
use roverlab::world::RobotSpec;

/// There is none.
#[derive(Debug)]
pub(crate) enum Walker {}

impl Walker {
    pub(crate) fn of(_: &RobotSpec, _: Pose) -> Option<Self> {
        None
    }

    pub(crate) fn live_until(&mut self, _: f64) -> Result<()> {
        match *self {}
    }

    pub(crate) fn set_servo(&mut self, _: u8, _: f64) -> Result<()> {
        match *self {}
    }

    pub(crate) fn walked(&self) -> f64 {
        match *self {}
    }

    pub(crate) fn pose(&self) -> Pose {
        match *self {}
    }

    pub(crate) fn height(&self) -> f64 {
        match *self {}
    }

    pub(crate) fn odometry(&self) -> Pose {
        match *self {}
    }

    pub(crate) fn set_odometry(&mut self, _: Pose) {
        match *self {}
    }

    pub(crate) fn place(&mut self, _: Pose) -> Result<()> {
        match *self {}
    }
}

/// Whether a robot with this name walks.
pub(crate) fn is_walker(_: &str) -> bool {
    false
}
