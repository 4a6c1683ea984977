//! Planning on occupancy grids (book, sections 10.3 and 10.6).
//!
//! A map is a [`BitGrid`](crate::world::BitGrid), a query a start cell and a goal cell, and every planner is a
//! [`GridPlanner`]. A query that has no answer is told so at once: the planners know the connected regions of their map.
//!
//! | planner | paths | prepares |
//! |---|---|---|
//! | [`GridSearch`] | shortest octile, by Dijkstra's algorithm or A\* | nothing |
//! | [`JumpPointSearch`] | shortest octile | a few operations for each 64 cells |
//! | [`PreparedJumps`] | shortest octile | all jumps |
//!
//! *Octile* paths go from cell to cell, along edges and along diagonals whose both side cells are free.

mod components;
mod cost;
mod jump;
mod path;
mod queue;
mod steps;
#[cfg(test)]
mod tests;

pub use components::Components;
pub use jump::{JumpPointSearch, PreparedJumps};
pub use path::{End, GridPath, GridPlanner, PlanError, SearchStatistics};
pub use steps::{GridSearch, GridStep};
