//! Micromouse (book, chapter 9): reads a maze of any format and plans the way, or lets a robot explore it and then drive
//! as fast as it can.
//!
//! `cargo run --release --example micromouse -- --help` lists the options.

mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "micromouse/mod.rs"]
mod micromouse;

fn main() -> std::process::ExitCode {
    if micromouse::mms::is_wanted(std::env::args_os()) {
        return micromouse::mms::main().into();
    }
    common::main("micromouse", micromouse::work)
}
