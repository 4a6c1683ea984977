use crate::geometry::Point;
use crate::parameter::debug_as_sentence;
use crate::world::{BitGrid, GridCell};

use super::components::GridComponents;
use super::cost;

/// A way through a grid, with what it took to find it.
#[derive(Debug, Clone, PartialEq)]
pub struct GridPath {
    /// The middle of the start's cell, the places where the path turns or steps, and the middle of the goal's cell; in
    /// cells, so that the middle of column c and row r is (c + 0.5, r + 0.5).
    pub points: Vec<Point>,
    /// The length in cells.
    pub cost: f64,
    /// What the search did.
    pub statistics: SearchStatistics,
}

/// What a search did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SearchStatistics {
    /// Nodes taken off the queue, and their successors looked at.
    pub expanded: usize,
    /// Nodes put on the queue, again included.
    pub generated: usize,
}

/// Why there is no path.
#[derive(Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The grid has no cells.
    #[error("the map is empty; expected at least one cell")]
    EmptyMap,
    /// The start or the goal lies outside.
    #[error("the {end} {cell} lies outside of the map of {width} x {height} cells")]
    Outside {
        /// Which of them.
        end: End,
        /// Where it is.
        cell: GridCell,
        /// Cells in a row of the map.
        width: usize,
        /// Rows of the map.
        height: usize,
    },
    /// The start or the goal is not free.
    #[error("the {end} {cell} is blocked; expected a free cell")]
    Blocked {
        /// Which of them.
        end: End,
        /// Where it is.
        cell: GridCell,
    },
    /// No way leads from the start to the goal.
    #[error("no way leads from {start} to {goal}")]
    Unreachable {
        /// From here.
        start: GridCell,
        /// To here.
        goal: GridCell,
    },
}

debug_as_sentence!(PlanError);

/// An end of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// Where it starts.
    Start,
    /// Where it goes.
    Goal,
}

impl std::fmt::Display for End {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Start => "start",
            Self::Goal => "goal",
        })
    }
}

/// Anything that finds paths through a grid, from the middle of one cell to that of another.
pub trait GridPlanner {
    /// Finds a path.
    fn plan(&mut self, start: GridCell, goal: GridCell) -> Result<GridPath, PlanError>;
}

impl<P: GridPlanner + ?Sized> GridPlanner for &mut P {
    fn plan(&mut self, start: GridCell, goal: GridCell) -> Result<GridPath, PlanError> {
        (**self).plan(start, goal)
    }
}

impl<P: GridPlanner + ?Sized> GridPlanner for Box<P> {
    fn plan(&mut self, start: GridCell, goal: GridCell) -> Result<GridPath, PlanError> {
        (**self).plan(start, goal)
    }
}

impl GridPath {
    /// The octile path over the cells of some turns, in between which it goes diagonally first, then straight.
    pub(super) fn through(turns: &[GridCell], statistics: SearchStatistics) -> Self {
        let mut points: Vec<Point> = turns.first().map(|cell| cell.centre()).into_iter().collect();
        let (mut straight, mut diagonal) = (0, 0);
        for pair in turns.windows(2) {
            let (mut at, to) = (pair[0], pair[1]);
            while at != to {
                let next = GridCell::new(towards(at.column, to.column), towards(at.row, to.row));
                let is_diagonal = next.column != at.column && next.row != at.row;
                (straight, diagonal) =
                    (straight + u64::from(!is_diagonal), diagonal + u64::from(is_diagonal));
                points.push(next.centre());
                at = next;
            }
        }
        Self { points, cost: cost::length(straight, diagonal), statistics }
    }

    /// The path along straight lines between points.
    pub(super) fn along(points: Vec<Point>, statistics: SearchStatistics) -> Self {
        let cost = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        Self { points, cost, statistics }
    }
}

fn towards(from: usize, to: usize) -> usize {
    match from.cmp(&to) {
        std::cmp::Ordering::Less => from + 1,
        std::cmp::Ordering::Equal => from,
        std::cmp::Ordering::Greater => from - 1,
    }
}

/// Refuses queries that need no search.
pub(super) fn check(
    grid: &BitGrid,
    components: &GridComponents,
    start: GridCell,
    goal: GridCell,
) -> Result<(), PlanError> {
    let (width, height) = (grid.width(), grid.height());
    if width == 0 || height == 0 {
        return Err(PlanError::EmptyMap);
    }
    for (end, cell) in [(End::Start, start), (End::Goal, goal)] {
        if !grid.contains(cell) {
            return Err(PlanError::Outside { end, cell, width, height });
        }
        if !grid.is_free(cell) {
            return Err(PlanError::Blocked { end, cell });
        }
    }
    if !components.connected(start, goal) {
        return Err(PlanError::Unreachable { start, goal });
    }
    Ok(())
}
