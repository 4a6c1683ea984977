//! Seeing motion (book, section 11.5): where in the image something moves, for a robot that stands, and for one that
//! turns (section 11.6).

mod detector;
mod turning;
mod watch;
#[cfg(test)]
mod tests;

pub use detector::{Motion, MotionDetector, MotionParameters};
pub use turning::TurnCompensator;
pub use watch::{MotionWatch, WatchParameters};
