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
    /// No unknown wall matters any more.
    Finished(ExplorationOutcome),
}

/// How an exploration ended.
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
