//! Turning towards motion (book, section 11.5), and detecting it while turning (section 11.6).

#[cfg(test)]
mod tests;
mod watch;

pub use watch::{MotionWatch, MotionWatchObservation, MotionWatchParameters};
