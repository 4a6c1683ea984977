use crate::ParameterError;
use crate::parameter::{require, require_positive};
use crate::world::Footprint;

/// Parameters of a [`Navigator`](super::Navigator). Lengths in metres, speeds in metres per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NavigatorParameters {
    /// Outline of the robot.
    pub footprint: Footprint,
    /// Free space beside the outline that the plan keeps where there is room.
    pub clearance: f64,
    /// Free space required beside the outline on either side of a passage.
    pub least_clearance: f64,
    /// Cell size of the planning grid, from a hundredth of the robot's radius to 1000 m; larger in large
    /// worlds, to keep to at most four million cells.
    pub resolution: f64,
    /// Distance from the goal that counts as reached.
    pub goal_tolerance: f64,
    /// Speed in the open.
    pub cruise_speed: f64,
    /// Maximum turn rate (rad/s).
    pub turn_rate: f64,
    /// Whether scan matching with the known world corrects odometry.
    pub match_scans: bool,
    /// Control period (s).
    pub period: f64,
}

/// Smallest cells relative to the robot's radius: finer ones tell nothing more about where it has room.
const FINEST: f64 = 0.01;

impl NavigatorParameters {
    /// Parameters for a robot's outline; distances scale with its bounding radius.
    pub fn for_footprint(footprint: Footprint) -> Self {
        let radius = footprint.bounding_radius();
        Self {
            footprint,
            clearance: 0.65 * radius,
            least_clearance: 0.2 * radius,
            resolution: radius / 6.0,
            goal_tolerance: 0.025,
            cruise_speed: 0.3,
            turn_rate: 3.0,
            match_scans: true,
            period: 0.05,
        }
    }

    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("radius of the footprint", self.radius())?;
        require_positive("least clearance", self.least_clearance)?;
        let finest = FINEST * self.radius();
        let good = self.resolution >= finest && self.resolution <= 1000.0;
        let expected = format!("at least a hundredth of the robot's radius, {finest}, and at most 1000 m");
        require("resolution", self.resolution, good, expected)?;
        require_positive("goal tolerance", self.goal_tolerance)?;
        require_positive("cruise speed", self.cruise_speed)?;
        require_positive("turn rate", self.turn_rate)?;
        require_positive("control period", self.period)?;
        let good = self.clearance >= self.least_clearance && self.clearance <= 1000.0;
        require(
            "clearance",
            self.clearance,
            good,
            format!("at least the least clearance, {}, and at most 1000 m", self.least_clearance),
        )
    }

    /// Bounding radius of the outline, with which the robot can turn everywhere (m).
    pub(super) fn radius(&self) -> f64 {
        self.footprint.bounding_radius()
    }

    /// Distance from its centre to the nearest obstacle with which the robot has room (m).
    pub(super) fn room(&self) -> f64 {
        self.radius() + self.least_clearance
    }
}

impl Default for NavigatorParameters {
    /// Parameters for the S4's disc of 60 mm.
    fn default() -> Self {
        Self::for_footprint(Footprint::Disc { radius: 0.060 })
    }
}
