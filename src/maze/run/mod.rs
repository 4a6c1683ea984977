//! Driving through mazes: where the robot is, how it keeps to its way, how it looks around (book, sections 9.3 and 9.8).
//!
//! A robot tells where it is by the ends of walls and by walls ahead. Along a leg without either, odometry alone must tell one
//! cell from the next: with wheels whose size is 1 % off, as in [`NoiseModel::real`](crate::io::sim::NoiseModel::real), a
//! straight leg of 24 cells or more may end in a wrong map.

mod localiser;
mod look;
mod rig;
mod runner;
mod sight;
#[cfg(test)]
mod tests;
mod tracker;

pub use localiser::{Calibration, MazeLocaliser};
pub use rig::{Rig, RigSensor, mouse};
pub use runner::{Exploration, MazeRunner, MazeRunnerParameters};
pub use tracker::{TrajectoryTracker, TrajectoryTrackerParameters};
