//! Driving by colour (book, section 11.4): teaches the robot a hue, lets it find what has it, and push it home.
//!
//! `cargo run --release --example color_tracking -- --help` lists the options.

#[path = "color_tracking/mod.rs"]
mod color_tracking;
mod common;
#[path = "driving/mod.rs"]
mod driving;

fn main() -> std::process::ExitCode {
    common::main("color_tracking", color_tracking::work)
}
