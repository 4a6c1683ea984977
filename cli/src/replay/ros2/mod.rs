//! Bags of ROS 2, as MCAP files: recordings exported to them, and imported from them.

mod bag;
mod cdr;
mod definitions;
mod export;
mod import;
mod messages;
#[cfg(test)]
mod tests;
mod tree;

pub(super) use export::export;
pub(super) use import::{Wanted, import};
