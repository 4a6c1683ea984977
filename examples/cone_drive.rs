//! Drives between cones as the book prints it, steering for the nearest gap in one scan (section 14.5).
//!
//! `cargo run --release --example cone_drive -- --help` lists the options.

mod common;
#[path = "cone_drive/mod.rs"]
mod cone_drive;
#[path = "cones/mod.rs"]
mod cones;

fn main() -> std::process::ExitCode {
    common::main("cone_drive", cone_drive::work)
}
