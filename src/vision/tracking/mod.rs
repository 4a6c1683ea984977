//! Driving by colour (book, section 11.4 and the tasks of 11.6): teaching a hue, finding what has it, driving there, and
//! pushing it home.

mod finder;
mod home;
mod observation;
mod scan_memory;
mod steering;
#[cfg(test)]
mod tests;
mod tracker;

pub use finder::{ColourFinder, FindMethod, Sighting, teach_hue};
pub use home::{HomeParameters, HomePhase, PushHome, PushOutcome};
pub use observation::{CameraGeometry, ColourObservation};
pub use tracker::{ColourOutcome, ColourPhase, ColourTracker, TrackerParameters};
