//! Pure geometry of drives: from wheel motions to robot motions and back, and exact integration over a step.

mod differential;
mod integrate;

pub use differential::{Differential, WheelSpeeds};
pub use integrate::{Displacement, advance};
