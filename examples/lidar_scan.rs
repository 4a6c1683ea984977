//! A lidar scan on the display, and the walls, corners and objects in it (book, sections 4.1 and 4.2).
//!
//! `cargo run --release --example lidar_scan -- --help` lists the options.

mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "lidar_scan/mod.rs"]
mod lidar_scan;

fn main() -> std::process::ExitCode {
    common::main("lidar_scan", lidar_scan::work)
}
