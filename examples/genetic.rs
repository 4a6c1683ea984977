//! A genetic algorithm tunes something of the library (book, section 12.3).
//!
//! `cargo run --release --example genetic -- --help` lists the options.

mod common;
#[path = "genetic/mod.rs"]
mod genetic;

fn main() -> std::process::ExitCode {
    common::main("genetic", genetic::work)
}
