use crate::io::error::require_positive;
use crate::io::{Error, Result};

/// What a [`Localiser`](super::Localiser) goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocaliserParameters {
    /// The standard deviation of a range reading, in metres.
    pub range_error: f64,
    /// The radius of the robot in metres: it cannot be where something else is.
    pub radius: f64,
    /// Metres and radians between the poses that are tried at first.
    pub grid: (f64, f64),
    /// How many of these are looked at closely.
    pub candidates: usize,
    /// The share of probability below which a hypothesis is given up while others are better.
    pub least_probability: f64,
    /// Metres and radians that the robot has to move before a scan counts as another view.
    pub view: (f64, f64),
    /// The relative error of distances and turns by odometry.
    pub odometry_error: (f64, f64),
}

impl Default for LocaliserParameters {
    /// For an S4 with the noise of the real one.
    fn default() -> Self {
        Self {
            range_error: 0.01,
            radius: 0.06,
            grid: (0.1, 0.09),
            candidates: 240,
            least_probability: 1e-4,
            view: (0.05, 0.09),
            odometry_error: (0.02, 0.02),
        }
    }
}

impl LocaliserParameters {
    /// Fails with the name of the parameter that is out of range.
    pub fn validate(&self) -> Result<()> {
        require_positive("radius", self.radius)?;
        require_positive("grid", self.grid.0)?;
        require_positive("grid of headings", self.grid.1)?;
        require_positive("distance between views", self.view.0)?;
        require_positive("turn between views", self.view.1)?;
        require_positive("error of distances", self.odometry_error.0)?;
        require_positive("error of turns", self.odometry_error.1)?;
        let share = self.least_probability;
        if !(share > 0.0 && share < 0.1) {
            return Err(Error::invalid_input("least probability", share, "above 0 and below 0.1"));
        }
        if self.candidates == 0 {
            return Err(Error::invalid_input("candidates", 0, "at least 1"));
        }
        if !(self.range_error >= 0.0 && self.range_error.is_finite()) {
            return Err(Error::invalid_input(
                "range error",
                self.range_error,
                "a finite number of at least 0",
            ));
        }
        Ok(())
    }
}
