//! What the commands `maze-left`, `maze_lidar` and `maze_explore` are made of.

mod explore;
mod left;
mod lidar;
mod place;

/// The command `maze-left`.
pub(crate) mod maze_left {
    pub(crate) use super::left::left as work;
}

/// The command `maze-lidar`.
pub(crate) mod maze_lidar {
    pub(crate) use super::lidar::lidar as work;
}

/// The command `maze-explore`.
pub(crate) mod maze_explore {
    pub(crate) use super::explore::explore as work;
}
