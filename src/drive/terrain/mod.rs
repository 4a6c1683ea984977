//! Driving on hills (book, section 7.4): steepest ascent.

mod ascent;
mod slope_sensor;

pub use ascent::{Ascent, AscentObservation, AscentOutcome, AscentParameters};
pub use slope_sensor::SlopeSensor;
