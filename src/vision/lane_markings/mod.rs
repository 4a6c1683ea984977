//! Lane detection by camera (book, chapter 13): markings on the ground, and the road that they belong to.
//!
//! [`MarkingFilter`] finds bright points of a line's width, in rows of the ground. [`LaneMarkingFinder`] fits
//! a road to these points: parallel lines, some of which may be invisible, with varying curvature. It tracks
//! the road and its covariance while the car drives. Lengths are those of the actual road;
//! [`RoadModel::size`] is its scale relative to the rules.

mod camera;
mod curve;
mod filter;
mod finder;
mod model;
#[cfg(test)]
mod tests;

pub(in crate::vision) use camera::Projection;
pub use camera::RoadCamera;
pub use filter::{MarkingFilter, MarkingPoint};
pub(in crate::vision) use finder::RoadAhead;
pub use finder::{LaneEstimate, LaneMarkingFinder, RoadModel};
