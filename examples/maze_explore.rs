//! A robot with three distance sensors explores a whole maze by recursion, and then drives to the goal by the shortest way
//! and back (book, sections 9.5 to 9.7).
//!
//! `cargo run --release --example maze_explore -- --help` lists the options.

mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "maze_drive/mod.rs"]
mod maze_drive;

fn main() -> std::process::ExitCode {
    common::main("maze_explore", maze_drive::explore)
}
