use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::components::GridComponents;
use super::cost::{StepCosts, UniformCost, in_cells, octile, of_step};
use super::path::{End, GridPath, PlanError, SearchStatistics};
use crate::world::{BitGrid, GridCell};

/// D\* Lite: the shortest octile path for a robot that discovers changes of the map on its way.
/// Steps cost their length, or what [`StepCosts`] say.
///
/// The search runs from the goal to the robot and is kept. When cells turn out to be blocked or free, only
/// what depends on them is recomputed.
///
/// S. Koenig, M. Likhachev, *D\* Lite*, AAAI 2002. Replanning takes time proportional to the number of
/// relevant cells whose distance to the goal changed, times the logarithm of the queue length; memory is 40
/// bytes per cell. [`GridComponents`] of the initial map report at once that it has no path; that a change
/// has cut off the last path is found by search.
///
/// ```
/// use roverlab::nav::grid::DStarLite;
/// use roverlab::world::{BitGrid, GridCell};
/// let grid = BitGrid::from_text("....\n....\n....")?;
/// let mut planner = DStarLite::new(&grid, GridCell::new(0, 1), GridCell::new(3, 1)).unwrap();
/// assert_eq!(planner.plan().unwrap().cost, 3.0);
/// planner.move_to(GridCell::new(1, 1)).unwrap();
/// planner.set_free(GridCell::new(2, 1), false);
/// assert_eq!(planner.plan().unwrap().cost, 4.0);
/// # Ok::<(), roverlab::world::BitGridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct DStarLite<C = UniformCost> {
    costs: C,
    grid: BitGrid,
    robot: GridCell,
    goal: GridCell,
    /// Distance to the goal as last propagated, and as implied by the neighbours.
    cells: Vec<Distances>,
    queue: BinaryHeap<Reverse<Entry>>,
    /// Growth of the keys since the beginning, caused by the robot's motion.
    shift: u64,
    searched: bool,
    statistics: SearchStatistics,
}

#[derive(Debug, Clone, Copy)]
struct Distances {
    settled: u64,
    implied: u64,
    /// Key of the cell on the queue, if it is queued.
    key: Option<Key>,
}

type Key = (u64, u64);

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Entry {
    key: Key,
    cell: u32,
}

/// Cost of unreachable cells: the sum of two does not overflow.
const FAR: u64 = u64::MAX / 4;

impl DStarLite {
    /// Creates a planner for a map, the robot's cell and the goal. The goal may be blocked now and become
    /// free later. Fails for an empty map and for cells outside it.
    pub fn new(grid: &BitGrid, robot: GridCell, goal: GridCell) -> Result<Self, PlanError> {
        Self::by(grid, UniformCost, robot, goal)
    }
}

impl<C: StepCosts> DStarLite<C> {
    /// As [`new`](DStarLite::new), by what steps cost.
    ///
    /// # Errors
    ///
    /// For an empty map, and for cells outside it.
    pub fn by(grid: &BitGrid, costs: C, robot: GridCell, goal: GridCell) -> Result<Self, PlanError> {
        if grid.width() == 0 || grid.height() == 0 {
            return Err(PlanError::EmptyMap);
        }
        let unknown = Distances { settled: FAR, implied: FAR, key: None };
        let mut this = Self {
            costs,
            cells: vec![unknown; grid.width() * grid.height()],
            grid: grid.clone(),
            robot,
            goal,
            queue: BinaryHeap::new(),
            shift: 0,
            searched: false,
            statistics: SearchStatistics::default(),
        };
        for (end, cell) in [(End::Start, robot), (End::Goal, goal)] {
            this.check_inside(end, cell)?;
        }
        let index = this.index(goal);
        this.cells[index].implied = 0;
        this.enqueue(goal);
        Ok(this)
    }

    /// The map as currently known.
    pub fn grid(&self) -> &BitGrid {
        &self.grid
    }

    /// Current step costs.
    pub fn costs(&self) -> &C {
        &self.costs
    }

    /// Sets the robot's cell. Fails for a cell outside the map.
    pub fn move_to(&mut self, robot: GridCell) -> Result<(), PlanError> {
        self.check_inside(End::Start, robot)?;
        // Queued keys are based on the old cell. They remain lower bounds once new keys grow by the distance
        // moved.
        self.shift += between(self.robot, robot);
        self.robot = robot;
        Ok(())
    }

    /// Sets a cell free or blocked. Ignores cells outside the map.
    pub fn set_free(&mut self, cell: GridCell, free: bool) {
        if !self.grid.contains(cell) || self.grid.is_free(cell) == free {
            return;
        }
        self.grid.set_free(cell, free);
        self.update_around(cell);
    }

    /// Changes the costs of the steps to and from a cell. A cell outside the map is ignored.
    pub fn set_costs(&mut self, cell: GridCell, change: impl FnOnce(&mut C)) {
        if self.grid.contains(cell) {
            change(&mut self.costs);
            self.update_around(cell);
        }
    }

    /// All steps that a cell is part of, or beside, begin and end around it.
    fn update_around(&mut self, cell: GridCell) {
        for row in cell.row.saturating_sub(1)..(cell.row + 2).min(self.grid.height()) {
            for column in cell.column.saturating_sub(1)..(cell.column + 2).min(self.grid.width()) {
                self.update(GridCell::new(column, row));
            }
        }
    }

    /// The shortest path from the robot to the goal on the known map. Its statistics are those of this call.
    /// Fails if an end is blocked or no path exists.
    pub fn plan(&mut self) -> Result<GridPath, PlanError> {
        for (end, cell) in [(End::Start, self.robot), (End::Goal, self.goal)] {
            if !self.grid.is_free(cell) {
                return Err(PlanError::Blocked { end, cell });
            }
        }
        let unreachable = PlanError::Unreachable { start: self.robot, goal: self.goal };
        if !self.searched && !GridComponents::new(&self.grid).connected(self.robot, self.goal) {
            return Err(unreachable);
        }
        self.searched = true;
        self.statistics = SearchStatistics::default();
        self.settle();
        let mut cells = vec![self.robot];
        let mut at = self.robot;
        if self.cells[self.index(at)].implied >= FAR {
            return Err(unreachable);
        }
        while at != self.goal {
            let next = self.steps(at).into_iter().flatten();
            let best = next.min_by_key(|&(cell, cost)| cost + self.cells[self.index(cell)].settled);
            let next = best.ok_or(unreachable)?.0;
            // Cells on a shortest path are settled.
            debug_assert_eq!(self.cells[self.index(next)].settled, self.cells[self.index(next)].implied);
            at = next;
            cells.push(at);
        }
        let mut path = GridPath::through(&cells, self.statistics);
        if !C::UNIFORM {
            path.cost = in_cells(self.cells[self.index(self.robot)].implied);
        }
        Ok(path)
    }

    /// Computes distances until the robot's is final.
    fn settle(&mut self) {
        while let Some(&Reverse(Entry { key, cell: index })) = self.queue.peek() {
            let cell = self.cell(index);
            let known = self.cells[index as usize];
            if known.key != Some(key) {
                self.queue.pop();
                continue;
            }
            let robot = self.cells[self.index(self.robot)];
            if key >= self.key(self.robot) && robot.implied == robot.settled {
                return;
            }
            self.queue.pop();
            self.cells[index as usize].key = None;
            self.statistics.expanded += 1;
            if key < self.key(cell) {
                self.enqueue(cell);
                continue;
            }
            let label = &mut self.cells[index as usize];
            if label.settled > label.implied {
                label.settled = label.implied;
            } else {
                label.settled = FAR;
                self.update(cell);
            }
            for (next, _) in self.steps(cell).into_iter().flatten() {
                self.update(next);
            }
        }
    }

    /// Recomputes a cell's implied distance from its neighbours, and queues the cell if it differs.
    fn update(&mut self, cell: GridCell) {
        let index = self.index(cell);
        if cell != self.goal {
            let steps = self.steps(cell).into_iter().flatten();
            let best = steps.map(|(next, cost)| cost + self.cells[self.index(next)].settled).min();
            self.cells[index].implied = best.unwrap_or(FAR).min(FAR);
        }
        self.cells[index].key = None;
        if self.cells[index].implied != self.cells[index].settled {
            self.enqueue(cell);
        }
    }

    fn enqueue(&mut self, cell: GridCell) {
        let (index, key) = (self.index(cell), self.key(cell));
        self.cells[index].key = Some(key);
        self.statistics.generated += 1;
        self.queue.push(Reverse(Entry { key, cell: index as u32 }));
    }

    fn key(&self, cell: GridCell) -> Key {
        let Distances { settled, implied, .. } = self.cells[self.index(cell)];
        let distance = settled.min(implied);
        (distance + between(self.robot, cell) + self.shift, distance)
    }

    /// The cells one step away, and the step's length.
    fn steps(&self, cell: GridCell) -> [Option<(GridCell, u64)>; 8] {
        let at = |dx: isize, dy: isize| {
            GridCell::new(cell.column.wrapping_add_signed(dx), cell.row.wrapping_add_signed(dy))
        };
        let free = |dx, dy| self.grid.is_free(at(dx, dy));
        let steps = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];
        steps.map(|(dx, dy)| {
            let open = free(0, 0) && free(dx, dy) && free(dx, 0) && free(0, dy);
            let cost = || of_step(&self.costs, dx != 0 && dy != 0, || (cell, at(dx, dy)));
            open.then(|| (at(dx, dy), cost()))
        })
    }

    fn check_inside(&self, end: End, cell: GridCell) -> Result<(), PlanError> {
        let (width, height) = (self.grid.width(), self.grid.height());
        if self.grid.contains(cell) { Ok(()) } else { Err(PlanError::Outside { end, cell, width, height }) }
    }

    fn index(&self, cell: GridCell) -> usize {
        cell.row * self.grid.width() + cell.column
    }

    fn cell(&self, index: u32) -> GridCell {
        GridCell::new(index as usize % self.grid.width(), index as usize / self.grid.width())
    }
}

fn between(a: GridCell, b: GridCell) -> u64 {
    octile(a.column.abs_diff(b.column) as u32, a.row.abs_diff(b.row) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nav::grid::{GridPlanner, GridSearch};
    use crate::random::Stream;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(150))]

        /// After every move and every change the path agrees with A*.
        #[test]
        fn plans_are_those_of_a_star(width in 2..25usize, height in 2..25usize, share in 0.5..0.95f64, seed in any::<u64>()) {
            let mut stream = Stream::new(seed);
            let mut grid = BitGrid::from_fn(width, height, |_, _| stream.chance(share)).unwrap();
            let any = |stream: &mut Stream| GridCell::new(stream.below(width), stream.below(height));
            let (mut robot, goal) = (any(&mut stream), any(&mut stream));
            grid.set_free(robot, true);
            let mut planner = DStarLite::new(&grid, robot, goal).unwrap();
            for _ in 0..25 {
                let expected = GridSearch::astar(&grid).plan(robot, goal);
                let found = planner.plan();
                if let (Ok(expected), Ok(found)) = (&expected, &found) {
                    prop_assert!((expected.cost - found.cost).abs() < 1e-9, "{} for {}", found.cost, expected.cost);
                } else {
                    prop_assert_eq!(expected.as_ref().err(), found.as_ref().err());
                }
                // One step, several steps, or to any free cell.
                let ahead = 1 + stream.below(5);
                let next = found.ok().and_then(|path| path.points.get(ahead).copied());
                let next = next.and_then(GridCell::at).unwrap_or_else(|| any(&mut stream));
                let next = if stream.chance(0.2) { any(&mut stream) } else { next };
                if grid.is_free(next) {
                    robot = next;
                    planner.move_to(robot).unwrap();
                }
                for _ in 0..stream.below(4) {
                    let (cell, free) = (any(&mut stream), stream.chance(share));
                    if cell != robot {
                        grid.set_free(cell, free);
                        planner.set_free(cell, free);
                    }
                }
            }
        }
    }

    #[test]
    fn a_small_change_takes_a_small_search() {
        // A wall with a gap at its far end, which the first search has to find.
        let grid = BitGrid::from_fn(100, 100, |x, y| x != 50 || y < 4).unwrap();
        let mut planner = DStarLite::new(&grid, GridCell::new(0, 50), GridCell::new(99, 50)).unwrap();
        let path = planner.plan().unwrap();
        let first = path.statistics.expanded;
        planner.move_to(GridCell::at(path.points[10]).unwrap()).unwrap();
        planner.set_free(GridCell::at(path.points[12]).unwrap(), false);
        let second = planner.plan().unwrap().statistics.expanded;
        assert!(second > 0 && 3 * second < first, "{second} after {first}");
    }

    /// The first plan uses the regions of the map, so it does not search all of the goal's region.
    #[test]
    fn no_way_is_told_at_once() {
        let grid = BitGrid::from_fn(100, 100, |x, _| x != 50).unwrap();
        let (robot, goal) = (GridCell::new(0, 50), GridCell::new(99, 50));
        let mut planner = DStarLite::new(&grid, robot, goal).unwrap();
        assert_eq!(planner.plan(), Err(PlanError::Unreachable { start: robot, goal }));
        assert_eq!(planner.statistics.expanded, 0);
        planner.set_free(GridCell::new(50, 3), true);
        assert!(planner.plan().unwrap().cost > 99.0);
        planner.set_free(GridCell::new(50, 3), false);
        assert_eq!(planner.plan(), Err(PlanError::Unreachable { start: robot, goal }));
    }

    #[test]
    fn ends_outside_are_named() {
        let grid = BitGrid::from_text("..").unwrap();
        let outside = GridCell::new(2, 0);
        let error = DStarLite::new(&grid, GridCell::new(0, 0), outside).unwrap_err();
        assert_eq!(error, PlanError::Outside { end: End::Goal, cell: outside, width: 2, height: 1 });
        let empty = BitGrid::blocked(0, 4).unwrap();
        assert_eq!(DStarLite::new(&empty, outside, outside).unwrap_err(), PlanError::EmptyMap);
        let mut planner = DStarLite::new(&grid, GridCell::new(0, 0), GridCell::new(1, 0)).unwrap();
        assert!(planner.move_to(outside).is_err());
        planner.set_free(GridCell::new(1, 0), false);
        assert_eq!(planner.plan(), Err(PlanError::Blocked { end: End::Goal, cell: GridCell::new(1, 0) }));
    }
}
