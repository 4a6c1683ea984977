//! Whole runs, by system.

mod bug_compare;
mod common_cli;
mod cones;
mod distbug;
mod distbug_campaign;
mod driving;
mod evolution;
mod grids;
mod heed;
mod hills;
mod lane_keeping;
mod lidar;
mod maze_drives;
mod mazes;
mod navigate;
mod quadtree;
mod recordings;
mod safety;
mod seeing;
mod support;
mod swarms;
mod wall_following;
mod waters;
