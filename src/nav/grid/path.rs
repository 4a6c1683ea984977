use crate::geometry::{Point, way_length};
use crate::parameter::debug_as_sentence;
use crate::world::{BitGrid, GridCell};

use super::components::GridComponents;
use super::cost;

/// A path through a grid, with statistics of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct GridPath {
    /// Centre of the start cell, turning points or steps of the path, and centre of the goal cell, in cells:
    /// the centre of column c and row r is (c + 0.5, r + 0.5).
    pub points: Vec<Point>,
    /// Length (cells).
    pub cost: f64,
    /// Statistics of the search.
    pub statistics: SearchStatistics,
}

/// Statistics of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SearchStatistics {
    /// Number of nodes expanded.
    pub expanded: usize,
    /// Number of nodes put on the queue, including repetitions.
    pub generated: usize,
}

/// Reason for the lack of a path.
#[derive(Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The grid has no cells.
    #[error("the map is empty; expected at least one cell")]
    EmptyMap,
    /// The start or the goal is outside the map.
    #[error("the {end} {cell} lies outside of the map of {width} x {height} cells")]
    Outside {
        /// Which end of the path.
        end: End,
        /// Its cell.
        cell: GridCell,
        /// Number of columns of the map.
        width: usize,
        /// Number of rows of the map.
        height: usize,
    },
    /// The start or the goal is blocked.
    #[error("the {end} {cell} is blocked; expected a free cell")]
    Blocked {
        /// Which end of the path.
        end: End,
        /// Its cell.
        cell: GridCell,
    },
    /// No path leads from the start to the goal.
    #[error("no way leads from {start} to {goal}")]
    Unreachable {
        /// Start of the query.
        start: GridCell,
        /// Goal of the query.
        goal: GridCell,
    },
}

debug_as_sentence!(PlanError);

/// An end of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The start.
    Start,
    /// The goal.
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

/// A planner of paths through a grid, between the centres of cells.
///
/// # For implementers
///
/// Return a path from `start` to `goal` that touches no blocked cell, or an error; the module `testing`
/// has checks for it. A planner is used for many queries.
pub trait GridPlanner {
    /// Finds a path. Fails if an end is outside the map or blocked, or no path exists.
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
    /// The octile path through turning cells, between which it goes diagonally first, then straight.
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
        let cost = way_length(&points);
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

/// Rejects queries that need no search.
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
