//! What the example `localise` is made of.

#![allow(dead_code, unused_imports, reason = "example and tests use their own parts of this")]

mod campaign;
mod drive;
mod job;
mod picture;
mod worlds;

pub(crate) use campaign::{Row, campaign, rows, text};
pub(crate) use drive::{Finding, Options, drive};
pub(crate) use job::{Args, work};
