//! What the examples `maze_left`, `maze_lidar` and `maze_explore` are made of.

#![allow(dead_code, unused_imports, reason = "each example uses its own part of this")]

mod explore;
mod left;
mod lidar;
mod place;

pub(crate) use explore::{ExploreArgs, explore};
pub(crate) use left::{LeftArgs, left};
pub(crate) use lidar::{LidarArgs, lidar};

/// The example `maze_left`.
pub(crate) mod maze_left {
    pub(crate) use super::left::left as work;
}

/// The example `maze_lidar`.
pub(crate) mod maze_lidar {
    pub(crate) use super::lidar::lidar as work;
}

/// The example `maze_explore`.
pub(crate) mod maze_explore {
    pub(crate) use super::explore::explore as work;
}
