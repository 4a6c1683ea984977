use crate::ParameterError;
use crate::parameter::{require, require_not_negative, require_positive};

/// What a [`Localiser`](super::Localiser) goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocaliserParameters {
    /// The standard deviation of a range reading, in metres.
    pub range_error: f64,
    /// The radius of the robot in metres: it cannot be where something else is.
    pub radius: f64,
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
            least_probability: 1e-4,
            view: (0.05, 0.09),
            odometry_error: (0.02, 0.02),
        }
    }
}

impl LocaliserParameters {
    /// Fails with the name of the parameter that is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("radius", self.radius)?;
        require_positive("view (distance)", self.view.0)?;
        require_positive("view (turn)", self.view.1)?;
        require_positive("odometry error of distances", self.odometry_error.0)?;
        require_positive("odometry error of turns", self.odometry_error.1)?;
        let share = self.least_probability;
        require("least probability", share, share > 0.0 && share < 0.1, "above 0 and below 0.1")?;
        require_not_negative("range error", self.range_error)
    }
}
