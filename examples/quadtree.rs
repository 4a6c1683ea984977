//! Quadtrees (book, sections 10.4 and 10.5): a map is divided into squares until each is free or blocked all
//! over. Its few free leaves are searched instead of its many cells.
//!
//! `cargo run --release --example quadtree`

use roverlab::geometry::{Point, Pose, Vector};
use roverlab::nav::grid::{AnyAngle, GridPlanner, Quadtree, QuadtreePlanner};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::{BitGrid, GridCell};

/// Metres along a cell's edge, for the picture.
const CELL: f64 = 0.05;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let discs =
        [(14.0, 20.0, 7.0), (33.0, 40.0, 9.0), (46.0, 18.0, 6.0), (20.0, 50.0, 5.0), (52.0, 52.0, 4.0)];
    let is_free = |column, row| {
        let middle = GridCell::new(column, row).centre();
        discs.iter().all(|&(x, y, radius)| (middle - Point::new(x, y)).norm() > radius)
    };
    let grid = BitGrid::from_fn(64, 64, is_free)?;
    let tree = Quadtree::new(&grid);
    let leaves = tree.free_leaves();
    let cells: usize = leaves.iter().map(|leaf| leaf.size * leaf.size).sum();
    let links = tree.neighbour_graph().links.len();
    println!("{} free cells are {} free leaves with {links} common edges", grid.count_free(), leaves.len());
    for size in [32, 16, 8, 4, 2, 1] {
        println!(
            "{:4} leaves of {size:2} x {size:2} cells",
            leaves.iter().filter(|leaf| leaf.size == size).count()
        );
    }
    assert_eq!(cells, grid.count_free());

    let (start, goal) = (GridCell::new(2, 3), GridCell::new(60, 61));
    let path = QuadtreePlanner::new(&tree).plan(start, goal)?;
    let shortest = AnyAngle::new(&grid).plan(start, goal)?.cost;
    let expanded = path.statistics.expanded;
    println!("a path of {:.2} cells, {expanded} nodes expanded; the shortest has {shortest:.2}", path.cost);
    assert!(path.cost >= shortest - 1e-9 && path.cost < 1.05 * shortest);

    let mut picture = Picture::new(&grid.to_occupancy(CELL, Pose::default())?.to_world());
    picture.title("The free leaves of a quadtree, and a path through them");
    for leaf in leaves {
        let (corner, size) = (Point::new(leaf.column as f64, leaf.row as f64), leaf.size as f64);
        let square = [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)];
        let corners = square.map(|(x, y)| (corner + Vector::new(x, y)) * CELL);
        picture.polygon(corners, Style::aid().labelled("free leaf"));
    }
    picture.line(path.points.iter().map(|&point| point * CELL), Style::true_path().labelled("path"));
    picture.mark(Mark::Start, start.centre() * CELL).mark(Mark::Goal, goal.centre() * CELL);
    picture.save("target/pictures/quadtree.svg")?;
    Ok(())
}
