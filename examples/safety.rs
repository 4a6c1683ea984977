//! A racing car under its safety system (book, sections 14.2 and 14.3): stops of all kinds, and what it takes to go on.
//!
//! `cargo run --release --example safety -- --help` lists the options.

mod common;
#[path = "cones/mod.rs"]
mod cones;
#[path = "safety/mod.rs"]
mod safety;

fn main() -> std::process::ExitCode {
    common::main("safety", safety::work)
}
