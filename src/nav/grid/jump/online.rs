use super::planes::{Landing, Planes};
use super::search::{Arrival, Jumps, Search};
use crate::nav::grid::components::GridComponents;
use crate::nav::grid::path::{GridPath, GridPlanner, PlanError, check};
use crate::world::{BitGrid, GridCell};

/// Jump point search: the shortest octile paths, found by jumping from one end of a wall to the next.
///
/// Rows and columns are scanned 64 cells at a time on bits that mark where a scan ends; preparing them takes
/// a few operations per 64 cells. Intermediate cells of a diagonal are not nodes.
///
/// D. Harabor, A. Grastien, *Improving Jump Point Search*, ICAPS 2014 (block-based scanning, pruning of
/// intermediate jump points; here with the rule that no corner is cut). Memory: 6 bits per cell, plus 24
/// bytes per cell touched by a search.
///
/// ```
/// use roverlab::nav::grid::{GridPlanner, JumpPointSearch};
/// use roverlab::world::{BitGrid, GridCell};
/// let grid = BitGrid::from_text("....\n.##.\n....")?;
/// let mut planner = JumpPointSearch::new(&grid);
/// let path = planner.plan(GridCell::new(0, 1), GridCell::new(3, 1)).unwrap();
/// assert_eq!(path.cost, 5.0);
/// # Ok::<(), roverlab::world::BitGridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct JumpPointSearch {
    grid: BitGrid,
    components: GridComponents,
    cells: Cells,
    search: Search,
}

/// Every cell is a node.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    pub(super) planes: Planes,
    stride: usize,
    count: usize,
}

impl JumpPointSearch {
    /// Creates a planner for a grid.
    pub fn new(grid: &BitGrid) -> Self {
        let (components, cells) = (GridComponents::new(grid), Cells::new(grid));
        Self { grid: grid.clone(), components, cells, search: Search::default() }
    }

    /// Ends of the last query's jumps, by path length.
    ///
    /// ```
    /// use roverlab::nav::grid::{GridPlanner, JumpPointSearch};
    /// use roverlab::world::{BitGrid, GridCell};
    /// let grid = BitGrid::from_text("....\n.#..\n....")?;
    /// let mut planner = JumpPointSearch::new(&grid);
    /// planner.plan(GridCell::new(0, 1), GridCell::new(3, 1)).unwrap();
    /// assert!(planner.landings().iter().all(|&cell| grid.is_free(cell)));
    /// # Ok::<(), roverlab::world::BitGridError>(())
    /// ```
    pub fn landings(&self) -> Vec<GridCell> {
        self.search.landings()
    }

    /// Makes a cell free or blocked. Time is proportional to the width and height of the grid and the number
    /// of runs of free cells. Ignores cells outside the grid.
    pub fn set_free(&mut self, cell: GridCell, free: bool) {
        if self.grid.contains(cell) && self.grid.is_free(cell) != free {
            self.grid.set_free(cell, free);
            self.cells.planes.set_free(cell, free);
            self.components = GridComponents::new(&self.grid);
        }
    }
}

impl Cells {
    pub(super) fn new(grid: &BitGrid) -> Self {
        let stride = grid.width() + 2;
        Self { planes: Planes::new(grid), stride, count: stride * (grid.height() + 2) }
    }

    #[inline]
    fn arrival(&self, at: Landing) -> Arrival {
        Arrival { node: (at.y * self.stride + at.x) as u32, at }
    }
}

impl Jumps for Cells {
    fn count(&self) -> usize {
        self.count
    }

    fn leave_start(&self, x: usize, y: usize, mut land: impl FnMut(Arrival)) {
        self.planes.jumps(x, y, u8::MAX, |at| land(self.arrival(at)));
    }

    #[inline]
    fn leave_node(&self, _: u32, at: Landing, mut land: impl FnMut(Arrival)) {
        self.planes.jumps(at.x, at.y, self.planes.onward(at), |at| land(self.arrival(at)));
    }
}

impl GridPlanner for JumpPointSearch {
    fn plan(&mut self, start: GridCell, goal: GridCell) -> Result<GridPath, PlanError> {
        check(&self.grid, &self.components, start, goal)?;
        let (turns, statistics) = self.search.run(&self.cells.planes, &self.cells, start, goal);
        Ok(GridPath::through(&turns, statistics))
    }
}
