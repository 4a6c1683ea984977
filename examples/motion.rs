//! Seeing motion (book, section 11.5): a robot that watches, and turns to what moves.
//!
//! `cargo run --release --example motion -- --help` lists the options.

mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "motion/mod.rs"]
mod motion;

fn main() -> std::process::ExitCode {
    common::main("motion", motion::work)
}
