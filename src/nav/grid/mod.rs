//! Planning on occupancy grids (book, sections 10.3 and 10.6).
//!
//! A map is a [`BitGrid`](crate::world::BitGrid), a query a start cell and a goal cell, and every planner is
//! a [`GridPlanner`]. Planners know the connected regions of their map, so a query without an answer fails at
//! once.
//!
//! | planner | paths | prepares |
//! |---|---|---|
//! | [`GridSearch`] | shortest octile, by Dijkstra's algorithm or A\* | nothing |
//! | [`JumpPointSearch`] | shortest octile | a few operations for each 64 cells |
//! | [`PreparedJumps`] | shortest octile | all jumps, up to 8 million |
//! | [`AnyAngle`] | shortest of all, in any direction | what corners see, at first need or all at once |
//! | [`LazyThetaStar`] | short, in any direction | nothing |
//! | [`QuadtreePlanner`] | short, in any direction | a [`Quadtree`], and which of its leaves are neighbours |
//!
//! [`GridSearch`] and [`DStarLite`] also plan by [`StepCosts`]: [`elevation`](super::elevation) does so on
//! hills.
//!
//! [`DStarLite`] repairs its plan while the map changes. [`inflated`] inflates a map by a robot's outline,
//! [`DistanceField`] computes the distance to obstacles.
//!
//! *Octile* paths go from cell to cell, along edges and along diagonals with both side cells free.

mod any_angle;
mod components;
mod cost;
mod distance;
mod dstar_lite;
mod inflate;
mod jump;
mod path;
mod quadtree;
mod queue;
mod steps;
#[cfg(test)]
mod tests;

pub use any_angle::{AnyAngle, LazyThetaStar};
pub use components::GridComponents;
pub use cost::{StepCosts, UniformCost};
pub use distance::DistanceField;
pub use dstar_lite::DStarLite;
pub use inflate::inflated;
pub use jump::{JumpPointSearch, PreparedJumps};
pub use path::{End, GridPath, GridPlanner, PlanError, SearchStatistics};
pub use quadtree::{Edges, Leaf, LeafGraph, LeafLink, Quadtree, QuadtreePlanner, segment_meets_box};
pub use steps::{GridSearch, GridStep};
