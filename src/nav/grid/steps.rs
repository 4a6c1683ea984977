use crate::world::{BitGrid, GridCell};

use super::components::GridComponents;
use super::cost::{self, StepCosts, UniformCost};
use super::path::{GridPath, GridPlanner, PlanError, SearchStatistics, check};
use super::queue::BucketQueue;

/// Dijkstra's algorithm and A\* on a grid, from cell to cell: steps along edges and along diagonals with both
/// side cells free, so that no corner is cut (book, section 10.6). Steps cost
/// their length, or what [`StepCosts`] say.
///
/// A\* uses the octile distance as its lower bound. The cells are their own graph; the search state is one
/// integer per cell, which includes the query it belongs to, so that a new query need not clear it.
///
/// E. W. Dijkstra, *A Note on Two Problems in Connexion with Graphs*, Numerische Mathematik 1, 1959; P. E.
/// Hart, N. J. Nilsson, B. Raphael, *A Formal Basis for the Heuristic Determination of Minimum Cost Paths*,
/// IEEE Trans. Systems Science and Cybernetics 4(2), 1968. Time is proportional to the number of cells
/// visited; 8 bytes per cell.
///
/// ```
/// use roverlab::nav::grid::{GridPlanner, GridSearch};
/// use roverlab::world::{BitGrid, GridCell};
/// let grid = BitGrid::from_text("....\n.##.\n....")?;
/// let mut planner = GridSearch::astar(&grid);
/// let path = planner.plan(GridCell::new(0, 1), GridCell::new(3, 1)).unwrap();
/// // Around the blocked cells, not across their corners.
/// assert_eq!(path.cost, 5.0);
/// # Ok::<(), roverlab::world::BitGridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct GridSearch<C = UniformCost> {
    costs: C,
    grid: BitGrid,
    components: GridComponents,
    informed: bool,
    /// Cells and a blocked border around them.
    stride: usize,
    free: Vec<u64>,
    labels: Vec<Label>,
    query: u64,
    queue: BucketQueue,
}

/// A cell taken off the queue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridStep {
    /// The cell.
    pub cell: GridCell,
    /// Cost of the path to it (cells).
    pub cost: f64,
    /// Lower bound of the rest (cells); 0 in Dijkstra's algorithm.
    pub estimate: f64,
}

/// Search state of a cell: query (16 bits), step that led to it (3), cost so far (45).
#[derive(Debug, Clone, Copy, Default)]
struct Label(u64);

impl Label {
    /// Bits of the cost.
    const COST: u64 = (1 << 45) - 1;

    fn new(query: u64, direction: usize, cost: u64) -> Self {
        Self(query << 48 | (direction as u64) << 45 | cost)
    }

    fn cost(self) -> u64 {
        self.0 & Self::COST
    }

    fn direction(self) -> usize {
        (self.0 >> 45 & 7) as usize
    }

    fn is_of(self, query: u64) -> bool {
        self.0 >> 48 == query
    }
}

/// Columns of the steps: east, south, west, north, and the diagonals after each of them, clockwise.
const COLUMNS: [isize; 8] = [1, 0, -1, 0, 1, -1, -1, 1];
/// Rows of the same steps.
const ROWS: [isize; 8] = [0, 1, 0, -1, 1, 1, -1, -1];

impl GridSearch {
    /// Dijkstra's algorithm, which ends as soon as the goal is settled.
    pub fn dijkstra(grid: &BitGrid) -> Self {
        Self::new(grid, UniformCost, false)
    }

    /// A\*.
    pub fn astar(grid: &BitGrid) -> Self {
        Self::new(grid, UniformCost, true)
    }
}

impl<C: StepCosts> GridSearch<C> {
    /// Dijkstra's algorithm by what steps cost.
    pub fn dijkstra_by(grid: &BitGrid, costs: C) -> Self {
        Self::new(grid, costs, false)
    }

    /// A\* by what steps cost.
    pub fn astar_by(grid: &BitGrid, costs: C) -> Self {
        Self::new(grid, costs, true)
    }

    fn new(grid: &BitGrid, costs: C, informed: bool) -> Self {
        let stride = grid.width() + 2;
        let cells = stride * (grid.height() + 2);
        let mut free = vec![0; cells.div_ceil(64) + 1];
        for cell in grid.free_cells() {
            let index = (cell.row + 1) * stride + cell.column + 1;
            free[index / 64] |= 1 << (index % 64);
        }
        Self {
            costs,
            grid: grid.clone(),
            components: GridComponents::new(grid),
            informed,
            stride,
            free,
            labels: vec![Label::default(); cells],
            query: 0,
            queue: BucketQueue::default(),
        }
    }

    /// Like [`GridPlanner::plan`], and calls back with each cell taken off the queue.
    ///
    /// # Errors
    ///
    /// As [`GridPlanner::plan`].
    pub fn plan_traced(
        &mut self,
        start: GridCell,
        goal: GridCell,
        mut trace: impl FnMut(GridStep),
    ) -> Result<GridPath, PlanError> {
        check(&self.grid, &self.components, start, goal)?;
        self.query += 1;
        if self.query >> 16 != 0 {
            self.labels.fill(Label::default());
            self.query = 1;
        }
        let statistics = self.search(self.index(start), self.index(goal), &mut trace);
        let cells = self.cells_back(self.index(start), self.index(goal));
        let mut path = GridPath::through(&cells, statistics);
        if !C::UNIFORM {
            path.cost = cost::in_cells(self.labels[self.index(goal)].cost());
        }
        Ok(path)
    }

    fn search(&mut self, start: usize, goal: usize, trace: &mut impl FnMut(GridStep)) -> SearchStatistics {
        let mut statistics = SearchStatistics { expanded: 0, generated: 1 };
        let stride = self.stride;
        let offsets: [isize; 8] = std::array::from_fn(|i| ROWS[i] * stride as isize + COLUMNS[i]);
        let (goal_x, goal_y) = (goal % stride, goal / stride);
        let informed = self.informed;
        let estimate = |x: usize, y: usize| {
            if informed { cost::octile(x.abs_diff(goal_x) as u32, y.abs_diff(goal_y) as u32) } else { 0 }
        };
        self.labels[start] = Label::new(self.query, 0, 0);
        let first = estimate(start % stride, start / stride);
        self.queue.start(first);
        self.queue.push(first, start as u32, 0);
        let mut best = u64::MAX;
        while let Some((node, cost)) = self.queue.pop_below(best) {
            let node = node as usize;
            let (x, y) = (node % stride, node / stride);
            if self.labels[node].cost() != cost || cost + estimate(x, y) >= best {
                continue;
            }
            statistics.expanded += 1;
            trace(self.step(x, y, cost, estimate(x, y)));
            let (straight, diagonal) = self.steps(node);
            for i in 0..8 {
                if (straight | diagonal << 4) >> i & 1 == 0 {
                    continue;
                }
                let next = node.wrapping_add_signed(offsets[i]);
                let ends =
                    || (cell(x, y), cell(x.wrapping_add_signed(COLUMNS[i]), y.wrapping_add_signed(ROWS[i])));
                let total = cost + cost::of_step(&self.costs, i >= 4, ends);
                let label = self.labels[next];
                if label.is_of(self.query) && label.cost() <= total {
                    continue;
                }
                let sum = total + estimate(x.wrapping_add_signed(COLUMNS[i]), y.wrapping_add_signed(ROWS[i]));
                if sum >= best {
                    continue;
                }
                self.labels[next] = Label::new(self.query, i, total);
                if next == goal {
                    best = total;
                    continue;
                }
                statistics.generated += 1;
                self.queue.push(sum, next as u32, total);
            }
        }
        statistics
    }

    /// The straight steps from a cell as bits in the order east, south, west, north, and the diagonal ones
    /// after each.
    #[inline]
    fn steps(&self, node: usize) -> (u32, u32) {
        let (above, here, below) =
            (self.three(node - self.stride - 1), self.three(node - 1), self.three(node + self.stride - 1));
        let straight = here >> 2 & 1 | below & 2 | (here & 1) << 2 | (above & 2) << 2;
        let corners = below >> 2 & 1 | (below & 1) << 1 | (above & 1) << 2 | (above & 4) << 1;
        let turned = straight >> 1 | (straight & 1) << 3;
        (straight, corners & straight & turned)
    }

    /// Three bits of the free cells starting at an index.
    #[inline]
    fn three(&self, index: usize) -> u32 {
        let (word, bit) = (index / 64, index % 64);
        let wide = u128::from(self.free[word]) | u128::from(self.free[word + 1]) << 64;
        (wide >> bit) as u32 & 7
    }

    fn step(&self, x: usize, y: usize, cost: u64, estimate: u64) -> GridStep {
        let cell = cell(x, y);
        debug_assert!(self.grid.is_free(cell));
        GridStep { cell, cost: cost::in_cells(cost), estimate: cost::in_cells(estimate) }
    }

    fn index(&self, cell: GridCell) -> usize {
        (cell.row + 1) * self.stride + cell.column + 1
    }

    /// The cells of the path, traced back from the goal.
    fn cells_back(&self, start: usize, goal: usize) -> Vec<GridCell> {
        let (mut cells, mut at) = (Vec::new(), goal);
        loop {
            cells.push(cell(at % self.stride, at / self.stride));
            if at == start {
                break;
            }
            let direction = self.labels[at].direction();
            at = at.wrapping_add_signed(-(ROWS[direction] * self.stride as isize + COLUMNS[direction]));
        }
        cells.reverse();
        cells
    }
}

/// The cell at coordinates that count the border.
fn cell(x: usize, y: usize) -> GridCell {
    GridCell::new(x - 1, y - 1)
}

impl<C: StepCosts> GridPlanner for GridSearch<C> {
    fn plan(&mut self, start: GridCell, goal: GridCell) -> Result<GridPath, PlanError> {
        self.plan_traced(start, goal, |_| {})
    }
}
