//! DistBug on many generated courses: how often its verdict is the truth.
//!
//! `cargo run --release --example distbug_campaign -- --help` lists the options.

mod common;
#[path = "distbug/mod.rs"]
mod distbug;

fn main() -> std::process::ExitCode {
    let (out, err) = (&mut std::io::stdout(), &mut std::io::stderr());
    common::run_printing(std::env::args_os(), out, err, distbug::campaign).into()
}
