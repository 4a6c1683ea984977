//! Motion detection (book, section 11.5), for a robot that stands, and for one that turns or drives (section
//! 11.6).

mod detector;
mod flow;
mod range;
#[cfg(test)]
mod tests;
mod turning;

pub use detector::{Motion, MotionDetector, MotionParameters};
pub use flow::{FlowDetector, FlowParameters};
pub use turning::{TurnCompensator, Turned};
