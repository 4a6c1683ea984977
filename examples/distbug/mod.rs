//! What the example `distbug` and the campaign share: the behaviour in a simulated world, watched.

#![allow(dead_code, unused_imports, reason = "the example and the campaign use different parts of this")]

mod args;
mod course;
mod drive;
mod job;
mod picture;

pub(crate) use args::Args;
pub(crate) use course::scene;
pub(crate) use drive::{Drive, Ending, Event, Happening, Options, drive};
pub(crate) use job::work;
