use super::chart::Chart;
use super::parameters::NavigatorParameters;
use crate::geometry::Point;
use crate::nav::grid::DStarLite;
use crate::world::{BitGrid, GridCell};

/// A plan at one level of clearance, updated as obstacles are seen.
#[derive(Debug, Clone)]
pub(super) struct Route {
    pub(super) level: usize,
    planner: DStarLite,
    /// The robot's cell when the path was planned, or the nearest free one.
    cell: GridCell,
    /// Centres of the path's cells, and the place to drive to.
    path: Vec<Point>,
    place: Point,
    length: f64,
}

/// Maximum distance to the nearest free cell from a robot or a goal in an occupied one (m).
const REACH: f64 = 0.12;
/// Fraction of the goal's tolerance that is used where the robot has no room at the goal.
const USED_TOLERANCE: f64 = 0.9;

impl Route {
    /// A plan at a level; `None` if no way exists.
    pub(super) fn new(
        chart: &Chart,
        level: usize,
        robot: Point,
        goal: Point,
        parameters: &NavigatorParameters,
    ) -> Option<Self> {
        let grid = chart.grid(level);
        let from = nearest_free(chart, &grid, robot)?;
        let (to, place) = end_of_path(chart, &grid, goal, parameters)?;
        let planner = DStarLite::new(&grid, from, to).ok()?;
        let mut route = Self { level, planner, cell: from, path: Vec::new(), place, length: 0.0 };
        route.plan(chart).then_some(route)
    }

    /// Updates the robot's position. `false` if no way is left.
    pub(super) fn follow(&mut self, chart: &Chart, robot: Point) -> bool {
        let Some(cell) = nearest_free(chart, self.planner.grid(), robot) else { return false };
        if cell == self.cell {
            return true;
        }
        self.cell = cell;
        self.planner.move_to(cell).is_ok() && self.plan(chart)
    }

    /// Adds cells with obstacles. `None` if no way is left, otherwise whether the plan has changed.
    pub(super) fn block(&mut self, chart: &Chart, marks: &[GridCell], robot: Point) -> Option<bool> {
        let mut changed = false;
        for &mark in marks {
            chart.around(mark, self.level, |cell| {
                changed |= self.planner.grid().is_free(cell);
                self.planner.set_free(cell, false);
            });
        }
        if !changed {
            return Some(false);
        }
        let before = self.length;
        self.cell = nearest_free(chart, self.planner.grid(), robot)?;
        let found = self.planner.move_to(self.cell).is_ok() && self.plan(chart);
        // The robot has moved on, so a path of equal length means a detour.
        found.then_some(self.length > before)
    }

    fn plan(&mut self, chart: &Chart) -> bool {
        let Ok(path) = self.planner.plan() else { return false };
        self.path.clear();
        self.path.extend(
            path.points.iter().filter_map(|&point| GridCell::at(point)).map(|cell| chart.centre(cell)),
        );
        self.path.push(self.place);
        self.length = path.cost * chart.resolution();
        true
    }

    /// Length of the path to the goal, along the edges and diagonals of cells (m).
    pub(super) fn length(&self) -> f64 {
        self.length
    }

    /// Points of the path, from the robot's cell to the goal.
    pub(super) fn path(&self) -> &[Point] {
        &self.path
    }

    /// The farthest path point within `far` metres that a straight way leads to.
    pub(super) fn target(&self, chart: &Chart, robot: Point, far: f64) -> Point {
        let grid = self.planner.grid();
        let is_free = chart.cell(robot).is_some_and(|cell| grid.is_free(cell));
        // A robot too near to something returns to the path by its next few cells.
        let reach = if is_free { far } else { 4.0 * chart.resolution() };
        let mut best = self.path[0];
        let from = chart.in_cells(robot);
        let mut travelled = 0.0;
        for (index, &point) in self.path.iter().enumerate() {
            travelled += if index == 0 { 0.0 } else { (point - self.path[index - 1]).norm() };
            if travelled > reach {
                break;
            }
            // Robot and goal may be in cells that are not free.
            let is_last = index + 1 == self.path.len();
            if !is_free || is_last && index < 2 || is_line_free(grid, from, chart.in_cells(point)) {
                best = point;
            }
        }
        best
    }
}

/// The cell to plan to, and the place to drive to: the goal, or the nearest place within its tolerance where
/// the robot has room.
fn end_of_path(
    chart: &Chart,
    grid: &BitGrid,
    goal: Point,
    parameters: &NavigatorParameters,
) -> Option<(GridCell, Point)> {
    let cell = nearest_free(chart, grid, goal)?;
    if chart.has_room(goal, parameters.radius()) {
        return Some((cell, goal));
    }
    let place = chart.centre(cell);
    ((place - goal).norm() <= USED_TOLERANCE * parameters.goal_tolerance).then_some((cell, place))
}

/// The free cell nearest to a point, if one is near.
fn nearest_free(chart: &Chart, grid: &BitGrid, point: Point) -> Option<GridCell> {
    let at = chart.cell(point)?;
    if grid.is_free(at) {
        return Some(at);
    }
    let reach = (REACH / chart.resolution()).ceil() as usize;
    let (columns, rows) =
        (at.column.saturating_sub(reach)..=at.column + reach, at.row.saturating_sub(reach)..=at.row + reach);
    let cells = rows.flat_map(|row| columns.clone().map(move |column| GridCell::new(column, row)));
    let away = |cell: &GridCell| (chart.centre(*cell) - point).norm_squared();
    cells.filter(|&cell| grid.is_free(cell)).min_by(|a, b| away(a).total_cmp(&away(b)))
}

/// Whether all cells met by a line, given in units of cells, are free.
fn is_line_free(grid: &BitGrid, a: Point, b: Point) -> bool {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    // Row by row: the columns between the line's entry and its exit.
    let (low, high) = (a.y.min(b.y).floor(), a.y.max(b.y).floor());
    let mut row = low;
    while row <= high {
        let at = |y: f64| if dy == 0.0 { a.x } else { a.x + dx * ((y - a.y) / dy).clamp(0.0, 1.0) };
        let (from, to) = if dy == 0.0 { (a.x, b.x) } else { (at(row), at(row + 1.0)) };
        let (from, to) = (from.min(to), from.max(to));
        let mut column = (from - 1e-9).floor();
        while column <= (to + 1e-9).floor() {
            if column < 0.0 || row < 0.0 || !grid.is_free(GridCell::new(column as usize, row as usize)) {
                return false;
            }
            column += 1.0;
        }
        row += 1.0;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// Points on a free line lie in free cells; a line that is not free has a point that does not, or
        /// nearly so.
        #[test]
        fn lines_are_free_if_their_cells_are(seed in any::<u64>()) {
            let mut stream = Stream::new(seed);
            let grid = BitGrid::from_fn(20, 20, |_, _| stream.chance(0.9)).unwrap();
            let mut place = || Point::new(stream.between(0.0, 20.0), stream.between(0.0, 20.0));
            let (a, b) = (place(), place());
            let all = |slack: f64| (0..=4000).all(|i| {
                let point = a + (b - a) * (f64::from(i) / 4000.0);
                [(-slack, -slack), (slack, -slack), (-slack, slack), (slack, slack)].iter().all(|(x, y)| {
                    GridCell::at(Point::new(point.x + x, point.y + y)).is_some_and(|cell| grid.is_free(cell))
                })
            });
            if is_line_free(&grid, a, b) {
                prop_assert!(all(0.0));
            } else {
                prop_assert!(!all(0.01));
            }
        }
    }
}
