//! What the example `micromouse` is made of.

#![allow(dead_code, unused_imports, reason = "example and tests use their own parts of this")]

mod args;
mod picture;
mod plan;
mod scene;

pub(crate) use args::Args;

use crate::common::{Failure, Report};

/// The work of the example.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    args.common.check_picture()?;
    plan::plan(args)
}
