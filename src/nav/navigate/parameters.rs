use crate::ParameterError;
use crate::parameter::{require, require_positive};
use crate::world::Footprint;

/// What a [`Navigator`](super::Navigator) goes by. Lengths in metres, speeds in metres per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NavigatorParameters {
    /// The robot's outline.
    pub footprint: Footprint,
    /// The free space beside the outline that the plan keeps where there is room.
    pub clearance: f64,
    /// The free space beside the outline that a passage must offer on either side.
    pub least_clearance: f64,
    /// Along an edge of the cells that it plans on. In large worlds they are larger, so that there are at most four
    /// million.
    pub resolution: f64,
    /// The distance to the goal that counts as reached.
    pub goal_tolerance: f64,
    /// The speed in the open.
    pub cruise_speed: f64,
    /// The fastest turn, in radians per second.
    pub turn_rate: f64,
    /// Whether odometry is corrected by matching scans with the known world.
    pub match_scans: bool,
    /// Seconds from one control step to the next.
    pub period: f64,
}

impl NavigatorParameters {
    /// Parameters for a robot with an outline; distances are scaled to the radius of the circle that holds it.
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

    /// Fails with the name of the parameter that is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("radius of the footprint", self.radius())?;
        require_positive("least clearance", self.least_clearance)?;
        require_positive("resolution", self.resolution)?;
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

    /// The radius of the circle that holds the outline: with it the robot can turn everywhere.
    pub(super) fn radius(&self) -> f64 {
        self.footprint.bounding_radius()
    }
}

impl Default for NavigatorParameters {
    /// For the S4's disc of 60 mm.
    fn default() -> Self {
        Self::for_footprint(Footprint::Disc { radius: 0.060 })
    }
}
