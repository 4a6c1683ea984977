//! Quadtrees (book, sections 10.4 and 10.5).

mod boxes;
mod graph;
mod planner;
mod portals;
mod pull;
#[cfg(test)]
mod tests;
mod tree;

pub use boxes::{Edges, segment_meets_box};
pub use graph::{LeafGraph, LeafLink};
pub use planner::QuadtreePlanner;
pub use tree::{Leaf, Quadtree};
