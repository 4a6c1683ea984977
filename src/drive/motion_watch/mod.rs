//! Turning towards motion (book, section 11.5), and detecting it while turning and while driving (section
//! 11.6).

mod approach;
#[cfg(test)]
mod tests;
mod watch;

pub use approach::{ApproachOutcome, MotionApproach, MotionApproachParameters};
pub use watch::{MotionWatch, MotionWatchObservation, MotionWatchParameters};
