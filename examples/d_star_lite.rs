//! D* Lite (after the book's section 10.6): a robot plans with a map that lacks a wall, sees the wall on its
//! way, and repairs its plan. What does not change is not searched again.
//!
//! `cargo run --release --example d_star_lite`

use roverlab::geometry::Pose;
use roverlab::nav::grid::{DStarLite, GridPlanner, GridSearch};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::{BitGrid, GridCell};

/// Metres along a cell's edge, for the picture, and the cells that the robot sees around itself.
const CELL: f64 = 0.1;
const SIGHT: usize = 4;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The true map has a trap, open to the left, of which the robot's map knows nothing.
    let is_trap = |column: usize, row: usize| {
        (column == 30 && (6..=24).contains(&row)) || ([6, 24].contains(&row) && (18..=30).contains(&column))
    };
    let real = BitGrid::from_fn(50, 30, |column, row| !is_trap(column, row))?;
    let known = BitGrid::from_fn(50, 30, |_, _| true)?;
    let (start, goal) = (GridCell::new(3, 15), GridCell::new(46, 14));

    let mut planner = DStarLite::new(&known, start, goal)?;
    let mut path = planner.plan()?;
    println!("first plan: {:.1} cells, {} nodes expanded", path.cost, path.statistics.expanded);
    let (mut robot, mut driven, mut way, mut repairs, mut repaired) = (start, 0.0, vec![start], 0, 0);
    while robot != goal {
        let mut changed = false;
        for column in robot.column.saturating_sub(SIGHT)..=robot.column + SIGHT {
            for row in robot.row.saturating_sub(SIGHT)..=robot.row + SIGHT {
                let cell = GridCell::new(column, row);
                if real.contains(cell) && real.is_free(cell) != planner.grid().is_free(cell) {
                    planner.set_free(cell, real.is_free(cell));
                    changed = true;
                }
            }
        }
        path = planner.plan()?;
        if changed {
            repairs += 1;
            repaired += path.statistics.expanded;
        }
        // One step along the plan.
        let next = GridCell::at(path.points[1]).ok_or("the path leaves the map")?;
        driven += (next.centre() - robot.centre()).norm();
        planner.move_to(next)?;
        robot = next;
        way.push(robot);
    }

    let shortest = GridSearch::astar(&real).plan(start, goal)?;
    // What planning from scratch at every change would take.
    let anew = GridSearch::dijkstra(&real).plan(start, goal)?.statistics.expanded * repairs;
    println!("{repairs} repairs, {repaired} nodes expanded in all; from scratch by Dijkstra about {anew}");
    println!("driven {driven:.1} cells; who knew the trap would drive {:.1}", shortest.cost);
    assert!(way.iter().all(|&cell| real.is_free(cell)) && repaired < anew);
    assert!(driven >= shortest.cost && driven < 2.0 * shortest.cost);

    let mut picture = Picture::new(&real.to_occupancy(CELL, Pose::default())?.to_world());
    picture.title("D* Lite: into a trap and out again");
    picture.line(shortest.points.iter().map(|&point| point * CELL), Style::plan().labelled("shortest way"));
    picture.true_path(way.iter().map(|cell| cell.centre() * CELL));
    picture.mark(Mark::Start, start.centre() * CELL).mark(Mark::Goal, goal.centre() * CELL);
    picture.save("target/pictures/d_star_lite.svg")?;
    Ok(())
}
