use super::lines::{between_walls, entered, squeezed};
use crate::geometry::units::NEGLIGIBLE;
use crate::geometry::way_length;
use crate::nav::grid::{AnyAngle, GridPath, GridPlanner, GridSearch, PlanError};
use crate::parameter::debug_as_sentence;
use crate::world::{BitGrid, GridCell};

/// Which paths count as shortest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Movement {
    /// Steps along edges, and along diagonals whose two side cells are free.
    Octile,
    /// Straight lines in any direction, which may touch corners.
    AnyAngle,
}

/// A mistake of a planner.
#[derive(Clone, PartialEq, thiserror::Error)]
#[error("from {start} to {goal}: {what}")]
pub struct Violation {
    /// Start of the query.
    pub start: GridCell,
    /// Goal of the query.
    pub goal: GridCell,
    /// What was found, and what was expected.
    pub what: String,
}

debug_as_sentence!(Violation);

/// Whether two costs are equal; false for NaN.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= NEGLIGIBLE
}

fn violation(start: GridCell, goal: GridCell, what: String) -> Violation {
    Violation { start, goal, what }
}

/// Checks that the planner's cost is that of the shortest path. Queries without an answer pass.
///
/// The ground truth is Dijkstra's algorithm, or this library's any-angle planner.
///
/// # Errors
///
/// If the costs differ.
pub fn optimal(
    planner: &mut impl GridPlanner,
    grid: &BitGrid,
    movement: Movement,
    start: GridCell,
    goal: GridCell,
) -> Result<(), Violation> {
    let truth = match movement {
        Movement::Octile => GridSearch::dijkstra(grid).plan(start, goal),
        Movement::AnyAngle => AnyAngle::new(grid).plan(start, goal),
    };
    match (planner.plan(start, goal), truth) {
        (Ok(path), Ok(best)) if !same(path.cost, best.cost) => {
            let what = format!("a path of {} cells was found; the shortest has {}", path.cost, best.cost);
            Err(violation(start, goal, what))
        }
        _ => Ok(()),
    }
}

/// Checks that the planner's path leads from start to goal along straight lines, has the stated length, and
/// enters no blocked cell. It may run along blocked cells and touch corners, but not pass between two blocked
/// cells that are adjacent or touch at a corner. Queries without an answer pass.
///
/// # Errors
///
/// If the path violates one of these rules.
pub fn collision_free(
    planner: &mut impl GridPlanner,
    grid: &BitGrid,
    start: GridCell,
    goal: GridCell,
) -> Result<(), Violation> {
    let Ok(path) = planner.plan(start, goal) else { return Ok(()) };
    let ends = (path.points.first().copied(), path.points.last().copied());
    if ends != (Some(start.centre()), Some(goal.centre())) {
        return Err(violation(
            start,
            goal,
            format!("a path with the ends {ends:?}; expected the middles of both cells"),
        ));
    }
    for pair in path.points.windows(2) {
        if let Some(cell) = entered(grid, pair[0], pair[1]) {
            let what = format!("the way from {} to {} enters the blocked cell {cell}", pair[0], pair[1]);
            return Err(violation(start, goal, what));
        }
        if between_walls(grid, pair[0], pair[1]) {
            let what = format!("the way from {} to {} runs between blocked cells", pair[0], pair[1]);
            return Err(violation(start, goal, what));
        }
    }
    if let Some(corner) = squeezed(grid, &path.points) {
        let what = format!("the way squeezes between the blocked cells that touch at {corner}");
        return Err(violation(start, goal, what));
    }
    let length = way_length(&path.points);
    if !same(length, path.cost) {
        return Err(violation(start, goal, format!("a cost of {} for a path of {length} cells", path.cost)));
    }
    Ok(())
}

/// Checks that the planner finds a path exactly if there is one.
///
/// # Errors
///
/// If it does not.
pub fn complete(
    planner: &mut impl GridPlanner,
    grid: &BitGrid,
    start: GridCell,
    goal: GridCell,
) -> Result<(), Violation> {
    let there_is_one = GridSearch::dijkstra(grid).plan(start, goal).is_ok();
    match planner.plan(start, goal) {
        Ok(_) if !there_is_one => Err(violation(start, goal, "a path was found; there is none".into())),
        Err(error) if there_is_one => Err(violation(start, goal, format!("no path ({error}); there is one"))),
        _ => Ok(()),
    }
}

/// Checks that the path between two cells is no longer than a detour by a third; true for every optimal
/// planner. Queries without an answer pass.
///
/// # Errors
///
/// If the detour is shorter.
pub fn triangle_inequality(
    planner: &mut impl GridPlanner,
    start: GridCell,
    by: GridCell,
    goal: GridCell,
) -> Result<(), Violation> {
    let mut cost = |from, to| planner.plan(from, to).map(|path| path.cost);
    let (Ok(direct), Ok(first), Ok(second)) = (cost(start, goal), cost(start, by), cost(by, goal)) else {
        return Ok(());
    };
    let is_no_longer = direct <= first + second + NEGLIGIBLE;
    if !is_no_longer {
        let what = format!("a path of {direct} cells; by {by} there is one of {}", first + second);
        return Err(violation(start, goal, what));
    }
    Ok(())
}

/// A planner made from a closure.
///
/// ```
/// use roverlab::nav::grid::{GridPath, PlanError};
/// use roverlab::testing::{PlanWith, collision_free};
/// use roverlab::world::{BitGrid, GridCell};
/// // A planner that drives straight on, ignoring all obstacles.
/// let mut straight = PlanWith(|start: GridCell, goal: GridCell| -> Result<GridPath, PlanError> {
///     let points = vec![start.centre(), goal.centre()];
///     Ok(GridPath { cost: (points[1] - points[0]).norm(), points, statistics: Default::default() })
/// });
/// let grid = BitGrid::from_text("...\n.@.\n...")?;
/// let (west, east) = (GridCell::new(0, 1), GridCell::new(2, 1));
/// let violation = collision_free(&mut straight, &grid, west, east).unwrap_err();
/// assert_eq!((violation.start, violation.goal), (west, east));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct PlanWith<F>(pub F);

impl<F: FnMut(GridCell, GridCell) -> Result<GridPath, PlanError>> GridPlanner for PlanWith<F> {
    fn plan(&mut self, start: GridCell, goal: GridCell) -> Result<GridPath, PlanError> {
        self.0(start, goal)
    }
}
