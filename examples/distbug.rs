//! DistBug (book, sections 10.1 and 10.2): a robot with a lidar drives to a goal through a world that it does not know,
//! or finds that there is no way.
//!
//! `cargo run --release --example distbug -- --help` lists the options.

mod common;
#[path = "distbug/mod.rs"]
mod distbug;

fn main() -> std::process::ExitCode {
    common::main("distbug", distbug::work)
}
