//! Driving over the whole floor (book, sections 3.1 and 6.3): a plan in lanes, and a map of the floor
//! covered.

mod lanes;
mod map;
mod plan;
mod route;
mod tour;

pub use map::{CoverageMap, CoverageMapParameters};
pub use plan::CoveragePlan;
pub use tour::{Tour, TourOutcome, TourParameters};
