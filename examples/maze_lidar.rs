//! A robot follows the left wall of a maze by a lidar, and draws the map of what it saw (book, section 9.4).
//!
//! `cargo run --release --example maze_lidar -- --help` lists the options.

mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "maze_drive/mod.rs"]
mod maze_drive;

fn main() -> std::process::ExitCode {
    common::main("maze_lidar", maze_drive::lidar)
}
