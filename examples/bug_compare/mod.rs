//! What the example `bug_compare` is made of.

#![allow(dead_code, unused_imports, reason = "the tests use their own part of this")]

mod args;
mod boundaries;
mod campaign;
mod contest;
mod job;
mod picture;
mod ride;
mod statistics;
mod table;

pub(crate) use args::Args;
pub(crate) use boundaries::{Boundaries, Boundary};
pub(crate) use campaign::{Checked, check};
pub(crate) use contest::{Entry, Setting, entries};
pub(crate) use job::work;
pub(crate) use ride::{Conditions, Ending, Ride, ride};
pub(crate) use statistics::{Interval, interval};
