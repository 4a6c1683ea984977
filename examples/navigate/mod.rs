//! What the example `navigate` is made of.

#![allow(dead_code, unused_imports, reason = "example and tests use their own parts of this")]

mod args;
mod campaign;
mod course;
mod drive;
mod job;
mod picture;

pub(crate) use args::Args;
pub(crate) use campaign::{Trial, campaign, trials};
pub(crate) use job::work;
