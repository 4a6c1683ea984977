use crate::ParameterError;
use crate::parameter::{require, require_not_negative, require_positive};

/// What [`extract_features`](super::extract_features) goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanFeaturesParameters {
    /// The standard deviation of a range reading, in metres.
    pub range_error: f64,
    /// The shortest wall, in metres.
    pub least_wall: f64,
    /// The fewest points of a wall.
    pub least_points: usize,
    /// The largest width of an object, in metres: what stands alone and is wider is a wall.
    pub largest_object: f64,
    /// How near to the crossing of their lines, in metres, two walls have to end for a corner.
    pub corner_gap: f64,
}

impl Default for ScanFeaturesParameters {
    /// For the lidar of the real robot.
    fn default() -> Self {
        Self { range_error: 0.01, least_wall: 0.12, least_points: 6, largest_object: 0.35, corner_gap: 0.3 }
    }
}

impl ScanFeaturesParameters {
    /// Fails with the name of the parameter that is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("least wall", self.least_wall)?;
        require_positive("largest object", self.largest_object)?;
        require_positive("corner gap", self.corner_gap)?;
        require_not_negative("range error", self.range_error)?;
        require("least points", self.least_points as f64, self.least_points >= 3, "at least 3")
    }

    /// How far a point may lie off its wall, in metres.
    pub(super) fn tolerance(&self) -> f64 {
        (3.2 * self.range_error).max(0.01)
    }

    /// How far a wall's points may lie off it, in metres: the root of their mean square.
    pub(super) fn straightness(&self) -> f64 {
        1.5 * self.range_error + 0.002
    }
}
