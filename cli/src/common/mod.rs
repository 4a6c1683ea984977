//! Shared parts of all commands: command line, report and exit.
//!
//! A command consists of its options and a function `work`; `commands` lists it:
//!
//! ```ignore
//! #[derive(Debug, clap::Parser)]
//! #[command(about = "Drives to a goal among unknown obstacles", after_help = "JSON fields: hit_points, leave_points")]
//! struct Args {
//!     // The command's own options come first, so that `--help` lists them apart from the common ones.
//!     #[command(flatten)]
//!     common: CommonArgs,
//! }
//!
//! crate::common::shares_options!(Args, common: CommonArgs);
//!
//! // ... or with the options that it does not heed: `unheeded: [("always", &["fault"]), ("campaign", OF_ONE_RUN)]`.
//!
//! pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
//!     // ... simulate, draw the picture ...
//!     Ok(Report::new(Outcome::verdict("reached")).field("hit_points", 3))
//! }
//! ```
//!
//! # Recordings
//!
//! A command that takes its robots from a [`Stage`] can record and replay its runs:
//!
//! ```ignore
//! let stage = args.common.stage(&scene, SimOptions::with_noise(args.common.noise, args.common.seed))?;
//! let mut robot = stage.robot(0)?; // instead of `simulation.robot(0)`; --fault is in it
//! let mut truth = stage.truth(0)?; // instead of `simulation.truth()`: for verdicts and pictures
//! control::run(&mut robot, &mut behaviour, limit, |_, _, _| path.push(truth.pose(0)))?;
//! drop(robot); // lets go of the world, as a simulated robot does
//! let end = truth.robot(0)?;
//! ```
//!
//! With `--record` the stage records robot and truth, with `--replay` it creates them from a recording, and
//! without either it is the plain simulator. With several robots in threads, take all of them before the
//! first one drives, and give each thread its own truth, `stage.truth(index)`. Problems with a recording
//! reach the report automatically. Unrecorded runs, such as those of a campaign, use `Stage::simulated`.
//! Robots stepped in one thread come from `common.fleet(&scene, options)`, which is used like a `Fleet`.
//!
//! `replay check` finds the command of a recording in `commands`.
//!
//! The command line of a recorded run is stored in the recording, except for options that do not affect the
//! run; `--replay` reads it from there. File names are replaced by names in the recording. So a command reads
//! the file of its own option by `common.read("option", path)`, and the option must be in the list `FILES` of
//! `command_line`; `common.trip` does so for `--world` and `--robot`.

/// Gives access to the shared options of a command line, and declares its unsupported options.
macro_rules! shares_options {
    ($args:ty, $field:ident: $options:ty $(, unheeded: [$($unheeded:expr),* $(,)?])?) => {
        impl $crate::common::Heeds for $args {
            const UNHEEDED: &'static [$crate::common::Unheeded] = &[$($($unheeded),*)?];
        }

        impl AsRef<$options> for $args {
            fn as_ref(&self) -> &$options {
                &self.$field
            }
        }
    };
}

pub(crate) use shares_options;

mod args;
mod campaign;
mod command_line;
mod failure;
mod files;
mod free_floor;
mod heed;
mod images;
mod library;
pub(crate) mod onlooker;
mod origin;
mod outputs;
#[cfg(feature = "native")]
mod own_program;
mod parts;
mod report;
mod run;
mod stage;
mod supervision;
#[cfg(feature = "native")]
pub(crate) mod toml_places;
#[cfg(feature = "learn")]
mod training_store;
mod trip;
mod values;
#[cfg(feature = "view")]
mod view;
mod wall_clock;
mod workers;

pub(crate) use args::check_writable;
pub(crate) use args::{CommonArgs, PlainArgs};
pub(crate) use campaign::{CampaignArgs, campaign_report, wrong_seeds};
pub(crate) use command_line::is_setting;
pub(crate) use failure::Failure;
pub(crate) use files::{recording_bytes, regular_bytes, unrecordable};
pub(crate) use free_floor::FreeFloor;
pub(crate) use heed::{Heeds, OF_A_CAMPAIGN, OF_ONE_RUN, Unheeded};
pub(crate) use images::write_image;
pub use onlooker::Onlooker;
pub(crate) use origin::{Facts, Origin};
pub(crate) use outputs::is_same_file;
#[cfg(feature = "native")]
pub(crate) use own_program::{own_program, set_own_program};
pub(crate) use parts::{Header, OF_PARTS, PartArgs, Portable, field, fields, portable, unexpected};
pub(crate) use report::{Outcome, Report, millimetres, point_in_mm, rounded};
pub(crate) use run::{Printed, parser, refused, run, run_again, run_plain, run_printing, written};
pub(crate) use stage::{Claimed, Driven, Stage, StageTruth};
pub(crate) use supervision::DEADMAN;
#[cfg(feature = "learn")]
pub(crate) use training_store::TrainingStore;
pub(crate) use trip::{StandIn, Trip, at_goal};
pub(crate) use values::{
    GoalOption, parse_noise, parse_picture, parse_png, parse_point, parse_pose, parse_seconds,
};
#[cfg(feature = "view")]
pub(crate) use view::{announce, port_failure};
pub(crate) use wall_clock::{Pacer, Progress, Stopwatch};
pub(crate) use workers::{share_out, threads};
