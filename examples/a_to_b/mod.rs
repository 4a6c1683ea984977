//! What the example `a_to_b` is made of.

#![allow(dead_code, unused_imports, reason = "example and tests use their own parts of this")]

mod args;
mod campaign;
mod chase;
mod drive;
mod job;
mod picture;
mod scene;
mod table;

pub(crate) use args::Args;
pub(crate) use campaign::{Kind, Row, campaign, rows};
pub(crate) use drive::{Arrival, Options, drive};
pub(crate) use job::work;
pub(crate) use table::text;
