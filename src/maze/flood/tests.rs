use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap, VecDeque};

use proptest::prelude::*;

use super::*;
use crate::maze::generate::{braided, mazes, partly_known};
use crate::maze::{Direction, WallState};
use crate::random::Stream;

/// Breadth-first search in its plainest form.
fn breadth_first(maze: &Maze, unknown: Unknown, sources: &[Cell]) -> Vec<Option<u32>> {
    let mut steps = vec![None; maze.cell_count()];
    let mut queue: VecDeque<Cell> = sources.iter().copied().collect();
    for &source in sources {
        steps[maze.index(source)] = Some(0);
    }
    while let Some(cell) = queue.pop_front() {
        for direction in Direction::ALL {
            if let Some(next) = maze.passage(cell, direction, unknown)
                && steps[maze.index(next)].is_none()
            {
                steps[maze.index(next)] = steps[maze.index(cell)].map(|steps: u32| steps + 1);
                queue.push_back(next);
            }
        }
    }
    steps
}

/// Dijkstra's algorithm with unit costs.
fn dijkstra(maze: &Maze, unknown: Unknown, sources: &[Cell]) -> Vec<Option<u32>> {
    let mut steps = vec![None; maze.cell_count()];
    let mut open: BinaryHeap<_> = sources.iter().map(|&cell| Reverse((0, cell))).collect();
    while let Some(Reverse((cost, cell))) = open.pop() {
        let known: &mut Option<u32> = &mut steps[maze.index(cell)];
        if known.is_some() {
            continue;
        }
        *known = Some(cost);
        let next = Direction::ALL.into_iter().filter_map(|side| maze.passage(cell, side, unknown));
        open.extend(next.map(|next| Reverse((cost + 1, next))));
    }
    steps
}

fn found(maze: &Maze, distances: &Distances) -> Vec<Option<u32>> {
    maze.cells().map(|cell| distances.get(cell)).collect()
}

fn assert_all_agree(maze: &Maze, unknown: Unknown, flood: &mut FloodFill) {
    let goals: Vec<Cell> = maze.goals().collect();
    for sources in [goals, vec![maze.start()], vec![]] {
        let distances = flood.run(&Passages::new(maze, unknown), sources.iter().copied());
        let expected = breadth_first(maze, unknown, &sources);
        assert_eq!(found(maze, distances), expected);
        assert_eq!(expected, dijkstra(maze, unknown, &sources));
        assert_eq!(distances.reached(), expected.iter().flatten().count());
        assert_eq!(distances.farthest(), expected.iter().flatten().copied().max());
    }
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn flood_fill_finds_what_breadth_first_search_and_dijkstra_find(
        maze in prop_oneof![partly_known(16), partly_known(32), partly_known(40)],
    ) {
        let mut flood = FloodFill::default();
        for unknown in [Unknown::Open, Unknown::Closed] {
            assert_all_agree(&maze, unknown, &mut flood);
        }
    }

    #[test]
    fn a_fill_does_not_depend_on_the_one_before(a in mazes(20), b in mazes(40)) {
        let mut flood = FloodFill::default();
        for maze in [&a, &b, &a] {
            assert_all_agree(maze, Unknown::Closed, &mut flood);
        }
    }

    #[test]
    fn incremental_fill_equals_full_fill_after_every_wall(
        maze in prop_oneof![mazes(12), mazes(40)],
        seed in any::<u64>(),
    ) {
        let mut stream = Stream::new(seed);
        let sources: Vec<Cell> = maze.goals().collect();
        let mut incremental = IncrementalFlood::new(Passages::new(&maze, Unknown::Closed), sources.clone());
        let mut maze = maze;
        for _ in 0..60 {
            let cell = maze.cell_at(stream.below(maze.cell_count()));
            let side = Direction::ALL[stream.below(4)];
            if maze.neighbour(cell, side).is_none() {
                continue;
            }
            let before = incremental.distances().clone();
            let open = maze.wall(cell, side) == WallState::Present;
            maze.set_wall(cell, side, if open { WallState::Absent } else { WallState::Present });
            let changed = incremental.set(cell, side, open);
            let expected = breadth_first(&maze, Unknown::Closed, &sources);
            prop_assert_eq!(found(&maze, incremental.distances()), expected);
            let differ = before.as_slice().iter().zip(incremental.distances().as_slice());
            prop_assert_eq!(changed, differ.filter(|(a, b)| a != b).count());
        }
    }

    #[test]
    fn forwards_and_backwards_the_way_is_as_long(maze in mazes(34)) {
        let (to_goal, from_start) =
            (distances_to_goal(&maze, Unknown::Closed), distances_from_start(&maze, Unknown::Closed));
        let there = maze.goals().filter_map(|goal| from_start.get(goal)).min();
        prop_assert_eq!(to_goal.get(maze.start()), there);
    }

    #[test]
    fn passages_are_set_both_ways(side in prop_oneof![Just(9usize), Just(30), Just(50)], seed in any::<u64>()) {
        let mut passages = Passages::new(&Maze::filled(side, side, WallState::Present).unwrap(), Unknown::Open);
        let mut stream = Stream::new(seed);
        let mut open = BTreeSet::new();
        for _ in 0..50 {
            let cell = Cell::new(stream.below(side) as u16, stream.below(side) as u16);
            let direction = Direction::ALL[stream.below(4)];
            passages.set(cell, direction, true);
            open.insert((cell, direction));
        }
        let maze = Maze::open(side, side).unwrap();
        for (cell, direction) in open {
            let next = maze.neighbour(cell, direction);
            prop_assert_eq!(passages.is_open(cell, direction), next.is_some());
            if let Some(next) = next {
                prop_assert!(passages.is_open(next, direction.opposite()));
                passages.set(next, direction.opposite(), false);
                prop_assert!(!passages.is_open(cell, direction));
                passages.set(cell, direction, true);
            }
        }
    }
}

#[test]
fn waves_spread_alike_with_and_without_wide_registers() {
    // On processors with such registers, nothing else tests the portable wave.
    for seed in 0..50 {
        let maze = braided(16, 16, 0.1, seed).unwrap();
        let passages = Passages::new(&maze, Unknown::Closed);
        let passages::Grid::Small(boards) = &passages.grid else { panic!("16 x 16 cells are few") };
        let mut steps = vec![0; 256];
        wave::write(&wave::Wave::<4, 8>::spread(boards, [1, 0, 0, 0]), 16, &mut steps);
        assert_eq!(distances_from_start(&maze, Unknown::Closed).as_slice(), steps);
    }
}

#[test]
fn the_longest_possible_ways_are_counted() {
    // A snake through all cells: the last one has the largest possible distance.
    for side in [16, 32, 256] {
        let mut maze = Maze::open(side, side).unwrap();
        for y in 1..side as u16 {
            let gap = if y % 2 == 1 { side as u16 - 1 } else { 0 };
            for x in (0..side as u16).filter(|&x| x != gap) {
                maze.set_wall(Cell::new(x, y), Direction::South, WallState::Present);
            }
        }
        let distances = distances_from_start(&maze, Unknown::Closed);
        assert_eq!(distances.farthest(), Some((side * side) as u32 - 1));
        assert_eq!(distances.reached(), side * side);
    }
}

#[test]
fn a_large_braided_maze_is_filled_as_by_breadth_first_search() {
    let maze = braided(256, 256, 0.1, 1).unwrap();
    let expected = breadth_first(&maze, Unknown::Closed, &[maze.start()]);
    assert_eq!(found(&maze, &distances_from_start(&maze, Unknown::Closed)), expected);
}

#[test]
fn an_incremental_fill_of_a_large_maze_equals_a_full_one() {
    let mut maze = braided(256, 256, 0.1, 2).unwrap();
    let mut stream = Stream::new(3);
    let mut incremental = IncrementalFlood::new(Passages::new(&maze, Unknown::Closed), [maze.start()]);
    let mut flood = FloodFill::default();
    for _ in 0..40 {
        let (cell, side) = (maze.cell_at(stream.below(maze.cell_count())), Direction::ALL[stream.below(4)]);
        if maze.neighbour(cell, side).is_none() {
            continue;
        }
        let open = maze.wall(cell, side) == WallState::Present;
        maze.set_wall(cell, side, if open { WallState::Absent } else { WallState::Present });
        incremental.set(cell, side, open);
        let full = flood.run(&Passages::new(&maze, Unknown::Closed), [maze.start()]);
        assert_eq!(incremental.distances().as_slice(), full.as_slice());
    }
}
