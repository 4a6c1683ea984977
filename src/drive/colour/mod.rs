//! Driving by colour (book, section 11.4 and the tasks of 11.6): to an object that a
//! [`ColourFinder`](crate::vision::ColourFinder) finds, and pushing it home.

mod camera;
mod home;
mod observation;
mod scan_memory;
mod steering;
#[cfg(test)]
mod tests;
mod tracker;

pub use home::{HomePhase, PushHome, PushHomeParameters, PushOutcome};
pub use observation::ColourObservation;
pub use tracker::{ColourOutcome, ColourPhase, ColourTracker, ColourTrackerParameters};
