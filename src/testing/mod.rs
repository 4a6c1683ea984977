//! Tools for testing your own planners and behaviours (feature `testing`): strategies that draw maps and
//! worlds, and checks for any planner.
//!
//! ```
//! use proptest::prelude::*;
//! use proptest::test_runner::TestRunner;
//! use roverlab::nav::grid::{AnyAngle, GridPlanner};
//! use roverlab::testing::{Movement, collision_free, complete, grid_queries, optimal, triangle_inequality};
//!
//! TestRunner::deterministic().run(&grid_queries(2..20, 2..20), |(grid, cells)| {
//!     // Any `GridPlanner`; `PlanWith` makes one of a closure.
//!     let mut planner = AnyAngle::new(&grid);
//!     for pair in cells.windows(2) {
//!         optimal(&mut planner, &grid, Movement::AnyAngle, pair[0], pair[1])?;
//!         collision_free(&mut planner, &grid, pair[0], pair[1])?;
//!         complete(&mut planner, &grid, pair[0], pair[1])?;
//!     }
//!     triangle_inequality(&mut planner, cells[0], cells[1], cells[2])?;
//!     Ok(())
//! }).unwrap();
//! ```

mod cases;
mod checks;
mod courses;
mod lines;
mod strategies;
#[cfg(test)]
mod tests;
mod tracks;

pub use cases::cases;
pub use checks::{Movement, PlanWith, Violation, collision_free, complete, optimal, triangle_inequality};
pub use courses::courses;
pub use strategies::{GridMaze, grid_queries, grids, mazes, pools, reliefs, worlds};
pub use tracks::cone_tracks;
