//! Driving in traffic (book, chapter 13), and who judges it.

mod referee;

pub use referee::{FreeDrive, FreeDriveRules, FreeDriveScore};
