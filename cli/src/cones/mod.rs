//! Shared parts of the commands that drive between cones.

mod course;
pub(crate) mod drawing;
mod judge;
mod options;

pub(crate) use course::{Course, Spoils};
pub(crate) use judge::{Judge, Passed, judged, pass};
pub(crate) use options::{check_campaign, check_race, refuse};
