//! The examples as wholes: one program of all their tests, which compiles what the examples are made of once.

#[path = "../../examples/a_to_b/mod.rs"]
mod a_to_b;
#[path = "../../examples/ackermann/mod.rs"]
mod ackermann;
#[path = "../../examples/bug_compare/mod.rs"]
mod bug_compare;
#[path = "../../examples/camera/mod.rs"]
mod camera;
#[path = "../../examples/color_tracking/mod.rs"]
mod color_tracking;
#[path = "../../examples/common/mod.rs"]
mod common;
#[path = "../../examples/cone_drive/mod.rs"]
mod cone_drive;
#[path = "../../examples/cone_race/mod.rs"]
mod cone_race;
#[path = "../../examples/cones/mod.rs"]
mod cones;
#[path = "../../examples/coverage/mod.rs"]
mod coverage;
#[path = "../../examples/distbug/mod.rs"]
mod distbug;
#[path = "../../examples/driving/mod.rs"]
mod driving;
#[path = "../../examples/edges/mod.rs"]
mod edges;
#[path = "../../examples/follow_me/mod.rs"]
mod follow_me;
#[path = "../../examples/genetic/mod.rs"]
mod genetic;
#[path = "../../examples/grid_benchmark/mod.rs"]
mod grid_benchmark;
#[path = "../../examples/lidar_scan/mod.rs"]
mod lidar_scan;
#[path = "../../examples/localise/mod.rs"]
mod localise;
#[path = "../../examples/maze_drive/mod.rs"]
mod maze_drive;
#[path = "../../examples/micromouse/mod.rs"]
mod micromouse;
#[path = "../../examples/motion/mod.rs"]
mod motion;
#[path = "../../examples/navigate/mod.rs"]
mod navigate;
#[path = "../../examples/omni/mod.rs"]
mod omni;
#[path = "../../examples/common/programs.rs"]
mod programs;
#[path = "../../examples/quadtree/mod.rs"]
mod quadtree;
#[path = "../../examples/random_drive/mod.rs"]
mod random_drive;
#[path = "../../examples/replay/mod.rs"]
mod replay;
#[path = "../../examples/room/mod.rs"]
mod room;
mod runs;
#[path = "../../examples/safety/mod.rs"]
mod safety;
#[path = "../../examples/starman/mod.rs"]
mod starman;
mod support;
#[path = "../../examples/wall_following/mod.rs"]
mod wall_following;
