//! Planning on a grid (book, section 10.6): Dijkstra, A*, jump point search and any-angle search from the
//! same cell to the same cell. The first three agree on the shortest way over cells; the last one is free of
//! the grid's eight directions.
//!
//! `cargo run --release --example grid_planning`

use roverlab::geometry::{Point, Pose};
use roverlab::nav::grid::{AnyAngle, GridPlanner, GridSearch, JumpPointSearch, LazyThetaStar};
use roverlab::picture::{Mark, Picture, SERIES, Style};
use roverlab::random::Stream;
use roverlab::world::{BitGrid, GridCell};

/// Metres along a cell's edge, for the picture.
const CELL: f64 = 0.05;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Discs at random, none over start or goal.
    let mut random = Stream::new(1);
    let discs: Vec<(Point, f64)> = (0..40)
        .map(|_| {
            (Point::new(random.between(12.0, 108.0), random.between(5.0, 75.0)), random.between(2.0, 7.0))
        })
        .collect();
    let is_free = |column, row| {
        let middle = GridCell::new(column, row).centre();
        discs.iter().all(|(centre, radius)| (middle - centre).norm() > *radius)
    };
    let grid = BitGrid::from_fn(120, 80, is_free)?;
    let (start, goal) = (GridCell::new(3, 5), GridCell::new(115, 72));
    println!("{} of {} cells are free\n", grid.count_free(), grid.width() * grid.height());

    let mut planners: [(&str, Box<dyn GridPlanner>); 5] = [
        ("Dijkstra", Box::new(GridSearch::dijkstra(&grid))),
        ("A*", Box::new(GridSearch::astar(&grid))),
        ("jump points", Box::new(JumpPointSearch::new(&grid))),
        ("Lazy Theta*", Box::new(LazyThetaStar::new(&grid))),
        ("any angle", Box::new(AnyAngle::new(&grid))),
    ];
    let mut picture = Picture::new(&grid.to_occupancy(CELL, Pose::default())?.to_world());
    picture.title("Over cells, and at any angle").mark(Mark::Start, metres(start.centre()));
    picture.mark(Mark::Goal, metres(goal.centre()));
    let mut costs = Vec::new();
    println!("{:12} {:>12} {:>16}", "planner", "cost (cells)", "nodes expanded");
    for (name, planner) in &mut planners {
        let path = planner.plan(start, goal)?;
        println!("{name:12} {:>12.2} {:>16}", path.cost, path.statistics.expanded);
        if ["A*", "any angle"].contains(name) {
            let style = Style::new(SERIES[costs.len() % 4]).labelled(*name);
            picture.line(path.points.iter().map(|&point| metres(point)), style);
        }
        costs.push(path.cost);
    }
    let [dijkstra, astar, jumps, theta, any_angle] = costs[..] else { return Err("five costs".into()) };
    assert!((dijkstra - astar).abs() < 1e-9 && (dijkstra - jumps).abs() < 1e-9);
    assert!(any_angle <= theta && theta < dijkstra);
    picture.save("target/pictures/grid_planning.svg")?;
    Ok(())
}

/// A place given in cells.
fn metres(place: Point) -> Point {
    place * CELL
}
