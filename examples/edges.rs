//! Edges, colours and lines (book, sections 11.2 to 11.4): any kernel of `roverlab::vision` on an image file, or live on
//! the robot's display.
//!
//! `cargo run --release --example edges -- --help` lists the options.

mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "edges/mod.rs"]
mod edges;
#[path = "room/mod.rs"]
mod room;

fn main() -> std::process::ExitCode {
    common::main("edges", edges::work)
}
