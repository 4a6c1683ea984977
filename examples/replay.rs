//! Recordings of runs: replays them, shows what is in them, saves what is left of damaged ones.
//!
//! `cargo run --release --example replay -- --help` lists the commands.

#[path = "a_to_b/mod.rs"]
mod a_to_b;
#[path = "ackermann/mod.rs"]
mod ackermann;
#[path = "bug_compare/mod.rs"]
mod bug_compare;
#[path = "camera/mod.rs"]
mod camera;
#[path = "color_tracking/mod.rs"]
mod color_tracking;
mod common;
#[path = "cone_drive/mod.rs"]
mod cone_drive;
#[path = "cone_race/mod.rs"]
mod cone_race;
#[path = "cones/mod.rs"]
mod cones;
#[path = "coverage/mod.rs"]
mod coverage;
#[path = "distbug/mod.rs"]
mod distbug;
#[path = "driving/mod.rs"]
mod driving;
#[path = "edges/mod.rs"]
mod edges;
#[path = "follow_me/mod.rs"]
mod follow_me;
#[path = "genetic/mod.rs"]
mod genetic;
#[path = "lidar_scan/mod.rs"]
mod lidar_scan;
#[path = "localise/mod.rs"]
mod localise;
#[path = "maze_drive/mod.rs"]
mod maze_drive;
#[path = "micromouse/mod.rs"]
mod micromouse;
#[path = "motion/mod.rs"]
mod motion;
#[path = "navigate/mod.rs"]
mod navigate;
#[path = "omni/mod.rs"]
mod omni;
#[path = "common/programs.rs"]
mod programs;
#[path = "random_drive/mod.rs"]
mod random_drive;
#[path = "replay/mod.rs"]
mod replay;
#[path = "room/mod.rs"]
mod room;
#[path = "safety/mod.rs"]
mod safety;
#[path = "starman/mod.rs"]
mod starman;
#[path = "wall_following/mod.rs"]
mod wall_following;

fn main() -> std::process::ExitCode {
    replay::main()
}
