//! Flood fill and time-optimal plans of mazes.
//!
//! First a table: flood fill of all published mazes of 16 x 16 cells in turn, beside the book's passes over
//! all cells and a queue, both in C, and beside the queue of this library. Then criterion's figures. The
//! published mazes are found in the folder `micromouse` of the one that the environment variable
//! `ROVERLAB_DATA` names; without it, mazes made at random take their place.

#[path = "mazes/contest.rs"]
mod contest;
#[path = "mazes/task.rs"]
mod task;

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use roverlab::maze::generate::{braided, perfect};
use roverlab::maze::{FastPlanner, FloodFill, Maze, Passages, RunLimits, Scale, Unknown};
use task::Task;

/// Every maze in turn, by each way to fill it.
fn small(c: &mut Criterion, tasks: &[Task]) {
    let mut group = c.benchmark_group("16 x 16, all mazes in turn");
    group.throughput(Throughput::Elements(tasks.len() as u64));
    for method in task::METHODS {
        let mut fill = task::filler(method);
        group.bench_function(method.name(), |b| b.iter(|| tasks.iter().for_each(&mut fill)));
    }
    group.bench_function("passages of a maze", |b| {
        b.iter(|| {
            for task in tasks {
                black_box(Passages::new(&task.maze, Unknown::Closed));
            }
        });
    });
    group.finish();
}

/// Mazes of the largest size, perfect and with a tenth of the walls taken down.
fn large(c: &mut Criterion) {
    const SIDE: usize = Maze::MAX_SIDE;
    const SEED: u64 = 1;
    let mut group = c.benchmark_group(format!("256 x 256, seed {SEED}"));
    let mazes = [("braided", braided(SIDE, SIDE, 0.1, SEED)), ("perfect", perfect(SIDE, SIDE, SEED))];
    for (name, maze) in mazes {
        let maze = maze.expect("a size within limits");
        let passages = Passages::new(&maze, Unknown::Closed);
        let mut flood = FloodFill::default();
        let steps = flood.run(&passages, [maze.start()]);
        assert!(steps.reached() == SIDE * SIDE, "every cell can be reached");
        task::assert_steps_differ_by_one(&maze, steps);
        println!("{name}: the farthest cell is {} steps away", steps.farthest().unwrap_or_default());
        group.bench_function(name, |b| {
            b.iter(|| black_box(flood.run(black_box(&passages), [maze.start()]).as_slice()[1]));
        });
    }
    group.finish();
}

/// The fastest run through the published mazes of each size, with diagonals.
fn plans(c: &mut Criterion) {
    let mut planner =
        FastPlanner::new(Scale::MICROMOUSE, RunLimits::MICROMOUSE).expect("limits within bounds");
    for side in [16, 32] {
        let mazes: Vec<Maze> = task::mazes(side);
        let mut slowest = (0.0, 0.0);
        let mut total = 0.0;
        for maze in &mazes {
            let plan = planner.plan(maze, Unknown::Closed).expect("a way to the goal");
            let time =
                contest::least_seconds(|| drop(black_box(planner.plan(black_box(maze), Unknown::Closed))));
            total += time;
            if time > slowest.0 {
                slowest = (time, plan.time);
            }
        }
        println!(
            "time-optimal plan of {} mazes of {side} x {side}: mean {:.3} ms, slowest {:.3} ms for a run of {:.2} s",
            mazes.len(),
            1e3 * total / mazes.len() as f64,
            1e3 * slowest.0,
            slowest.1
        );
        let mut group = c.benchmark_group(format!("time-optimal plan, {side} x {side}, all mazes in turn"));
        group.throughput(Throughput::Elements(mazes.len() as u64));
        group.bench_function("with diagonals", |b| {
            b.iter(|| {
                for maze in &mazes {
                    black_box(planner.plan(maze, Unknown::Closed));
                }
            });
        });
        group.finish();
    }
}

fn main() {
    let tasks: Vec<Task> = task::mazes(16).into_iter().map(Task::new).collect();
    contest::table(&tasks);
    let mut criterion = Criterion::default().configure_from_args();
    small(&mut criterion, &tasks);
    large(&mut criterion);
    plans(&mut criterion);
    criterion.final_summary();
}
