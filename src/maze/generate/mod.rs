//! Random mazes: perfect, braided, and by competition rules; with the feature `testing` also strategies for
//! property tests.

mod carve;
mod competition;
#[cfg(any(test, feature = "testing"))]
mod strategy;

pub use carve::{braided, perfect};
pub use competition::competition;
#[cfg(any(test, feature = "testing"))]
pub use strategy::{braided_mazes, mazes, partly_known, sparse_mazes};
