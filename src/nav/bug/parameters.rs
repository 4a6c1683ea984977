use crate::ParameterError;
use crate::geometry::WallSide;
use crate::nav::boundary::FollowDistances;
use crate::parameter::{require, require_positive};

/// Parameters of the bugs. Lengths in metres, speeds in metres per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BugParameters {
    /// Radius of the robot's outline.
    pub robot_radius: f64,
    /// Free space required beside the outline on either side of a passage.
    pub least_clearance: f64,
    /// Free space kept beside the outline where there is room.
    pub clearance: f64,
    /// STEP of the leave conditions: how much nearer to the goal a leave must bring the robot.
    pub step: f64,
    /// Distance from the goal that counts as reached.
    pub goal_tolerance: f64,
    /// Speed in the open.
    pub cruise_speed: f64,
    /// Speed along an obstacle.
    pub follow_speed: f64,
    /// Side on which obstacles are followed at first; `None` chooses the smaller turn.
    pub side: Option<WallSide>,
    /// Whether scan matching corrects odometry.
    pub match_scans: bool,
    /// Delay of the robot's response (s): at a speed `v` it rolls another `v * lag` before it stands.
    pub lag: f64,
    /// Control period (s).
    pub period: f64,
}

impl BugParameters {
    /// Parameters for a disc-shaped robot of this radius (m); distances scale with it.
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

    /// Checks every parameter; the error names the one out of range.
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
    /// Parameters for the S4's radius of 60 mm.
    fn default() -> Self {
        Self::for_radius(0.060)
    }
}
