//! Shortest paths in graphs (book, section 10.6).
//!
//! [`shortest_path`] searches any graph that can list the neighbours of a node. With the feature `petgraph`,
//! `petgraph_shortest_path` searches graphs of that crate, and `petgraph_of_grid` makes one of a grid. Both
//! searches are A\*, or Dijkstra's algorithm with an estimate of 0. Costs are floating-point numbers: a NaN
//! or negative cost is an error that names its edge, and equal costs are taken in the order in which they
//! were found.

mod search;
#[cfg(test)]
mod tests;
#[cfg(feature = "petgraph")]
mod with_petgraph;

pub use search::{GraphError, GraphPath, GraphStep, shortest_path};
#[cfg(feature = "petgraph")]
pub use with_petgraph::{petgraph_of_grid, petgraph_shortest_path};
