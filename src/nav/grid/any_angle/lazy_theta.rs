use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::field::{Field, HalfPoint};
use super::sight::in_sight;
use crate::geometry::Point;
use crate::nav::grid::components::GridComponents;
use crate::nav::grid::path::{GridPath, GridPlanner, PlanError, SearchStatistics, check};
use crate::world::{BitGrid, GridCell};

/// Lazy Theta\*: A\* from cell to cell with paths that skip unnecessary cells in between.
///
/// A cell takes its predecessor's predecessor as its parent, assuming that it is in sight; this is checked
/// when the cell leaves the queue. Paths turn at the centres of cells and are short, but not the shortest:
/// [`AnyAngle`] finds those. The same rule holds for both: paths may touch corners, but not pass between two
/// blocked cells that touch at a corner.
///
/// A. Nash, S. Koenig, C. Tovey, *Lazy Theta\*: Any-Angle Path Planning and Path Length Analysis in 3D*, AAAI
/// 2010. Time O(n log n) for n cells, plus one line-of-sight check per expanded cell; 24 bytes per cell.
///
/// [`AnyAngle`]: super::AnyAngle
///
/// ```
/// use roverlab::nav::grid::{GridPlanner, LazyThetaStar};
/// use roverlab::world::{BitGrid, GridCell};
/// let grid = BitGrid::from_text("....\n.##.\n....")?;
/// let path = LazyThetaStar::new(&grid).plan(GridCell::new(0, 1), GridCell::new(3, 0)).unwrap();
/// assert!((path.cost - (2.0_f64.sqrt() + 2.0)).abs() < 1e-9);
/// # Ok::<(), roverlab::world::BitGridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct LazyThetaStar {
    grid: BitGrid,
    components: GridComponents,
    field: Field,
    labels: Vec<Label>,
    query: u32,
    queue: BinaryHeap<Reverse<(u64, u32)>>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Label {
    cost: f64,
    parent: u32,
    query: u32,
    closed: u32,
}

impl LazyThetaStar {
    /// Creates a planner for a grid.
    pub fn new(grid: &BitGrid) -> Self {
        Self {
            grid: grid.clone(),
            components: GridComponents::new(grid),
            field: Field::new(grid),
            labels: vec![Label::default(); grid.width() * grid.height()],
            query: 0,
            queue: BinaryHeap::new(),
        }
    }

    fn begin(&mut self) {
        if self.query == u32::MAX {
            self.labels.fill(Label::default());
            self.query = 0;
        }
        self.query += 1;
        self.queue.clear();
    }

    fn search(&mut self, start: GridCell, goal: GridCell) -> SearchStatistics {
        let mut statistics = SearchStatistics { expanded: 0, generated: 1 };
        self.begin();
        let (first, last) = (self.index(start), self.index(goal));
        self.labels[first as usize] = Label { cost: 0.0, parent: first, query: self.query, closed: 0 };
        self.queue.push(Reverse((0, first)));
        while let Some(Reverse((_, node))) = self.queue.pop() {
            if self.labels[node as usize].closed == self.query {
                continue;
            }
            self.settle(node);
            statistics.expanded += 1;
            if node == last {
                break;
            }
            let Label { cost: _, parent, .. } = self.labels[node as usize];
            let start_cost = self.labels[parent as usize].cost;
            for next in neighbours(&self.grid, self.cell(node)).into_iter().flatten() {
                let index = self.index(next);
                let label = self.labels[index as usize];
                let cost = start_cost + self.distance(parent, index);
                let fresh = label.query != self.query;
                if label.closed == self.query || (!fresh && label.cost <= cost) {
                    continue;
                }
                self.labels[index as usize] = Label { cost, parent, query: self.query, closed: 0 };
                statistics.generated += 1;
                // The bit patterns of non-negative numbers have the same order as the numbers.
                self.queue.push(Reverse(((cost + self.distance(index, last)).to_bits(), index)));
            }
        }
        statistics
    }

    /// Settles a cell. If its parent is not in sight, the best settled neighbour becomes its parent.
    fn settle(&mut self, node: u32) {
        let parent = self.labels[node as usize].parent;
        let point = |index| HalfPoint::centre(self.cell(index));
        if !in_sight(&self.field, point(parent), point(node)) {
            let mut best = (f64::INFINITY, parent);
            for next in neighbours(&self.grid, self.cell(node)).into_iter().flatten() {
                let index = self.index(next);
                let label = self.labels[index as usize];
                let cost = label.cost + self.distance(index, node);
                if label.closed == self.query && cost < best.0 {
                    best = (cost, index);
                }
            }
            let label = &mut self.labels[node as usize];
            (label.cost, label.parent) = best;
        }
        self.labels[node as usize].closed = self.query;
    }

    fn index(&self, cell: GridCell) -> u32 {
        (cell.row * self.grid.width() + cell.column) as u32
    }

    fn cell(&self, index: u32) -> GridCell {
        GridCell::new(index as usize % self.grid.width(), index as usize / self.grid.width())
    }

    fn distance(&self, a: u32, b: u32) -> f64 {
        (self.cell(a).centre() - self.cell(b).centre()).norm()
    }
}

/// The cells one step away, along an edge or along a diagonal with both side cells free.
fn neighbours(grid: &BitGrid, cell: GridCell) -> [Option<GridCell>; 8] {
    let at = |dx: isize, dy: isize| {
        GridCell::new(cell.column.wrapping_add_signed(dx), cell.row.wrapping_add_signed(dy))
    };
    let steps = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];
    steps.map(|(dx, dy)| {
        let free = grid.is_free(at(dx, dy)) && grid.is_free(at(dx, 0)) && grid.is_free(at(0, dy));
        free.then(|| at(dx, dy))
    })
}

impl GridPlanner for LazyThetaStar {
    fn plan(&mut self, start: GridCell, goal: GridCell) -> Result<GridPath, PlanError> {
        check(&self.grid, &self.components, start, goal)?;
        let statistics = self.search(start, goal);
        let (first, mut node) = (self.index(start), self.index(goal));
        let mut points: Vec<Point> = vec![goal.centre()];
        while node != first {
            node = self.labels[node as usize].parent;
            points.push(self.cell(node).centre());
        }
        points.reverse();
        Ok(GridPath::along(points, statistics))
    }
}
