//! Random drive (book, section 3.1): one robot or several, which never touch each other.
//!
//! `cargo run --release --example random_drive -- --help` lists the options.

mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "random_drive/mod.rs"]
mod random_drive;

fn main() -> std::process::ExitCode {
    common::main("random_drive", random_drive::work)
}
