//! Driving through mazes: where the robot is, how it keeps to its way, how it looks around (book, sections 9.3 and 9.8).

mod localiser;
mod look;
mod rig;
mod runner;
mod sight;
#[cfg(test)]
mod tests;
mod tracker;

pub use localiser::{Calibration, MazeLocaliser};
pub use rig::{Rig, Sensor, mouse};
pub use runner::{Exploration, MazeRunner, RunnerParameters};
pub use tracker::{Tracker, TrackerParameters};
