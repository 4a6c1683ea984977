//! Robots that follow a robot (book, chapter 5): one, five with raised lidars, a chain, a formation by radio.
//!
//! `cargo run --release --example follow_me -- --help` lists the options.

mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "follow_me/mod.rs"]
mod follow_me;

fn main() -> std::process::ExitCode {
    common::main("follow_me", follow_me::work)
}
