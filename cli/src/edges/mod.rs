//! The command `edges`.

mod args;
mod checks;
mod colour;
mod file;
mod kernel;
mod live;
mod marks;
mod parameters;

pub(crate) use args::{Args, Definition};
pub(crate) use kernel::{Kernel, Processed};

use crate::common::{Failure, Report};

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    checks::check(args)?;
    match &args.input {
        Some(input) => file::work(args, input),
        None => live::work(args),
    }
}
