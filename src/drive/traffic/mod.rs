//! Driving in traffic (book, chapter 13): the referee.

mod referee;

pub use referee::{FreeDrive, FreeDriveRules, FreeDriveScore};
