//! Navigation in a known world (book, section 10.3 and after): a robot plans, drives, and plans anew when the world is not
//! as it was told.
//!
//! `cargo run --release --example navigate -- --help` lists the options.

mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "navigate/mod.rs"]
mod navigate;

fn main() -> std::process::ExitCode {
    common::main("navigate", navigate::work)
}
