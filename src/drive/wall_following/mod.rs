//! Following walls (book, chapter 6): by distance sensors alone, by a PID controller, by a lidar, and the book's own
//! program.

mod memory;
mod parameters;
mod pid;
mod psd;
mod run;
mod scan;
#[cfg(test)]
mod tests;
mod tracker;
mod two_level;

pub use parameters::{WallFollowerParameters, WallObservation, WallSensors, WallSide};
pub use pid::{PidWallFollower, PidWallParameters};
pub use psd::{WallFollower, WallPhase};
pub use run::{AlongWall, AlongWallObservation, FollowsWalls, WallOutcome, WallReading};
pub use scan::{LidarWallFollower, LidarWallParameters};
pub use two_level::TwoLevelWallFollower;
