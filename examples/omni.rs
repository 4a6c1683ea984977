//! A robot on Mecanum wheels drives in a square without turning, or straight while it spins (book, sections 7.2 and 7.4).
//!
//! `cargo run --release --example omni -- --help` lists the options.

mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "omni/mod.rs"]
mod omni;

fn main() -> std::process::ExitCode {
    common::main("omni", omni::work)
}
