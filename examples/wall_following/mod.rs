//! What the example `wall_following` is made of.

#![allow(dead_code, unused_imports, reason = "example and tests use their own parts of this")]

mod args;
mod campaign;
mod corners;
mod drive;
mod job;
mod measure;
mod picture;

pub(crate) use args::{Args, Controller};
pub(crate) use campaign::{Row, campaign, rows, text};
pub(crate) use drive::{Options, drive};
pub(crate) use job::work;
pub(crate) use measure::{Errors, Watch};
