use proptest::prelude::*;

use super::{
    AnyAngle, End, GridPath, GridPlanner, GridSearch, JumpPointSearch, LazyThetaStar, PlanError,
    PreparedJumps, Quadtree, QuadtreePlanner,
};
use crate::random::Stream;
use crate::world::{BitGrid, GridCell};

fn random_grid(width: usize, height: usize, share: f64, seed: u64) -> BitGrid {
    let mut stream = Stream::new(seed);
    BitGrid::from_fn(width, height, |_, _| stream.chance(share)).unwrap()
}

/// A grid of rectangles, with long walls and wide spaces.
fn boxes(width: usize, height: usize, count: usize, seed: u64) -> BitGrid {
    let mut stream = Stream::new(seed);
    let mut grid = BitGrid::from_fn(width, height, |_, _| true).unwrap();
    for _ in 0..count {
        let (x, y) = (stream.below(width), stream.below(height));
        let (w, h) = (stream.below(width / 4 + 1), stream.below(height / 4 + 1));
        for row in y..y + h {
            (x..x + w).for_each(|column| grid.set_free(GridCell::new(column, row), false));
        }
    }
    grid
}

/// Costs from a cell to all others, by Bellman's equations relaxed until nothing changes.
fn truth(grid: &BitGrid, start: GridCell) -> Vec<f64> {
    let (w, h) = (grid.width() as isize, grid.height() as isize);
    let free = |x: isize, y: isize| x >= 0 && y >= 0 && grid.is_free(GridCell::new(x as usize, y as usize));
    let mut costs = vec![f64::INFINITY; grid.width() * grid.height()];
    costs[start.row * grid.width() + start.column] = 0.0;
    loop {
        let before = costs.clone();
        for (y, x) in (0..h).flat_map(|y| (0..w).map(move |x| (y, x))) {
            for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
                if free(x, y) && free(x + dx, y) && free(x, y + dy) && free(x + dx, y + dy) {
                    let step = f64::from((dx * dx + dy * dy) as i32).sqrt();
                    let other = costs[((y + dy) * w + x + dx) as usize] + step;
                    let cost = &mut costs[(y * w + x) as usize];
                    *cost = cost.min(other);
                }
            }
        }
        if costs == before {
            return costs;
        }
    }
}

fn planners(grid: &BitGrid) -> [(&'static str, Box<dyn GridPlanner>); 4] {
    [
        ("Dijkstra", Box::new(GridSearch::dijkstra(grid))),
        ("A*", Box::new(GridSearch::astar(grid))),
        ("jumps", Box::new(JumpPointSearch::new(grid))),
        ("prepared jumps", Box::new(PreparedJumps::new(grid))),
    ]
}

/// The path's steps are allowed, and its cost is their sum.
fn assert_sound(grid: &BitGrid, path: &GridPath, start: GridCell, goal: GridCell) {
    let cells: Vec<GridCell> = path.points.iter().map(|&point| GridCell::at(point).unwrap()).collect();
    assert_eq!((cells[0], cells[cells.len() - 1]), (start, goal));
    let mut cost = 0.0;
    for pair in cells.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let (dx, dy) = (a.column.abs_diff(b.column), a.row.abs_diff(b.row));
        assert!(dx.max(dy) == 1, "{a} to {b}");
        assert!(
            [a, b, GridCell::new(a.column, b.row), GridCell::new(b.column, a.row)]
                .iter()
                .all(|&c| grid.is_free(c))
        );
        cost += if dx == dy { std::f64::consts::SQRT_2 } else { 1.0 };
    }
    assert!((cost - path.cost).abs() < 1e-9, "{cost} and {}", path.cost);
}

fn assert_optimal(grid: &BitGrid, queries: usize, seed: u64) {
    let cells: Vec<GridCell> = grid.free_cells().collect();
    if cells.is_empty() {
        return;
    }
    let mut planners = planners(grid);
    let mut stream = Stream::new(seed);
    for _ in 0..queries {
        let start = cells[stream.below(cells.len())];
        let costs = truth(grid, start);
        for _ in 0..queries {
            let goal = cells[stream.below(cells.len())];
            let expected = costs[goal.row * grid.width() + goal.column];
            for (name, planner) in &mut planners {
                match planner.plan(start, goal) {
                    Ok(path) => {
                        assert_sound(grid, &path, start, goal);
                        assert!(
                            (path.cost - expected).abs() < 1e-9,
                            "{name}: {} for {expected}, {start} to {goal} on {grid:?}",
                            path.cost
                        );
                    }
                    Err(error) => {
                        assert_eq!(error, PlanError::Unreachable { start, goal });
                        assert!(expected.is_infinite(), "{name}: {start} to {goal} on {grid:?}");
                    }
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(crate::testing::cases(300))]

    #[test]
    fn all_planners_find_the_shortest_paths(
        width in 1..24usize, height in 1..24usize, share in 0.4..0.95f64, seed in any::<u64>()
    ) {
        assert_optimal(&random_grid(width, height, share, seed), 4, seed);
    }

    #[test]
    fn also_around_boxes(width in 1..90usize, height in 1..20usize, count in 0..12usize, seed in any::<u64>()) {
        assert_optimal(&boxes(width, height, count, seed), 3, seed);
        assert_optimal(&boxes(height, width, count, seed), 3, seed);
    }

    /// Changing single cells gives the planner of the changed map.
    #[test]
    fn jumps_follow_changes(seed in any::<u64>()) {
        let mut grid = boxes(70, 20, 8, seed);
        let mut changed = JumpPointSearch::new(&grid);
        let mut stream = Stream::new(seed);
        for _ in 0..20 {
            let cell = GridCell::new(stream.below(72), stream.below(21));
            let free = stream.chance(0.5);
            grid.set_free(cell, free);
            changed.set_free(cell, free);
        }
        let mut fresh = JumpPointSearch::new(&grid);
        let cells: Vec<GridCell> = grid.free_cells().collect();
        for _ in 0..20 {
            let (start, goal) = (cells[stream.below(cells.len())], cells[stream.below(cells.len())]);
            prop_assert_eq!(changed.plan(start, goal), fresh.plan(start, goal));
        }
    }
}

/// All planners on a map, whatever kind of paths they find.
fn all_planners(grid: &BitGrid) -> Vec<(&'static str, Box<dyn GridPlanner>)> {
    let mut prepared = AnyAngle::new(grid);
    prepared.prepare();
    let others: [(&str, Box<dyn GridPlanner>); 4] = [
        ("any angle", Box::new(AnyAngle::new(grid))),
        ("any angle, prepared", Box::new(prepared)),
        ("lazy theta", Box::new(LazyThetaStar::new(grid))),
        ("quadtree", Box::new(QuadtreePlanner::new(&Quadtree::new(grid)))),
    ];
    planners(grid).into_iter().chain(others).collect()
}

#[test]
fn queries_without_an_answer_are_named() {
    let grid = BitGrid::from_text("..#.\n..#.").unwrap();
    let (cell, far) = (GridCell::new, GridCell::new(usize::MAX, usize::MAX));
    let outside = |end, cell| PlanError::Outside { end, cell, width: 4, height: 2 };
    let blocked = |end| PlanError::Blocked { end, cell: GridCell::new(2, 1) };
    for (name, mut planner) in all_planners(&grid) {
        for (start, goal, error) in [
            (cell(4, 0), cell(0, 0), outside(End::Start, cell(4, 0))),
            (cell(0, 0), cell(0, 2), outside(End::Goal, cell(0, 2))),
            (far, far, outside(End::Start, far)),
            (cell(2, 1), cell(0, 0), blocked(End::Start)),
            (cell(0, 0), cell(2, 1), blocked(End::Goal)),
            (cell(2, 1), cell(2, 1), blocked(End::Start)),
            (cell(0, 0), cell(3, 0), PlanError::Unreachable { start: cell(0, 0), goal: cell(3, 0) }),
        ] {
            assert_eq!(planner.plan(start, goal), Err(error), "{name}");
        }
        assert_eq!(planner.plan(cell(1, 1), cell(1, 1)).unwrap().cost, 0.0, "{name}");
    }
    for (width, height) in [(0, 0), (0, 3), (3, 0)] {
        for (name, mut planner) in all_planners(&BitGrid::blocked(width, height).unwrap()) {
            assert_eq!(planner.plan(cell(0, 0), cell(0, 0)), Err(PlanError::EmptyMap), "{name}");
        }
    }
    assert_eq!(blocked(End::Start).to_string(), "the start (2, 1) is blocked; expected a free cell");
}

/// The lack of a path is known before the search.
#[test]
fn disconnected_regions_need_no_search() {
    let grid = BitGrid::from_fn(300, 300, |x, _| x != 150).unwrap();
    for mut planner in [GridSearch::dijkstra(&grid), GridSearch::astar(&grid)] {
        let (start, goal) = (GridCell::new(0, 0), GridCell::new(299, 299));
        let found = planner.plan_traced(start, goal, |step| panic!("looked at {}", step.cell));
        assert_eq!(found, Err(PlanError::Unreachable { start, goal }));
    }
}

#[test]
fn a_star_looks_at_less_than_dijkstra_and_jumps_at_less_than_both() {
    let grid = boxes(100, 100, 20, 4);
    let cells: Vec<GridCell> = grid.free_cells().collect();
    let (start, goal) = (cells[0], cells[cells.len() - 1]);
    let expanded =
        planners(&grid).map(|(_, mut planner)| planner.plan(start, goal).unwrap().statistics.expanded);
    assert!(expanded[0] > expanded[1] && expanded[1] > expanded[2], "{expanded:?}");
    let mut steps = Vec::new();
    let mut astar = GridSearch::astar(&grid);
    let path = astar.plan_traced(start, goal, |step| steps.push(step)).unwrap();
    assert_eq!((steps.len(), steps[0].cell), (path.statistics.expanded, start));
    // The queue is ordered to within a bucket.
    let most = steps.iter().map(|step| step.cost + step.estimate).fold(0.0, f64::max);
    assert!(most <= path.cost + 0.5, "{most} for {}", path.cost);
}
