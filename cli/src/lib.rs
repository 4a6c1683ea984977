//! The program `roverlab`: every system of the library as a command.
//!
//! A command is a module with a command line and a work function; `common` contains the shared parts, and
//! `commands` lists them all.

mod a_to_b;
mod ackermann;
mod base_station;
mod boat;
mod bug_compare;
mod camera;
mod color_tracking;
mod commands;
mod common;
mod cone_drive;
mod cone_race;
mod cones;
mod coverage;
mod distbug;
mod dive;
mod driving;
mod edges;
mod end_to_end;
mod first_steps;
mod follow_me;
mod genetic;
#[cfg(feature = "native")]
mod grade;
mod grid_benchmark;
mod lane_keeping;
mod lidar_scan;
mod localise;
mod maze_drive;
mod merge;
mod micromouse;
mod motion;
mod navigate;
mod omni;
mod parking;
mod ping;
mod pool_search;
mod pool_wall;
mod quadtree;
mod ramp;
mod random_drive;
mod replay;
mod room;
mod safety;
mod signs;
#[cfg(feature = "native")]
mod starman;
mod summit;
mod survey;
mod terrain;
mod terrain_plan;
#[cfg(test)]
mod tests;
mod traffic;
#[cfg(feature = "view")]
mod view;
mod wall_following;
mod water;

#[cfg(feature = "native")]
pub use commands::main_at;
pub use commands::{Ended, main, options, run_words};
pub use common::Onlooker;
