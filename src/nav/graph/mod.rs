//! Shortest paths in graphs (book, section 10.6).
//!
//! [`shortest_path`] searches anything that can list the neighbours of a node. With the feature `petgraph`,
//! `petgraph_shortest_path` searches any graph of that crate, and `petgraph_of_grid` makes one of a grid. Both
//! searches are A\*, and Dijkstra's algorithm if the estimate is 0. Costs are floating-point numbers, and handled with care: a cost that is no number or negative is an error that
//! names it, and equal ones are taken in the order in which they were found.

mod search;
#[cfg(test)]
mod tests;
#[cfg(feature = "petgraph")]
mod with_petgraph;

pub use search::{GraphError, GraphPath, GraphStep, shortest_path};
#[cfg(feature = "petgraph")]
pub use with_petgraph::{petgraph_of_grid, petgraph_shortest_path};
