use crate::ParameterError;
use crate::parameter::{require, require_not_negative, require_positive};

/// Parameters of [`extract_features`](super::extract_features).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanFeaturesParameters {
    /// Standard deviation of a range (m).
    pub range_error: f64,
    /// Minimum length of a wall (m).
    pub least_wall: f64,
    /// Minimum number of points of a wall.
    pub least_points: usize,
    /// Maximum width of an object (m); wider isolated surfaces are walls.
    pub largest_object: f64,
    /// Maximum distance of two walls' ends from their corner (m).
    pub corner_gap: f64,
}

impl Default for ScanFeaturesParameters {
    /// Values for the lidar of the real robot.
    fn default() -> Self {
        Self { range_error: 0.01, least_wall: 0.12, least_points: 6, largest_object: 0.35, corner_gap: 0.3 }
    }
}

impl ScanFeaturesParameters {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("least wall", self.least_wall)?;
        require_positive("largest object", self.largest_object)?;
        require_positive("corner gap", self.corner_gap)?;
        require_not_negative("range error", self.range_error)?;
        require("least points", self.least_points as f64, self.least_points >= 3, "at least 3")
    }

    /// Maximum distance of a point from its wall (m).
    pub(super) fn tolerance(&self) -> f64 {
        (3.2 * self.range_error).max(0.01)
    }

    /// Maximum RMS distance of a wall's points from its line (m).
    pub(super) fn straightness(&self) -> f64 {
        1.5 * self.range_error + 0.002
    }
}
