//! Exploration of a maze, until the maze or all that matters of it is known.

mod recursive;
#[cfg(test)]
mod tests;
mod two_phase;

pub use recursive::RecursiveExplorer;
pub use two_phase::{Goals, TwoPhaseExplorer};

use super::{Cell, Direction, Maze};

/// An exploration strategy. It does no input or output, so robots, the simulator's mouse and tests can use it
/// alike.
///
/// # For implementers
///
/// Return a cell that known passages connect with the present one. Finish as soon as no unknown wall
/// can change the outcome: a cell without unknown walls, returned again and again, is an endless run.
pub trait Explorer {
    /// Returns the cell to visit next, which is reachable through walls known to be absent. `maze` must
    /// contain everything seen so far, including the walls around the present cell.
    fn next(&mut self, maze: &Maze, at: (Cell, Direction)) -> ExplorationStep;
}

/// Decision of an explorer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExplorationStep {
    /// Go to this cell and look around.
    Go(Cell),
    /// No unknown wall matters.
    Finished(ExplorationOutcome),
}

/// Outcome of an exploration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ExplorationOutcome {
    /// The best route is known, and no unknown wall can improve it.
    Optimal,
    /// No route leads to the goal.
    Unreachable,
    /// Everything reachable is known.
    Explored,
    /// The time limit was exceeded.
    TimedOut,
}

impl std::fmt::Display for ExplorationOutcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Optimal => "the best route is known",
            Self::Unreachable => "no route leads to the goal",
            Self::Explored => "everything reachable is known",
            Self::TimedOut => "the time is over",
        })
    }
}
