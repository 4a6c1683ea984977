//! What the examples that drive between cones share.

#![allow(dead_code, unused_imports, reason = "every example uses its own part of this")]

mod course;
mod judge;
mod options;

pub(crate) use course::{Course, Spoils, colour};
pub(crate) use judge::{Judge, pass};
pub(crate) use options::{check_campaign, check_race, refuse};
