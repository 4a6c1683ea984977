//! The lane that a camera sees (book, chapter 13): markings on the ground, and the road that they belong to.
//!
//! [`MarkingFilter`] looks at the image as if from above, and finds what is bright and as wide as a line. [`LaneFinder`] fits
//! one road to that: curves in parallel, whichever of them are to be seen, with curvatures that change along the way, and
//! tracks it with its covariance while the car drives. Sizes are those of the road; for one of a smaller scale,
//! [`RoadModel::size`] says so.

mod camera;
mod curve;
mod filter;
mod finder;
mod model;
#[cfg(test)]
mod tests;

pub use camera::RoadCamera;
pub use filter::{MarkingFilter, MarkingPoint};
pub use finder::{LaneEstimate, LaneFinder, RoadModel};
