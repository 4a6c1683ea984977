//! Craft in water (book, chapter 8): diving to a depth and holding it.
//!
//! - [`Dive`]: to a depth, and there level on a heading, by pressure sensor and inertial unit;
//! - [`DepthHold`]: the controller of depth inside it;
//! - [`Thrust`]: what a behaviour tells a craft's thrusters.

mod depth_hold;
mod dive;

pub use depth_hold::{DepthHold, DepthHoldParameters};
pub use dive::{Dive, DiveObservation, DiveOutcome, DiveParameters, Thrust};
