//! Where the robot is in a world that it knows, without being told where it started (book, section 4.3).
//!
//! `cargo run --release --example localise -- --help` lists the options.

mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "localise/mod.rs"]
mod localise;

fn main() -> std::process::ExitCode {
    common::main("localise", localise::work)
}
