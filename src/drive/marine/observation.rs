use crate::geometry::Vector3;
use crate::io::reading::check_attitude;
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
        check_attitude(&self.attitude)?;
        match [self.rates.y, self.rates.z].iter().find(|rate| !rate.is_finite()) {
            Some(rate) => Err(Error::invalid_input("observed turn rate", rate, "a finite number")),
            None => Ok(()),
        }
    }
}
