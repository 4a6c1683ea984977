//! What all examples share: their command line, the report that they print, and the way they end.
//!
//! An example is a `main` of a few lines and a function that does the work:
//!
//! ```ignore
//! #[derive(Debug, clap::Parser)]
//! #[command(about = "Drives to a goal among unknown obstacles", after_help = "JSON fields: hit_points, leave_points")]
//! struct Args {
//!     // The example's own options come first, so that `--help` lists them apart from the common ones.
//!     #[command(flatten)]
//!     common: CommonArgs,
//! }
//!
//! impl AsRef<CommonArgs> for Args {
//!     fn as_ref(&self) -> &CommonArgs {
//!         &self.common
//!     }
//! }
//!
//! fn main() -> std::process::ExitCode {
//!     common::main("distbug", |args: &Args| {
//!         // ... simulate, draw the picture ...
//!         Ok(Report::new(Outcome::verdict("reached")).field("hit_points", 3))
//!     })
//! }
//! ```

#![allow(dead_code, unused_imports, reason = "every example uses its own part of this")]

mod args;
mod failure;
mod report;
mod run;
mod trip;
mod values;
mod wall_clock;

pub(crate) use args::CommonArgs;
pub(crate) use failure::Failure;
pub(crate) use report::{Outcome, Report, millimetres, point_in_mm, rounded};
pub(crate) use run::{Printed, main, run, run_printing};
pub(crate) use trip::Trip;
pub(crate) use values::{
    GoalOption, parse_goal, parse_noise, parse_picture, parse_point, parse_pose, parse_seconds,
};
pub(crate) use wall_clock::{Pacer, Progress, Stopwatch};
