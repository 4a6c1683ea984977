//! The bug family compared (book, section 10.1): the path lengths of all algorithms in worlds that are hard in one way
//! each, and their verdicts against the truth.
//!
//! `cargo run --release --example bug_compare -- --help` lists the options.

#[path = "bug_compare/mod.rs"]
mod bug_compare;
mod common;

fn main() -> std::process::ExitCode {
    common::main("bug_compare", bug_compare::work)
}
