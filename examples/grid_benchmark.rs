//! Planners on grid maps with known answers: how often they are right, and how fast.
//!
//! `cargo run --release --example grid_benchmark -- --help` lists the options.

mod common;
#[path = "grid_benchmark/mod.rs"]
mod grid_benchmark;

fn main() -> std::process::ExitCode {
    let (out, err) = (&mut std::io::stdout(), &mut std::io::stderr());
    common::run_printing(std::env::args_os(), out, err, grid_benchmark::work).into()
}
