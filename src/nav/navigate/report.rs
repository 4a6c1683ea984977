use crate::geometry::Point;
use crate::io::control::halts;

/// Outcome of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NavigatorOutcome {
    /// The robot is at the goal.
    Reached,
    /// No way leads to the goal, given the known world and the obstacles seen.
    Unreachable,
    /// The known world leaves the robot no room at the goal or within its tolerance.
    NoRoom,
    /// A way exists, or may exist in a world so large that not all of it was searched, but the
    /// robot makes no progress.
    Stuck,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(NavigatorOutcome {
    Reached: "the goal is reached",
    Unreachable: "no way leads to the goal",
    NoRoom: "the robot has no room at the goal",
    Stuck: "the robot makes no progress",
});

/// Phase of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NavigatorPhase {
    /// Standing and looking.
    Looking,
    /// Following the path.
    Driving,
    /// Backing off from an obstacle.
    BackingOff,
    /// Standing, with a verdict.
    Ended(NavigatorOutcome),
}

/// Event of a step. Points are in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum NavigatorEvent {
    /// A first plan exists, or one with another clearance.
    Planned {
        /// Length of the path to the goal (m).
        length: f64,
        /// Free space that it keeps beside the outline (m).
        clearance: f64,
    },
    /// An obstacle that the known world lacks changed the plan.
    Replanned {
        /// Position of the robot.
        point: Point,
        /// Length of the path to the goal (m).
        length: f64,
    },
    /// The robot makes no progress and backs off.
    Blocked {
        /// Position of the robot.
        point: Point,
    },
    /// No way is left; seen obstacles are forgotten and looked at anew, in case they were errors.
    Doubted {
        /// Position of the robot.
        point: Point,
    },
    /// The run is over.
    End(NavigatorOutcome),
}
