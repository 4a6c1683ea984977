//! Following the left wall through a maze, by distance sensors or lidar (book, sections 9.2 to 9.4).

mod cell_drive;
mod left_hand;
mod lidar_left;
mod place;
#[cfg(test)]
mod tests;

pub use cell_drive::{CellDrive, CellDriveParameters};
pub use left_hand::{LeftHand, LeftHandObservation, LeftHandOutcome, LeftHandParameters, Straight};
pub use lidar_left::{LidarLeft, LidarLeftObservation, LidarLeftParameters};
