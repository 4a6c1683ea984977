use crate::geometry::Point;
use crate::io::control::halts;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NavigatorOutcome {
    /// The robot is at the goal.
    Reached,
    /// No way leads to the goal, by the known world and what has been seen.
    Unreachable,
    /// There should be a way, but the robot does not get on.
    Stuck,
    /// The time was over.
    TimedOut,
    /// Who watched had seen enough.
    Stopped,
}

halts!(NavigatorOutcome {
    Reached: "the goal is reached",
    Unreachable: "no way leads to the goal",
    Stuck: "the robot makes no progress",
});

/// What the robot is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NavigatorPhase {
    /// Standing and looking.
    Looking,
    /// Following the path.
    Driving,
    /// Backing off from what is in the way.
    BackingOff,
    /// Standing, with a verdict.
    Ended(NavigatorOutcome),
}

/// Something worth telling that happened in a step. Points are in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum NavigatorEvent {
    /// There is a first plan, or one with another clearance.
    Planned {
        /// Metres to the goal.
        length: f64,
        /// The free space beside the outline that it keeps.
        clearance: f64,
    },
    /// Something that the known world lacks changed the plan.
    Replanned {
        /// Where the robot was.
        point: Point,
        /// Metres to the goal.
        length: f64,
    },
    /// The robot does not get on and backs off.
    Blocked {
        /// Where it was.
        point: Point,
    },
    /// No way is left; what has been seen is forgotten and looked at anew, in case it was an error.
    Doubted {
        /// Where it was.
        point: Point,
    },
    /// The run is over.
    End(NavigatorOutcome),
}
