//! Wall following (book, chapter 6): by distance sensors, by a PID controller, by a lidar, and the book's own
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

pub use crate::geometry::WallSide;
pub use parameters::{WallFollowerParameters, WallObservation, WallSensors};
pub use pid::{PidWallFollower, PidWallFollowerParameters};
pub use psd::{WallFollower, WallPhase};
pub use run::{AlongWall, AlongWallObservation, FollowsWalls, WallOutcome, WallReading};
pub use scan::{LidarWallFollower, LidarWallFollowerParameters};
pub use two_level::TwoLevelWallFollower;
