//! The search for the highest place that a robot can reach (book, section 7.4).

mod align;
mod parameters;
mod reckoning;
mod search;
mod sight_map;
mod sweep;

pub use parameters::{Fence, SummitParameters};
pub use search::{SummitObservation, SummitOutcome, SummitPhase, SummitSearch};
