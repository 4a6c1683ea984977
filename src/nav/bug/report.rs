use crate::geometry::Point;
use crate::geometry::WallSide;
use crate::io::control::halts;

/// How the run of a bug ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BugOutcome {
    /// The robot is at the goal.
    Reached,
    /// The robot went all the way round an obstacle without getting nearer to the goal: there is no way.
    Unreachable,
    /// The robot sees that there is no room for it at the goal, nor anywhere near enough to it.
    NoRoom,
    /// The time was over.
    TimedOut,
    /// Who watched had seen enough.
    Stopped,
}

halts!(BugOutcome {
    Reached: "the goal is reached",
    Unreachable: "no way leads to the goal",
    NoRoom: "the robot has no room at the goal",
});

/// What the robot is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BugPhase {
    /// Looking round: standing, then turning once on the spot, which shows how true odometry's turns are.
    LookingRound,
    /// Driving towards the goal.
    ToGoal,
    /// Following the boundary of an obstacle.
    Following(WallSide),
    /// Standing, with a verdict.
    Ended(BugOutcome),
}

/// Something worth telling that happened in a step. Points are where the robot was, relative to its start.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum BugEvent {
    /// An obstacle is in the way: the hit point.
    Hit {
        /// Where the robot was.
        point: Point,
        /// The side of the robot on which it follows the obstacle.
        side: WallSide,
    },
    /// The robot turns back and follows the same obstacle the other way.
    Reverse {
        /// Where the robot was.
        point: Point,
        /// The side of the robot on which it follows the obstacle from now on.
        side: WallSide,
    },
    /// The way to the goal is free enough: the leave point.
    Leave {
        /// Where the robot was.
        point: Point,
        /// The free distance towards the goal.
        free: f64,
    },
    /// The run is over.
    End(BugOutcome),
}
