//! Random mazes: perfect, braided, and such as competitions have; with the feature `testing` strategies for
//! property tests too.

mod carve;
mod competition;
#[cfg(any(test, feature = "testing"))]
mod strategy;

pub use carve::{braided, perfect};
pub use competition::competition;
#[cfg(any(test, feature = "testing"))]
pub use strategy::{braided_mazes, mazes, partly_known, sparse_mazes};
