//! What the robot sees (book, section 11.1): the camera's image, on its display and in a file.
//!
//! `cargo run --release --example camera -- --help` lists the options.

#[path = "camera/mod.rs"]
mod camera;
mod common;
#[path = "driving/mod.rs"]
mod driving;
#[path = "room/mod.rs"]
mod room;

fn main() -> std::process::ExitCode {
    common::main("camera", camera::work)
}
