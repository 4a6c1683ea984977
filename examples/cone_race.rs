//! Races between cones on a track that the car does not know (book, section 14.5).
//!
//! `cargo run --release --example cone_race -- --help` lists the options.

mod common;
#[path = "cone_race/mod.rs"]
mod cone_race;
#[path = "cones/mod.rs"]
mod cones;

fn main() -> std::process::ExitCode {
    common::main("cone_race", cone_race::work)
}
