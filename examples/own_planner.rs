//! A planner of one's own: breadth-first search becomes a `GridPlanner` by one method. The library's checks
//! try it on drawn maps; one that is in a hurry is found out. Needs the feature `testing`.
//!
//! `cargo run --release --features testing --example own_planner`

use std::collections::{BTreeMap, VecDeque};

use proptest::test_runner::{TestCaseError, TestRunner};
use roverlab::nav::grid::{GridPath, GridPlanner, PlanError, SearchStatistics};
use roverlab::testing::{cases, collision_free, complete, grid_queries};
use roverlab::world::{BitGrid, GridCell};

/// Steps along edges only; gives up after so many cells.
struct Breadth<'a> {
    grid: &'a BitGrid,
    most: usize,
}

impl GridPlanner for Breadth<'_> {
    fn plan(&mut self, start: GridCell, goal: GridCell) -> Result<GridPath, PlanError> {
        let mut came_from = BTreeMap::from([(start, start)]);
        let mut queue = VecDeque::from([start]);
        let mut expanded = 0;
        while let Some(cell) = queue.pop_front().filter(|_| expanded < self.most) {
            if cell == goal {
                let statistics = SearchStatistics { expanded, generated: came_from.len() };
                return Ok(path_back(&came_from, goal, statistics));
            }
            expanded += 1;
            let GridCell { column, row } = cell;
            let (left, below) = (column.wrapping_sub(1), row.wrapping_sub(1));
            for (column, row) in [(column + 1, row), (column, row + 1), (left, row), (column, below)] {
                let next = GridCell::new(column, row);
                if self.grid.contains(next) && self.grid.is_free(next) && !came_from.contains_key(&next) {
                    came_from.insert(next, cell);
                    queue.push_back(next);
                }
            }
        }
        Err(PlanError::Unreachable { start, goal })
    }
}

fn path_back(
    came_from: &BTreeMap<GridCell, GridCell>,
    goal: GridCell,
    statistics: SearchStatistics,
) -> GridPath {
    let mut points = vec![goal.centre()];
    let mut cell = goal;
    // The start came from itself.
    while came_from[&cell] != cell {
        cell = came_from[&cell];
        points.push(cell.centre());
    }
    points.reverse();
    GridPath { cost: points.len() as f64 - 1.0, points, statistics }
}

/// Tries a planner on 256 drawn maps; says what it did wrong.
fn check(most: usize) -> Result<(), String> {
    let result = TestRunner::new(cases(256)).run(&grid_queries(2..16, 2..16), |(grid, cells)| {
        let mut planner = Breadth { grid: &grid, most };
        collision_free(&mut planner, &grid, cells[0], cells[1])?;
        complete(&mut planner, &grid, cells[0], cells[1])?;
        Ok::<(), TestCaseError>(())
    });
    result.map_err(|error| error.to_string())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let grid = BitGrid::from_text("......\n.####.\n......")?;
    let mut planner = Breadth { grid: &grid, most: usize::MAX };
    let path = planner.plan(GridCell::new(0, 1), GridCell::new(5, 1))?;
    println!("a path of {} steps, {} cells expanded", path.cost, path.statistics.expanded);
    assert_eq!(path.cost, 7.0);

    check(usize::MAX)?;
    println!("It passes on all drawn maps.");
    let wrong = check(30).err().ok_or("the one in a hurry was not found out")?;
    println!("In a hurry it does not. {}", wrong.lines().next().unwrap_or_default());
    assert!(wrong.contains("no path"));
    Ok(())
}
