use super::{ExplorationOutcome, ExplorationStep, Explorer};
use crate::maze::{Cell, Direction, Maze, Unknown};

/// Recursive exploration (book, section 9.5): from each cell into every open and unmarked neighbour, straight on first, then
/// left, then right, and back again.
///
/// A cell is marked when the robot has been in it, and with early marking also as soon as all of its walls are known and it
/// leads to marked cells only: the robot need not go there any more. The end of the exploration is the start.
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
    /// Whether to mark cells that are known on all sides.
    early: bool,
    marked: Vec<bool>,
    /// The cells on the way here from the start, each with the heading in which the robot came.
    stack: Vec<(Cell, Direction)>,
}

impl RecursiveExplorer {
    /// An exploration with early marking, as the book has it.
    pub fn new() -> Self {
        Self { early: true, marked: Vec::new(), stack: Vec::new() }
    }

    /// An exploration that goes into every cell that it can reach.
    pub fn without_early_marking() -> Self {
        Self { early: false, ..Self::new() }
    }
}

impl RecursiveExplorer {
    /// Whether all that a cell leads to is marked.
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
        // What lies behind was left open or is the way back, except at the start.
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
