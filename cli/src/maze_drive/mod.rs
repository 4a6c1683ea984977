//! The commands `maze-left`, `maze-lidar` and `maze-explore`.

pub(crate) mod explore;
pub(crate) mod left;
pub(crate) mod lidar;
mod place;
