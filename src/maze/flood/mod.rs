//! Flood fill: number of steps from every cell to the nearest source (book, section 9.6).

mod incremental;
mod passages;
mod queue;
#[cfg(target_arch = "x86_64")]
mod register;
#[allow(clippy::inline_always, reason = "only inlined code is compiled for the selected processor")]
mod wave;

#[cfg(test)]
mod tests;

pub use incremental::IncrementalFlood;
pub use passages::Passages;

use super::{Cell, Maze, Unknown};
use passages::Grid;

/// Steps from cells to the nearest source of a flood fill.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Distances {
    width: usize,
    steps: Vec<u32>,
}

/// Distance of unreachable cells.
const UNREACHED: u32 = u32::MAX;

impl Distances {
    /// Steps from a cell to the nearest source; `None` if it is unreachable or outside the maze.
    #[inline]
    pub fn get(&self, cell: Cell) -> Option<u32> {
        let x = usize::from(cell.x);
        if x >= self.width {
            return None;
        }
        self.steps.get(usize::from(cell.y) * self.width + x).copied().filter(|&steps| steps != UNREACHED)
    }

    /// Number of reachable cells, sources included.
    pub fn reached(&self) -> usize {
        self.steps.iter().filter(|&&steps| steps != UNREACHED).count()
    }

    /// Maximum number of steps of any reachable cell; `None` without sources.
    pub fn farthest(&self) -> Option<u32> {
        self.steps.iter().copied().filter(|&steps| steps != UNREACHED).max()
    }

    /// Steps of all cells, row by row from below; `u32::MAX` if unreachable.
    pub fn as_slice(&self) -> &[u32] {
        &self.steps
    }

    fn reset(&mut self, width: usize, cells: usize) {
        self.width = width;
        self.steps.clear();
        self.steps.resize(cells, UNREACHED);
    }
}

/// Flood fills that reuse their buffers.
///
/// Mazes of up to 32 x 32 cells are filled by a bit-parallel wave that advances all cells of one distance at
/// once. It is compiled for several processors, and the best version is selected at run time; the time is
/// proportional to the steps to the farthest cell. Larger mazes are filled from a queue with few branches, in
/// time proportional to the number of cells.
///
/// ```
/// use roverlab::maze::{Cell, Direction, FloodFill, Maze, Passages, Unknown, WallState};
///
/// let mut maze = Maze::open(3, 3)?;
/// maze.set_wall(Cell::new(1, 1), Direction::South, WallState::Present);
/// let passages = Passages::new(&maze, Unknown::Closed);
/// let mut flood = FloodFill::default();
/// let steps = flood.run(&passages, [Cell::new(1, 0)]);
/// assert_eq!(steps.get(Cell::new(1, 1)), Some(3));
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct FloodFill {
    distances: Distances,
    queue: queue::Queue,
}

impl FloodFill {
    /// Fills a maze from its sources; sources outside it are ignored.
    pub fn run(&mut self, passages: &Passages, sources: impl IntoIterator<Item = Cell>) -> &Distances {
        let distances = &mut self.distances;
        let inside = |cell: &Cell| passages.contains(*cell);
        let sources = sources.into_iter().filter(inside);
        if distances.width != passages.width || distances.steps.len() != passages.width * passages.height {
            distances.reset(passages.width, passages.width * passages.height);
        }
        match &passages.grid {
            Grid::Small(boards) => wave::fill_small(boards, sources, passages.width, &mut distances.steps),
            Grid::Medium(boards) => {
                wave::fill_medium(boards, sources, passages.width, &mut distances.steps);
            }
            Grid::Large(openings) => {
                self.queue.fill(openings, sources, passages.width, &mut distances.steps);
            }
        }
        distances
    }

    /// Result of the last run.
    pub fn distances(&self) -> &Distances {
        &self.distances
    }

    /// Result of the last run, without a copy.
    pub fn into_distances(self) -> Distances {
        self.distances
    }
}

/// Steps from every cell to the goal.
///
/// ```
/// use roverlab::maze::{Cell, Maze, Unknown, distances_to_goal};
/// let mut maze = Maze::open(4, 3)?;
/// maze.set_goals([Cell::new(3, 2)]);
/// let steps = distances_to_goal(&maze, Unknown::Closed);
/// assert_eq!(steps.as_slice(), [5, 4, 3, 2, 4, 3, 2, 1, 3, 2, 1, 0], "row by row from below");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
pub fn distances_to_goal(maze: &Maze, unknown: Unknown) -> Distances {
    let mut flood = FloodFill::default();
    flood.run(&Passages::new(maze, unknown), maze.goals());
    flood.into_distances()
}

/// Steps from the start to every cell.
///
/// ```
/// use roverlab::maze::{Cell, Direction, Maze, Unknown, WallState, distances_from_start};
/// let mut maze = Maze::open(3, 1)?;
/// maze.set_wall(Cell::new(1, 0), Direction::East, WallState::Present);
/// let steps = distances_from_start(&maze, Unknown::Closed);
/// assert_eq!([0, 1, 2].map(|x| steps.get(Cell::new(x, 0))), [Some(0), Some(1), None]);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
pub fn distances_from_start(maze: &Maze, unknown: Unknown) -> Distances {
    let mut flood = FloodFill::default();
    flood.run(&Passages::new(maze, unknown), [maze.start()]);
    flood.into_distances()
}
