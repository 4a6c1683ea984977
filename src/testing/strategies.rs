use std::ops::Range;

use proptest::prelude::*;

use crate::random::Stream;
use crate::world::generate::{
    Course, CourseOptions, Pool, PoolKind, Relief, ReliefKind, ReliefOptions, obstacle_course, pool, relief,
};
use crate::world::{BitGrid, GridCell};

/// Random grids with sides in the given ranges (at least one cell): scattered cells, boxes, or rooms with
/// doors, with few to many blocked cells.
///
/// A failing grid shrinks by its size, not cell by cell.
///
/// ```
/// use proptest::prelude::*;
/// use proptest::test_runner::TestRunner;
/// use roverlab::testing::grids;
/// TestRunner::deterministic().run(&grids(1..20, 1..9), |grid| {
///     prop_assert!(grid.width() < 20 && grid.height() < 9);
///     prop_assert_eq!(grid.transposed().transposed(), grid);
///     Ok(())
/// }).unwrap();
/// ```
pub fn grids(widths: Range<usize>, heights: Range<usize>) -> impl Strategy<Value = BitGrid> {
    (widths, heights, 0..3usize, 0.0..1.0f64, any::<u64>()).prop_map(|(width, height, kind, share, seed)| {
        let (width, height) = (width.max(1), height.max(1));
        let mut stream = Stream::new(seed);
        match kind {
            0 => scattered(width, height, 0.4 + 0.6 * share, &mut stream),
            1 => boxes(width, height, (20.0 * share) as usize, &mut stream),
            _ => rooms(width, height, 3 + (8.0 * share) as usize, &mut stream),
        }
    })
}

/// Grids as in [`grids`], each with three of its free cells, which may be equal and need not be connected. If
/// a grid has no free cell, its first one is freed.
pub fn grid_queries(
    widths: Range<usize>,
    heights: Range<usize>,
) -> impl Strategy<Value = (BitGrid, [GridCell; 3])> {
    (grids(widths, heights), any::<[prop::sample::Index; 3]>()).prop_map(|(mut grid, indices)| {
        if grid.count_free() == 0 {
            grid.set_free(GridCell::new(0, 0), true);
        }
        let cells: Vec<GridCell> = grid.free_cells().collect();
        (grid, indices.map(|index| *index.get(&cells)))
    })
}

fn scattered(width: usize, height: usize, share: f64, stream: &mut Stream) -> BitGrid {
    filled(width, height, |_, _| stream.chance(share))
}

fn boxes(width: usize, height: usize, count: usize, stream: &mut Stream) -> BitGrid {
    let mut grid = filled(width, height, |_, _| true);
    for _ in 0..count {
        let (x, y) = (stream.below(width), stream.below(height));
        let (w, h) = (1 + stream.below(width.div_ceil(3)), 1 + stream.below(height.div_ceil(3)));
        for row in y..y + h {
            for column in x..x + w {
                grid.set_free(GridCell::new(column, row), false);
            }
        }
    }
    grid
}

fn rooms(width: usize, height: usize, size: usize, stream: &mut Stream) -> BitGrid {
    let is_wall = |at: usize| at % size == size - 1;
    let mut grid = filled(width, height, |x, y| !is_wall(x) && !is_wall(y));
    for (x, y) in (0..height).step_by(size).flat_map(|y| (0..width).step_by(size).map(move |x| (x, y))) {
        let mut door = |column: usize, row: usize| {
            if stream.chance(0.75) {
                grid.set_free(GridCell::new(column, row), true);
            }
        };
        door(x + size - 1, y + (x / size + y / size) % (size - 1));
        door(x + (x / size) % (size - 1), y + size - 1);
    }
    grid
}

fn filled(width: usize, height: usize, is_free: impl FnMut(usize, usize) -> bool) -> BitGrid {
    BitGrid::from_fn(width, height, is_free)
        .unwrap_or_else(|error| panic!("a strategy's sizes are too large: {error}"))
}

/// A maze with exactly one path between any two places, and that between two of them.
#[derive(Debug, Clone, PartialEq)]
pub struct GridMaze {
    /// The maze: passages and walls are one cell wide.
    pub grid: BitGrid,
    /// Start of the path.
    pub start: GridCell,
    /// End of the path.
    pub goal: GridCell,
    /// Cells of the only path, both ends included. Its length is one less.
    pub way: Vec<GridCell>,
}

/// Mazes with numbers of places in the given ranges (at least one per direction), whose solution is known by
/// construction. The grid has twice as many columns and rows, less one. No diagonal step is possible.
///
/// ```
/// use proptest::prelude::*;
/// use proptest::test_runner::TestRunner;
/// use roverlab::nav::grid::{GridPlanner, GridSearch};
/// use roverlab::testing::mazes;
/// TestRunner::deterministic().run(&mazes(1..8, 1..8), |maze| {
///     let path = GridSearch::astar(&maze.grid).plan(maze.start, maze.goal).expect("there is a way");
///     prop_assert_eq!(path.cost, (maze.way.len() - 1) as f64);
///     Ok(())
/// }).unwrap();
/// ```
pub fn mazes(widths: Range<usize>, heights: Range<usize>) -> impl Strategy<Value = GridMaze> {
    (widths, heights, any::<u64>()).prop_map(|(width, height, seed)| {
        let (width, height) = (width.max(1), height.max(1));
        let mut stream = Stream::new(seed);
        maze(width, height, &mut stream)
    })
}

fn maze(width: usize, height: usize, stream: &mut Stream) -> GridMaze {
    let mut grid = filled(2 * width - 1, 2 * height - 1, |_, _| false);
    let [start, goal] = [(); 2].map(|()| (stream.below(width), stream.below(height)));
    // Depth-first from the start: the path to the goal is on the stack when the goal is reached.
    let place = |(x, y): (usize, usize)| GridCell::new(2 * x, 2 * y);
    let mut stack = vec![start];
    grid.set_free(place(start), true);
    let mut way = Vec::new();
    while let Some(&(x, y)) = stack.last() {
        if (x, y) == goal && way.is_empty() {
            way.clone_from(&stack);
        }
        let around = [(x + 1, y), (x.wrapping_sub(1), y), (x, y + 1), (x, y.wrapping_sub(1))];
        let mut next: Vec<_> = around
            .into_iter()
            .filter(|&(x, y)| x < width && y < height && !grid.is_free(place((x, y))))
            .collect();
        stream.shuffle(&mut next);
        let Some(&next) = next.first() else {
            stack.pop();
            continue;
        };
        grid.set_free(place(next), true);
        grid.set_free(GridCell::new(x + next.0, y + next.1), true);
        stack.push(next);
    }
    let mut cells = vec![place(start)];
    for pair in way.windows(2) {
        cells.push(GridCell::new(pair[0].0 + pair[1].0, pair[0].1 + pair[1].1));
        cells.push(place(pair[1]));
    }
    GridMaze { grid, start: place(start), goal: place(goal), way: cells }
}

/// Random worlds with obstacles, a start, a goal, and whether the goal is reachable; see [`obstacle_course`].
///
/// ```
/// use proptest::prelude::*;
/// use proptest::test_runner::{Config, TestRunner};
/// use roverlab::testing::worlds;
/// TestRunner::new(Config::with_cases(4)).run(&worlds(), |course| {
///     let way = course.goal - course.start.position();
///     prop_assert!(way.norm() > 0.1 && !course.obstacles.is_empty());
///     Ok(())
/// }).unwrap();
/// ```
pub fn worlds() -> impl Strategy<Value = Course> {
    any::<u64>().prop_filter_map("no course of this seed", |seed| {
        obstacle_course(&mut Stream::new(seed), &CourseOptions::default()).ok()
    })
}

/// Hills of a kind, with a slope of 5 to 20 degrees and a place to start from, as [`relief`] makes them. What
/// a robot can reach of them, and how high that is, tells
/// [`ElevationMap::highest_reachable`](crate::nav::elevation::ElevationMap).
///
/// ```
/// use proptest::prelude::*;
/// use proptest::test_runner::{Config, TestRunner};
/// use roverlab::nav::elevation::{Climber, ElevationMap};
/// use roverlab::testing::reliefs;
/// use roverlab::world::generate::ReliefKind;
/// TestRunner::new(Config::with_cases(4)).run(&reliefs(ReliefKind::Range), |range| {
///     let ground = range.world.terrain.and_then(|terrain| terrain.surface).expect("hills");
///     let climber = Climber { slope: 0.35, step: 0.02, radius: 0.15 };
///     let map = ElevationMap::new(&ground, &climber).expect("good parameters");
///     let top = map.highest_reachable(range.start.position()).expect("a start to stand on");
///     prop_assert!(top.z <= ground.highest() + 1e-9);
///     Ok(())
/// }).unwrap();
/// ```
pub fn reliefs(kind: ReliefKind) -> impl Strategy<Value = Relief> {
    (any::<u64>(), 5.0..20.0f64).prop_filter_map("ramps without room", move |(seed, degrees)| {
        let slope = crate::geometry::units::from_deg(degrees);
        relief(&mut Stream::new(seed), &ReliefOptions { slope, ..ReliefOptions::of(kind) }).ok()
    })
}

/// Pools with water: rectangles, Ls and kidneys with floors that slope; see [`pool`].
///
/// ```
/// use proptest::prelude::*;
/// use proptest::test_runner::{Config, TestRunner};
/// use roverlab::testing::pools;
/// TestRunner::new(Config::with_cases(4)).run(&pools(), |pool| {
///     let ground = pool.world.terrain.and_then(|terrain| terrain.surface).expect("a floor");
///     let level = pool.world.water_level.expect("water");
///     prop_assert!(level - ground.height(pool.start.position()).expect("a place to start from") > 1.4);
///     Ok(())
/// }).unwrap();
/// ```
pub fn pools() -> impl Strategy<Value = Pool> {
    (any::<u64>(), prop::sample::select(&PoolKind::ALL[..]))
        .prop_filter_map("no pool of this seed", |(seed, kind)| pool(&mut Stream::new(seed), kind).ok())
}
