//! Driving on hills (book, section 7.4): the steepest way up, and over ramps.

mod ascent;
mod edge_sensors;
mod ramp_crossing;
mod slope_sensor;

pub use ascent::{Ascent, AscentObservation, AscentOutcome, AscentParameters};
pub use edge_sensors::EdgeSensors;
pub use ramp_crossing::{RampCrossing, RampObservation, RampOutcome, RampParameters, RampStage};
pub use slope_sensor::SlopeSensor;
