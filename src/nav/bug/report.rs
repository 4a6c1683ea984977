use crate::geometry::Point;
use crate::geometry::WallSide;
use crate::io::control::halts;

/// Outcome of a bug's run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BugOutcome {
    /// The robot is at the goal.
    Reached,
    /// The robot circled an obstacle without getting nearer to the goal: no path exists.
    Unreachable,
    /// The robot sees that it has no room at the goal or within its tolerance.
    NoRoom,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(BugOutcome {
    Reached: "the goal is reached",
    Unreachable: "no way leads to the goal",
    NoRoom: "the robot has no room at the goal",
});

/// Phase of a bug's run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BugPhase {
    /// Standing, then turning once on the spot, which calibrates the turns of odometry.
    LookingRound,
    /// Driving towards the goal.
    ToGoal,
    /// Following the boundary of an obstacle.
    Following(WallSide),
    /// Standing, with a verdict.
    Ended(BugOutcome),
}

/// Event of a step. Points are the robot's positions relative to its start.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum BugEvent {
    /// An obstacle is in the way: the hit point.
    Hit {
        /// Position of the robot.
        point: Point,
        /// Side of the robot on which it follows the obstacle.
        side: WallSide,
    },
    /// The robot turns back and follows the same obstacle the other way.
    Reverse {
        /// Position of the robot.
        point: Point,
        /// Side of the robot on which it follows the obstacle from now on.
        side: WallSide,
    },
    /// The robot leaves the obstacle: the leave point.
    Leave {
        /// Position of the robot.
        point: Point,
        /// Free distance towards the goal (m).
        free: f64,
    },
    /// The run is over.
    End(BugOutcome),
}
