//! Driving through mazes: localisation, trajectory tracking and exploration (book, sections 9.3 and 9.8).
//!
//! Ends of walls and walls ahead reveal the robot's position. On a straight leg without either, only odometry
//! separates the cells: with a wheel error of 1 %, as in
//! [`NoiseModel::real`](crate::io::sim::NoiseModel::real), a leg of 24 cells or more may lead to a wrong map.

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
