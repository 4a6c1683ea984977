//! A round robot with five limbs learns to walk (book, chapter 12).
//!
//! `cargo run --release --example starman -- --help` lists the options.

mod common;
#[path = "starman/mod.rs"]
mod starman;

fn main() -> std::process::ExitCode {
    starman::work_for_another().unwrap_or_else(|| common::main("starman", starman::work))
}
