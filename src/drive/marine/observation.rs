use crate::geometry::Vector3;
use crate::io::{Attitude, DepthSensor, Error, Inertial, Result};

/// Depth, attitude and turn rates of a craft: the readings of [`Dive`](super::Dive).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DiveObservation {
    /// Metres from the surface to the sensor.
    pub depth: f64,
    /// How the craft is turned.
    pub attitude: Attitude,
    /// How it turns about its own axes (rad/s).
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
        let angles = [self.attitude.pitch, self.attitude.yaw, self.rates.y, self.rates.z];
        match angles.iter().find(|angle| !angle.is_finite()) {
            Some(angle) => Err(Error::invalid_input("observed attitude", angle, "finite numbers")),
            None => Ok(()),
        }
    }
}
