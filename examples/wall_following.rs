//! Wall following (book, chapter 6): by three distance sensors, by a PID controller, by a lidar, and as the book does it.
//!
//! `cargo run --release --example wall_following -- --help` lists the options.

mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "wall_following/mod.rs"]
mod wall_following;

fn main() -> std::process::ExitCode {
    common::main("wall_following", wall_following::work)
}
