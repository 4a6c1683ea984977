use proptest::prelude::*;

use super::{braided, perfect};
use crate::maze::{Cell, Direction, Maze, WallState};
use crate::random::Stream;

/// Random walls, from none to nearly all, so that many cells may be unreachable; random start, heading and
/// goals.
///
/// # Panics
///
/// If `side` is 0 or more than 256.
///
/// ```
/// use proptest::prelude::*;
/// use proptest::test_runner::TestRunner;
/// use roverlab::maze::generate::sparse_mazes;
/// use roverlab::maze::{Preference, Unknown, distances_to_goal, shortest_route};
/// TestRunner::deterministic().run(&sparse_mazes(8), |maze| {
///     let route = shortest_route(&maze, Unknown::Closed, Preference::Steps);
///     let steps = distances_to_goal(&maze, Unknown::Closed).get(maze.start());
///     prop_assert_eq!(route.map(|route| route.steps() as u32), steps, "none if unreachable");
///     Ok(())
/// }).unwrap();
/// ```
pub fn sparse_mazes(side: usize) -> impl Strategy<Value = Maze> {
    let shape = (1..=side, 1..=side, 0.0..0.9f64, any::<u64>());
    shape.prop_map(|(width, height, density, seed)| {
        let mut stream = Stream::new(seed);
        let mut maze = Maze::open(width, height).unwrap_or_else(|error| panic!("{error}"));
        for cell in maze.cells() {
            for side in [Direction::North, Direction::East] {
                if maze.neighbour(cell, side).is_some() && stream.chance(density) {
                    maze.set_wall(cell, side, WallState::Present);
                }
            }
        }
        place(&mut maze, &mut stream);
        maze
    })
}

/// Mazes in which every cell is reachable, from perfect to half open; random start, heading and goals.
///
/// # Panics
///
/// If `side` is 0 or more than 256.
///
/// ```
/// use proptest::prelude::*;
/// use proptest::test_runner::TestRunner;
/// use roverlab::maze::generate::braided_mazes;
/// use roverlab::maze::{Unknown, distances_from_start};
/// TestRunner::deterministic().run(&braided_mazes(8), |maze| {
///     prop_assert_eq!(distances_from_start(&maze, Unknown::Closed).reached(), maze.cell_count());
///     Ok(())
/// }).unwrap();
/// ```
pub fn braided_mazes(side: usize) -> impl Strategy<Value = Maze> {
    let shape = (1..=side, 1..=side, prop_oneof![Just(0.0), 0.0..0.5f64], any::<u64>());
    shape.prop_map(|(width, height, part, seed)| {
        let maze =
            if part == 0.0 { perfect(width, height, seed) } else { braided(width, height, part, seed) };
        let mut maze = maze.unwrap_or_else(|error| panic!("{error}"));
        place(&mut maze, &mut Stream::new(seed).child("places", 0));
        maze
    })
}

/// Mazes of all kinds.
///
/// # Panics
///
/// If `side` is 0 or more than 256.
///
/// ```
/// use proptest::prelude::*;
/// use proptest::test_runner::TestRunner;
/// use roverlab::maze::generate::mazes;
/// TestRunner::deterministic().run(&mazes(8), |maze| {
///     prop_assert!(maze.width() <= 8 && maze.height() <= 8 && maze.unknown_walls() == 0);
///     Ok(())
/// }).unwrap();
/// ```
pub fn mazes(side: usize) -> impl Strategy<Value = Maze> {
    prop_oneof![sparse_mazes(side), braided_mazes(side)]
}

/// Mazes of all kinds in which some inner walls are unknown and some outer ones are missing.
///
/// ```
/// use proptest::prelude::*;
/// use proptest::test_runner::TestRunner;
/// use roverlab::maze::generate::partly_known;
/// use roverlab::maze::{Unknown, distances_to_goal};
/// TestRunner::deterministic().run(&partly_known(8), |maze| {
///     let steps = |unknown| distances_to_goal(&maze, unknown).get(maze.start()).unwrap_or(u32::MAX);
///     prop_assert!(steps(Unknown::Open) <= steps(Unknown::Closed), "the optimistic route is no longer");
///     Ok(())
/// }).unwrap();
/// ```
pub fn partly_known(side: usize) -> impl Strategy<Value = Maze> {
    (mazes(side), 0.0..1.0f64, any::<u64>()).prop_map(|(mut maze, unknown, seed)| {
        let mut stream = Stream::new(seed);
        for cell in maze.cells() {
            for side in Direction::ALL {
                if maze.neighbour(cell, side).is_none() {
                    if stream.chance(0.1) {
                        maze.set_wall(cell, side, WallState::Absent);
                    }
                } else if stream.chance(0.5 * unknown) {
                    maze.set_wall(cell, side, WallState::Unknown);
                }
            }
        }
        maze
    })
}

fn place(maze: &mut Maze, stream: &mut Stream) {
    let any = |stream: &mut Stream, maze: &Maze| -> Cell { maze.cell_at(stream.below(maze.cell_count())) };
    let start = any(stream, maze);
    maze.set_start(start, Direction::ALL[stream.below(4)]);
    let goals: Vec<Cell> = (0..=stream.below(3)).map(|_| any(stream, maze)).collect();
    maze.set_goals(goals);
}
