//! Drives over unknown hills (book, section 7.4): the search for the highest place that a robot can reach,
//! and the crossing of a level by two ramps.

mod align;
mod axis;
mod chart;
mod drive;
mod explorer;
mod parameters;
mod ramp;
mod reckoning;
mod relief;
mod search;
mod sight_map;
mod straight;
mod sweep;

pub use explorer::{SummitObservation, SummitPhase};
pub use parameters::{Fence, SummitParameters};
pub use ramp::{RampCrossing, RampLeg, RampOutcome};
pub use search::{SummitOutcome, SummitSearch};
