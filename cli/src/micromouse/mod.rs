//! The command `micromouse`.

mod args;
mod campaign;
mod explore;
pub(crate) mod mms;
mod picture;
mod plan;
mod scene;

pub(crate) use args::Args;

use crate::common::{Failure, Report};

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    args.common.check_picture()?;
    if let Some(command) = &args.mms_run {
        return mms::run_program(args, command);
    }
    match &args.campaign {
        Some(folder) => campaign::campaign(args, folder),
        None if args.plan => plan::plan(args),
        None => explore::explore(args),
    }
}
