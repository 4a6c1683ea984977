//! The planners of roverlab beside their peers: the same queries, costs compared first, then the median time of a query.
//!
//! `cargo run --release --manifest-path bench/planners/Cargo.toml` prints a table of microseconds a query and the geometric
//! means of the ratios over the maps of 512 cells and more. Published maps take part where the environment variable
//! `ROVERLAB_DATA` names the folder that holds `movingai/`; some maps are made here. With `--scaling`, how the planners grow with
//! the map's size instead. `--queries N` and `--repeat N` say how many queries a map has got and how often each is
//! asked; the fastest time counts.

mod maps;
mod mesh;
mod peers;

use std::time::Instant;

use maps::Map;
use peers::{GridPathfinding, Pathfinding, Petgraph, Polyanya};
use roverlab::nav::grid::{
    AnyAngle, GridPlanner, GridSearch, JumpPointSearch, PreparedJumps, Quadtree, QuadtreePlanner,
};
use roverlab::world::{BitGrid, GridCell};

/// What a planner answers: the cost.
type Answer<'a> = Box<dyn FnMut(GridCell, GridCell) -> f64 + 'a>;

/// Which costs a planner must find.
#[derive(Clone, Copy, PartialEq)]
enum Truth {
    Octile,
    AnyAngle,
    /// Somewhat longer, or by another rule: told, not required.
    None,
}

struct Column {
    name: &'static str,
    truth: Truth,
    median: f64,
    prepare_ms: f64,
    different: usize,
}

fn ours<P: GridPlanner + 'static>(mut planner: P) -> Answer<'static> {
    Box::new(move |start, goal| planner.plan(start, goal).map_or(f64::NAN, |path| path.cost))
}

type Maker = (&'static str, Truth, fn(&BitGrid) -> Answer<'static>);

const ALL: [Maker; 10] = [
    ("pathfinding A*", Truth::Octile, |grid| Pathfinding::new(grid).into()),
    ("petgraph A*", Truth::Octile, |grid| Petgraph::new(grid).into()),
    ("grid_pathfinding", Truth::None, |grid| GridPathfinding::new(grid).into()),
    ("A*", Truth::Octile, |grid| ours(GridSearch::astar(grid))),
    ("jump points", Truth::Octile, |grid| ours(JumpPointSearch::new(grid))),
    ("prepared jumps", Truth::Octile, |grid| ours(PreparedJumps::new(grid))),
    ("polyanya", Truth::AnyAngle, |grid| Polyanya::new(grid).into()),
    ("any angle, cold", Truth::AnyAngle, |grid| ours(AnyAngle::new(grid))),
    ("any angle", Truth::AnyAngle, |grid| {
        let mut planner = AnyAngle::new(grid);
        planner.prepare();
        ours(planner)
    }),
    ("quadtree", Truth::None, |grid| ours(QuadtreePlanner::new(&Quadtree::new(grid)))),
];

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let number = |name: &str, default: usize| {
        let at = arguments.iter().position(|argument| argument == name);
        at.and_then(|at| arguments.get(at + 1)?.parse().ok()).unwrap_or(default)
    };
    let (queries, repeat) = (number("--queries", 200), number("--repeat", 3));
    if arguments.iter().any(|argument| argument == "--scaling") {
        return scaling(queries.min(50), repeat);
    }
    let mut tables = Vec::new();
    for map in maps::all(queries) {
        tables.push((map.name.clone(), map.grid.width().max(map.grid.height()), compare(&map, &ALL, repeat)));
        let (name, _, columns) = &tables[tables.len() - 1];
        println!("{name}, {} queries", map.queries.len());
        for column in columns {
            let different =
                if column.different > 0 { format!(", {} other costs", column.different) } else { String::new() };
            println!("  {:<18}{:>10.1} us, prepared in {:.1} ms{different}", column.name, column.median, column.prepare_ms);
        }
    }
    println!("\ngeometric means over maps of 512 and more, in terms of pathfinding A*:");
    let large: Vec<&Vec<Column>> = tables.iter().filter(|table| table.1 >= 512).map(|table| &table.2).collect();
    for index in 0..ALL.len() {
        let ratio = |other: usize| {
            let logs = large.iter().map(|columns| (columns[other].median / columns[index].median).ln());
            (logs.sum::<f64>() / large.len() as f64).exp()
        };
        let slowest = tables.iter().map(|table| table.2[0].median / table.2[index].median).fold(f64::INFINITY, f64::min);
        println!(
            "  {:<18}{:>8.2} times as fast; on the worst map {slowest:.2}; {:.2} times grid_pathfinding, {:.2} times polyanya",
            ALL[index].0,
            ratio(0),
            ratio(2),
            ratio(6)
        );
    }
    decomposition();
}

/// Asks all queries of all planners. The answers to compare with are those of this library's Dijkstra and of its shortest
/// paths in any direction without preparation.
fn compare(map: &Map, makers: &[Maker], repeat: usize) -> Vec<Column> {
    let answers = |mut planner: Answer| -> Vec<f64> {
        map.queries.iter().map(|&(start, goal)| planner(start, goal)).collect()
    };
    let octile = answers(ours(GridSearch::dijkstra(&map.grid)));
    let any_angle = answers(ours(AnyAngle::new(&map.grid)));
    let mut columns = Vec::new();
    for &(name, truth, make) in makers {
        let started = Instant::now();
        let mut planner = make(&map.grid);
        let prepare_ms = 1e3 * started.elapsed().as_secs_f64();
        let expected = match truth {
            Truth::Octile => Some(&octile),
            Truth::AnyAngle => Some(&any_angle),
            Truth::None => None,
        };
        let (mut times, mut different) = (Vec::new(), 0);
        for (index, &(start, goal)) in map.queries.iter().enumerate() {
            let (mut fastest, mut cost) = (f64::INFINITY, 0.0);
            for _ in 0..repeat {
                let started = Instant::now();
                cost = std::hint::black_box(planner(start, goal));
                fastest = fastest.min(1e6 * started.elapsed().as_secs_f64());
            }
            let wrong = expected.is_some_and(|costs| !((costs[index] - cost).abs() <= 1e-4 * costs[index] + 1e-6));
            // A peer may err; what this library says must be right before it is timed.
            assert!(!wrong || name == "polyanya", "{name}: {cost} for {:?} on {}", expected.map(|c| c[index]), map.name);
            different += usize::from(wrong);
            times.push(fastest);
        }
        times.sort_by(f64::total_cmp);
        columns.push(Column { name, truth, median: times[times.len() / 2], prepare_ms, different });
    }
    debug_assert!(columns.iter().all(|column| column.truth != Truth::Octile || column.different == 0));
    columns
}

/// How the planners of this library grow.
fn scaling(queries: usize, repeat: usize) {
    let makers: Vec<Maker> =
        ALL.into_iter().filter(|maker| ["A*", "jump points", "prepared jumps", "any angle, cold", "quadtree"].contains(&maker.0)).collect();
    for size in [256, 512, 1024, 2048, 4096] {
        for map in maps::own(size, queries) {
            println!("{}", map.name);
            for column in compare(&map, &makers, repeat) {
                println!("  {:<18}{:>10.1} us, prepared in {:.1} ms", column.name, column.median, column.prepare_ms);
            }
            let (time, leaves) = decompose(&map.grid);
            println!("  {:<18}{time:>10.1} us, {leaves} leaves", "decomposition");
        }
    }
}

fn decomposition() {
    println!("\ndecomposition of 1024 x 1024 cells into a quadtree, leaves listed:");
    for map in maps::own(1024, 1) {
        let (time, leaves) = decompose(&map.grid);
        println!("  {:<18}{time:>10.1} us, {leaves} leaves", map.name);
    }
}

/// Microseconds at best, and the number of leaves.
fn decompose(grid: &BitGrid) -> (f64, usize) {
    let mut fastest = f64::INFINITY;
    let mut leaves = 0;
    for _ in 0..9 {
        let started = Instant::now();
        let mut count = 0;
        std::hint::black_box(Quadtree::new(grid)).visit(|leaf, free| count += usize::from(free && leaf.size > 0));
        leaves = std::hint::black_box(count);
        fastest = fastest.min(1e6 * started.elapsed().as_secs_f64());
    }
    (fastest, leaves)
}
