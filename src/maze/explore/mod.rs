//! Exploring a maze: what to look at next, until the maze, or all of it that matters, is known.

mod recursive;
#[cfg(test)]
mod tests;
mod two_phase;

pub use recursive::RecursiveExplorer;
pub use two_phase::{Goals, TwoPhaseExplorer};

use super::{Cell, Direction, Maze};

/// A strategy of exploration: pure, so that it can be asked for a robot, for a simulator's mouse and in tests alike.
pub trait Explorer {
    /// The cell to go to next. It can be reached through walls that are known to be absent. The maze must say all that was
    /// seen so far, and the robot must have looked around in the cell where it is.
    fn next(&mut self, maze: &Maze, at: (Cell, Direction)) -> ExplorationStep;
}

/// What an explorer wants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExplorationStep {
    /// Go there and look around.
    Go(Cell),
    /// Nothing that is unknown matters any more.
    Finished(ExplorationOutcome),
}

/// How an exploration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ExplorationOutcome {
    /// The best route is known, and no unknown wall can make it better.
    Optimal,
    /// No route leads to the goal.
    Unreachable,
    /// The maze is known as far as it can be reached.
    Explored,
    /// The time of the run was over first.
    TimedOut,
}
