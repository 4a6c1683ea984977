//! Motion detection (book, section 11.5), for a robot that stands and for one that turns (section 11.6).

mod detector;
mod range;
#[cfg(test)]
mod tests;
mod turning;

pub use detector::{Motion, MotionDetector, MotionParameters};
pub use turning::{TurnCompensator, Turned};
