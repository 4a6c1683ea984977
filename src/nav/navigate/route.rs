use super::chart::{Chart, LEVELS, is_line_of};
use super::destination::{Destination, REACH, nearest_free};
use super::parameters::NavigatorParameters;
use crate::geometry::Point;
use crate::nav::grid::DStarLite;
use crate::world::GridCell;

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
    /// Whether that place is beside the path's cells, as it has less room than they have.
    is_beside: bool,
    length: f64,
}

impl Route {
    /// A plan at a level; `None` if no way exists.
    pub(super) fn new(
        chart: &Chart,
        level: usize,
        robot: Point,
        destination: &Destination,
        parameters: &NavigatorParameters,
    ) -> Option<Self> {
        let grid = chart.grid(level);
        let from = nearest_free(chart, &grid, robot)?;
        let (to, place) = destination.in_reach_of(chart, &grid, from, parameters)?;
        let planner = DStarLite::new(&grid, from, to).ok()?;
        let is_beside = chart.cell(place) != Some(to);
        let mut route = Self { level, planner, cell: from, path: Vec::new(), place, is_beside, length: 0.0 };
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

    /// The place in which the path ends.
    pub(super) fn place(&self) -> Point {
        self.place
    }

    /// Free space beside the outline on the way to a point of the path (m).
    pub(super) fn clearance_to(&self, chart: &Chart, target: Point) -> f64 {
        let is_least = self.is_beside && target == self.place;
        chart.clearance(if is_least { LEVELS - 1 } else { self.level })
    }

    /// Whether a robot near a place beside the path's cells may leave them for it.
    fn leads_straight(&self, chart: &Chart, robot: Point) -> bool {
        self.is_beside && (self.place - robot).norm() <= REACH && chart.is_straight_way(robot, self.place)
    }

    /// The farthest path point within `far` metres that a straight way leads to.
    pub(super) fn target(&self, chart: &Chart, robot: Point, far: f64) -> Point {
        if self.leads_straight(chart, robot) {
            return self.place;
        }
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
            let is_open = |cell| grid.is_free(cell);
            if !is_free || is_last && index < 2 || is_line_of(from, chart.in_cells(point), is_open) {
                best = point;
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use crate::world::BitGrid;
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
            if is_line_of(a, b, |cell| grid.is_free(cell)) {
                prop_assert!(all(0.0));
            } else {
                prop_assert!(!all(0.01));
            }
        }
    }
}
