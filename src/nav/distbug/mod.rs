//! DistBug, the sensor-based way to a goal with a proof when there is none (book, sections 10.1 and 10.2).

mod behaviour;
mod parameters;
mod progress;
mod report;

pub use behaviour::DistBug;
pub use parameters::DistBugParameters;
pub use report::{DistBugEvent, DistBugObservation, DistBugOutcome, DistBugPhase};
