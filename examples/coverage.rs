//! Driving over the whole floor in lanes (book, sections 3.1 and 6.3), and a map of what has been covered.
//!
//! `cargo run --release --example coverage -- --help` lists the options.

mod common;
#[path = "coverage/mod.rs"]
mod coverage;
#[path = "driving/mod.rs"]
mod driving;

fn main() -> std::process::ExitCode {
    common::main("coverage", coverage::work)
}
