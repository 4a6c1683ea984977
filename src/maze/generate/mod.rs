//! Random mazes: perfect, braided, and such as competitions have, with strategies for property tests.
//!
//! Part of the library with the feature `proptest`.

mod carve;
mod competition;
mod strategy;

pub use carve::{braided, perfect};
pub use competition::competition;
pub use strategy::{braided_mazes, mazes, partly_known, sparse_mazes};
