//! Recordings of runs: replays them, shows what is in them, saves what is left of damaged ones.
//!
//! `cargo run --release --example replay -- --help` lists the commands.

#[path = "a_to_b/mod.rs"]
mod a_to_b;
#[path = "ackermann/mod.rs"]
mod ackermann;
mod common;
#[path = "distbug/mod.rs"]
mod distbug;
#[path = "driving/mod.rs"]
mod driving;
#[path = "navigate/mod.rs"]
mod navigate;
#[path = "omni/mod.rs"]
mod omni;
#[path = "common/programs.rs"]
mod programs;
#[path = "replay/mod.rs"]
mod replay;
#[path = "wall_following/mod.rs"]
mod wall_following;

fn main() -> std::process::ExitCode {
    replay::main()
}
