//! A car drives to a goal within its turning circle (book, sections 7.1 and 7.4).
//!
//! `cargo run --release --example ackermann -- --help` lists the options.

#[path = "ackermann/mod.rs"]
mod ackermann;
mod common;
#[path = "driving/mod.rs"]
mod driving;

fn main() -> std::process::ExitCode {
    common::main("ackermann", ackermann::work)
}
