use crate::geometry::{Pose, Vector3};
use crate::io::{Attitude, DepthSensor, Error, Inertial, Result};

/// Depth, attitude and turn rates of a craft: the readings of [`Dive`](super::Dive).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DiveObservation {
    /// Depth of the sensor below the surface (m).
    pub depth: f64,
    /// Attitude of the craft.
    pub attitude: Attitude,
    /// Turn rates about its own axes (rad/s).
    pub rates: Vector3,
}

impl DiveObservation {
    pub(super) fn read<R: DepthSensor + Inertial + ?Sized>(&mut self, robot: &mut R) -> Result<()> {
        self.depth = robot.depth()?;
        self.attitude = robot.attitude()?;
        self.rates = robot.turn_rates()?;
        Ok(())
    }

    /// Fails with the name of a reading that is none.
    pub(super) fn check(&self) -> Result<()> {
        if !(self.depth.is_finite() && self.depth >= 0.0) {
            return Err(Error::invalid_input("observed depth", self.depth, "a finite number of at least 0"));
        }
        let Attitude { roll, pitch, yaw } = self.attitude;
        let angles = [roll, pitch, yaw, self.rates.y, self.rates.z];
        match angles.iter().find(|angle| !angle.is_finite()) {
            Some(angle) => Err(Error::invalid_input("observed attitude", angle, "finite numbers")),
            None => Ok(()),
        }
    }
}

/// Fails for a pose that is none.
pub(super) fn check_pose(pose: &Pose) -> Result<()> {
    let expected = "finite numbers";
    let wrong = || Error::invalid_input("observed pose", format!("{pose:?}"), expected);
    if pose.is_finite() { Ok(()) } else { Err(wrong()) }
}

/// Fails for the first distance that is none. Infinity is the distance of nothing in range.
pub(super) fn check_ranges(ranges: &[f64]) -> Result<()> {
    match ranges.iter().find(|range| range.is_nan() || **range < 0.0) {
        Some(range) => Err(Error::invalid_input("observed distance", range, "at least 0")),
        None => Ok(()),
    }
}
