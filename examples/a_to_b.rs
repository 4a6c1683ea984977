//! From A to B (book, sections 3.3 to 3.6): turning and driving straight, an arc, a dog curve, or a spline.
//!
//! `cargo run --release --example a_to_b -- --help` lists the options.

#[path = "a_to_b/mod.rs"]
mod a_to_b;
mod common;
#[path = "driving/mod.rs"]
mod driving;

fn main() -> std::process::ExitCode {
    common::main("a_to_b", a_to_b::work)
}
