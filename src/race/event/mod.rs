//! Acceleration and skidpad: events whose layout every team knows before it sees the cones.
//!
//! A car knows at which event it is, and what the rules say of it, but neither where exactly it stands nor how the cones are set
//! up. It makes a map of the cones that it sees ([`ConeMap`](super::ConeMap)), fits the edges of the layout to the cones that it
//! saw lately ([`EventLayout`]), again at every look, and follows a line in the frame of that layout with a
//! [`LineTracker`](super::LineTracker), so that what odometry and map are wrong by does not add up.

mod course;
mod layout;
mod line;
mod racer;
mod referee;
#[cfg(test)]
mod tests;

pub use course::EventCourse;
pub use layout::{EventLayout, EventShape};
pub use racer::{EventParameters, EventPhase, EventRacer};
pub use referee::EventReferee;
