use crate::ParameterError;
use crate::geometry::WallSide;
use crate::nav::boundary::FollowDistances;
use crate::parameter::{require, require_positive};

/// What the bugs go by. Lengths in metres, speeds in metres per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BugParameters {
    /// The radius of the robot's outline.
    pub robot_radius: f64,
    /// The free space beside the outline that a passage must offer on either side.
    pub least_clearance: f64,
    /// The free space beside the outline that is kept to an obstacle where there is room.
    pub clearance: f64,
    /// STEP of the leave conditions: how much nearer to the goal than before a leave must bring the robot.
    pub step: f64,
    /// The distance to the goal that counts as reached.
    pub goal_tolerance: f64,
    /// The speed in the open.
    pub cruise_speed: f64,
    /// The speed along an obstacle.
    pub follow_speed: f64,
    /// On which side obstacles are kept at first; `None`: on the side that needs the smaller turn.
    pub side: Option<WallSide>,
    /// Whether odometry is corrected by matching scans.
    pub match_scans: bool,
    /// The seconds by which the robot does later what it is told: at a speed `v` it rolls `v * lag` farther before it stands.
    pub lag: f64,
    /// Seconds from one control step to the next.
    pub period: f64,
}

impl BugParameters {
    /// Parameters for a disc-shaped robot of a radius in metres; distances are scaled to it.
    pub fn for_radius(radius: f64) -> Self {
        Self {
            robot_radius: radius,
            least_clearance: 0.2 * radius,
            clearance: 0.65 * radius,
            step: 0.25 * radius,
            goal_tolerance: 0.025,
            cruise_speed: 0.3,
            follow_speed: 0.2,
            side: None,
            match_scans: true,
            lag: 0.2,
            period: 0.05,
        }
    }

    /// Fails with the name of the parameter that is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("robot radius", self.robot_radius)?;
        require_positive("least clearance", self.least_clearance)?;
        require_positive("STEP", self.step)?;
        require_positive("goal tolerance", self.goal_tolerance)?;
        require_positive("cruise speed", self.cruise_speed)?;
        require_positive("follow speed", self.follow_speed)?;
        require_positive("lag", self.lag)?;
        require_positive("control period", self.period)?;
        let good = self.clearance >= self.least_clearance && self.clearance.is_finite();
        require(
            "clearance",
            self.clearance,
            good,
            format!("at least the least clearance, {}", self.least_clearance),
        )
    }

    pub(super) fn follow_distances(&self) -> FollowDistances {
        let wished = self.robot_radius + self.clearance;
        FollowDistances { least: self.robot_radius + self.least_clearance, wished, step: wished }
    }
}

impl Default for BugParameters {
    /// For the S4's 60 mm.
    fn default() -> Self {
        Self::for_radius(0.060)
    }
}
