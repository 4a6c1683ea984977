use std::collections::VecDeque;

use super::{Distances, FloodFill, Passages, UNREACHED};
use crate::maze::{Cell, Direction};

/// A flood fill that is updated incrementally when walls change.
///
/// An opened wall lets shorter ways spread through it. A closed wall invalidates the cells whose shortest
/// ways all used it; they are filled again from their boundary (Ramalingam and Reps, 1996, with unit costs).
/// The work is proportional to the cells whose distance changes. Up to 32 x 32 cells, [`FloodFill`] is
/// faster, whatever changes.
///
/// ```
/// use roverlab::maze::{Cell, Direction, IncrementalFlood, Maze, Passages, Unknown};
/// let passages = Passages::new(&Maze::open(3, 2)?, Unknown::Closed);
/// let (source, far) = (Cell::new(0, 0), Cell::new(2, 0));
/// let mut flood = IncrementalFlood::new(passages, [source]);
/// assert_eq!(flood.distances().get(far), Some(2));
/// let changed = flood.set(source, Direction::East, false);
/// assert_eq!((changed, flood.distances().get(far)), (2, Some(4)), "around through the other row");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct IncrementalFlood {
    passages: Passages,
    sources: Vec<Cell>,
    distances: Distances,
    queue: VecDeque<Cell>,
}

impl IncrementalFlood {
    /// Fills a maze from its sources.
    pub fn new(passages: Passages, sources: impl IntoIterator<Item = Cell>) -> Self {
        let sources: Vec<Cell> = sources.into_iter().filter(|&cell| passages.contains(cell)).collect();
        let mut flood = FloodFill::default();
        flood.run(&passages, sources.iter().copied());
        Self { passages, sources, distances: flood.into_distances(), queue: VecDeque::new() }
    }

    /// The present distances.
    pub fn distances(&self) -> &Distances {
        &self.distances
    }

    /// The present passages.
    pub fn passages(&self) -> &Passages {
        &self.passages
    }

    /// Opens or closes the passage between a cell and its neighbour. Returns the number of changed distances.
    pub fn set(&mut self, cell: Cell, direction: Direction, open: bool) -> usize {
        let Some(other) = self.next(cell, direction) else { return 0 };
        if self.passages.is_open(cell, direction) == open {
            return 0;
        }
        self.passages.set(cell, direction, open);
        if open { self.improve([cell, other]) } else { self.worsen([cell, other]) }
    }

    fn next(&self, cell: Cell, direction: Direction) -> Option<Cell> {
        let (dx, dy) = direction.step();
        let x = u16::try_from(i32::from(cell.x) + dx).ok()?;
        let y = u16::try_from(i32::from(cell.y) + dy).ok()?;
        let next = Cell::new(x, y);
        (self.passages.contains(cell) && self.passages.contains(next)).then_some(next)
    }

    fn open_neighbours(&self, cell: Cell) -> impl Iterator<Item = Cell> + use<'_> {
        let open = move |&direction: &Direction| self.passages.is_open(cell, direction);
        Direction::ALL.into_iter().filter(open).filter_map(move |direction| self.next(cell, direction))
    }

    fn steps(&self, cell: Cell) -> u32 {
        self.distances.steps[self.index(cell)]
    }

    fn set_steps(&mut self, cell: Cell, steps: u32) {
        let index = self.index(cell);
        self.distances.steps[index] = steps;
    }

    fn index(&self, cell: Cell) -> usize {
        usize::from(cell.y) * self.passages.width + usize::from(cell.x)
    }

    /// Minimum distance by way of the neighbours of a cell.
    fn offer(&self, cell: Cell) -> u32 {
        let offers = self.open_neighbours(cell).map(|other| self.steps(other));
        offers.min().unwrap_or(UNREACHED).saturating_add(1)
    }

    /// Propagates shorter ways from cells.
    fn improve(&mut self, cells: impl IntoIterator<Item = Cell>) -> usize {
        let mut changed = 0;
        self.queue.extend(cells);
        while let Some(cell) = self.queue.pop_front() {
            let offer = self.offer(cell);
            if offer < self.steps(cell) {
                self.set_steps(cell, offer);
                changed += 1;
                let neighbours: Vec<Cell> = self.open_neighbours(cell).collect();
                self.queue.extend(neighbours);
            }
        }
        changed
    }

    /// Invalidates distances that lost their support, and fills those cells again.
    fn worsen(&mut self, cells: impl IntoIterator<Item = Cell>) -> usize {
        let mut lost: Vec<(Cell, u32)> = Vec::new();
        self.queue.extend(cells);
        while let Some(cell) = self.queue.pop_front() {
            let steps = self.steps(cell);
            if steps == UNREACHED || self.sources.contains(&cell) || self.offer(cell) == steps {
                continue;
            }
            self.set_steps(cell, UNREACHED);
            lost.push((cell, steps));
            let dependents: Vec<Cell> =
                self.open_neighbours(cell).filter(|&other| self.steps(other) == steps + 1).collect();
            self.queue.extend(dependents);
        }
        self.refill(lost.iter().map(|&(cell, _)| cell).collect());
        lost.iter().filter(|&&(cell, steps)| self.steps(cell) != steps).count()
    }

    /// Fills invalidated cells from their surroundings, nearest first.
    fn refill(&mut self, lost: Vec<Cell>) {
        let mut rim: Vec<(u32, Cell)> = lost.into_iter().map(|cell| (self.offer(cell), cell)).collect();
        rim.retain(|&(offer, _)| offer != UNREACHED);
        rim.sort_unstable();
        let mut rim = rim.into_iter().peekable();
        let mut queue: VecDeque<(u32, Cell)> = VecDeque::new();
        loop {
            let from_rim = match (rim.peek(), queue.front()) {
                (Some((a, _)), Some((b, _))) => a <= b,
                (Some(_), None) => true,
                (None, Some(_)) => false,
                (None, None) => return,
            };
            let next = if from_rim { rim.next() } else { queue.pop_front() };
            let Some((steps, cell)) = next else { return };
            if self.steps(cell) <= steps {
                continue;
            }
            self.set_steps(cell, steps);
            let onward: Vec<Cell> =
                self.open_neighbours(cell).filter(|&other| self.steps(other) > steps + 1).collect();
            queue.extend(onward.into_iter().map(|other| (steps + 1, other)));
        }
    }
}
