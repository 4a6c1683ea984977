use crate::ParameterError;
use crate::parameter::{require, require_not_negative, require_positive};

/// Parameters of [`Localiser`](super::Localiser).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocaliserParameters {
    /// Standard deviation of a range (m).
    pub range_error: f64,
    /// Radius of the robot (m); it cannot overlap other objects.
    pub radius: f64,
    /// Probability, relative to the best one, below which a hypothesis is dropped.
    pub least_probability: f64,
    /// Motion after which a scan counts as a new view (m, rad).
    pub view: (f64, f64),
    /// Relative errors of distances and turns by odometry.
    pub odometry_error: (f64, f64),
}

impl Default for LocaliserParameters {
    /// Values for an S4 with realistic noise.
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
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// If one is out of range.
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
