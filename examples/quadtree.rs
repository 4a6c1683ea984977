//! Quadtrees of maps (book, sections 10.4 and 10.5).
//!
//! `cargo run --release --example quadtree -- --help` lists the options.

mod common;
#[path = "quadtree/mod.rs"]
mod quadtree;

fn main() -> std::process::ExitCode {
    let (out, err) = (&mut std::io::stdout(), &mut std::io::stderr());
    common::run_printing(std::env::args_os(), out, err, quadtree::work).into()
}
