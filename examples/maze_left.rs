//! A robot keeps its left hand on the wall of a maze, by odometry alone or in the middle between the walls (book, sections
//! 9.2 and 9.3).
//!
//! `cargo run --release --example maze_left -- --help` lists the options.

mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "maze_drive/mod.rs"]
mod maze_drive;

fn main() -> std::process::ExitCode {
    common::main("maze_left", maze_drive::left)
}
