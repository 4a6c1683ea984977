use super::{ExplorationOutcome, ExplorationStep, Explorer};
use crate::maze::{Cell, Direction, Maze, Unknown};

/// Recursive exploration (book, section 9.5): depth-first into every open, unmarked neighbour, straight on
/// first, then left, then right, and back.
///
/// A visited cell is marked. With early marking, a cell is also marked once all of its walls are known and it
/// leads to marked cells only, so the robot need not visit it. The exploration ends at the start.
///
/// ```
/// use roverlab::maze::generate::competition;
/// use roverlab::maze::{Direction, ExplorationOutcome, ExplorationStep, Explorer, Maze, RecursiveExplorer};
/// let truth = competition(8, 1)?;
/// let mut known = Maze::unexplored(8, 8)?;
/// let mut explorer = RecursiveExplorer::new();
/// let mut at = (known.start(), known.heading());
/// let outcome = loop {
///     Direction::ALL.map(|side| known.set_wall(at.0, side, truth.wall(at.0, side)));
///     match explorer.next(&known, at) {
///         ExplorationStep::Go(cell) => at.0 = cell,
///         ExplorationStep::Finished(outcome) => break outcome,
///     }
/// };
/// assert_eq!((outcome, known.unknown_walls()), (ExplorationOutcome::Explored, 0));
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct RecursiveExplorer {
    /// Whether cells with known walls are marked early.
    early: bool,
    marked: Vec<bool>,
    /// Path from the start, each cell with the heading of arrival.
    stack: Vec<(Cell, Direction)>,
}

impl RecursiveExplorer {
    /// An exploration with early marking, as in the book.
    pub fn new() -> Self {
        Self { early: true, marked: Vec::new(), stack: Vec::new() }
    }

    /// An exploration that visits every reachable cell.
    pub fn without_early_marking() -> Self {
        Self { early: false, ..Self::new() }
    }
}

impl RecursiveExplorer {
    /// Whether all accessible neighbours of a cell are marked.
    fn leads_nowhere(&self, maze: &Maze, cell: Cell) -> bool {
        Direction::ALL.into_iter().all(|direction| {
            maze.passage(cell, direction, Unknown::Closed).is_none_or(|next| self.marked[maze.index(next)])
        })
    }
}

impl Default for RecursiveExplorer {
    fn default() -> Self {
        Self::new()
    }
}

impl Explorer for RecursiveExplorer {
    fn next(&mut self, maze: &Maze, (cell, heading): (Cell, Direction)) -> ExplorationStep {
        self.marked.resize(maze.cell_count(), false);
        self.marked[maze.index(cell)] = true;
        if self.stack.last().is_none_or(|&(last, _)| last != cell) {
            self.stack.push((cell, heading));
        }
        let Some(&(_, came)) = self.stack.last() else {
            return ExplorationStep::Finished(ExplorationOutcome::Explored);
        };
        // Behind is the way back, or at the start the remaining direction.
        for direction in [came, came.left(), came.right(), came.opposite()] {
            let Some(next) = maze.passage(cell, direction, Unknown::Closed) else { continue };
            let index = maze.index(next);
            if self.early && maze.is_known(next) && self.leads_nowhere(maze, next) {
                self.marked[index] = true;
            }
            if !self.marked[index] {
                return ExplorationStep::Go(next);
            }
        }
        self.stack.pop();
        match self.stack.last() {
            Some(&(back, _)) => ExplorationStep::Go(back),
            None => ExplorationStep::Finished(ExplorationOutcome::Explored),
        }
    }
}
