use crate::ParameterError;
use crate::kinematics::OdometryErrors;
use crate::parameter::{require, require_not_negative, require_positive};
use crate::scan::filter::RANGE_ERROR;

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
    /// Errors of odometry.
    pub odometry: OdometryErrors,
    /// Distance between the left and right wheels (m), over which their errors turn the robot.
    pub track: f64,
}

impl Default for LocaliserParameters {
    /// Values for an S4 with realistic noise. Its wheels' errors count about twice, which covers their slip.
    fn default() -> Self {
        Self {
            range_error: 0.01,
            radius: 0.06,
            least_probability: 1e-4,
            view: (0.05, 0.09),
            odometry: OdometryErrors { wheel_scale: 0.02, wheel_mismatch: 0.0018, track: 0.0, slip: 0.0 },
            track: 0.09,
        }
    }
}

impl LocaliserParameters {
    /// Standard deviation of a range (m), at least that of an EyeBot's lidar.
    pub(super) fn lidar_error(&self) -> f64 {
        self.range_error.max(RANGE_ERROR)
    }

    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("radius", self.radius)?;
        require_positive("view (distance)", self.view.0)?;
        require_positive("view (turn)", self.view.1)?;
        let OdometryErrors { wheel_scale, wheel_mismatch, track, slip } = self.odometry;
        require_not_negative("odometry: wheel scale", wheel_scale)?;
        require_not_negative("odometry: wheel mismatch", wheel_mismatch)?;
        require_not_negative("odometry: track error", track)?;
        require_not_negative("odometry: slip", slip)?;
        require_positive("track", self.track)?;
        let share = self.least_probability;
        require("least probability", share, share > 0.0 && share < 0.1, "above 0 and below 0.1")?;
        require_not_negative("range error", self.range_error)
    }
}
