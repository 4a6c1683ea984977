use std::num::NonZero;
use std::path::PathBuf;

use super::trial::{Trial, trial};
use super::{save, table};
use crate::common::{Failure, Printed, Stopwatch, parse_noise, share_out, threads};

/// The command line of the campaign.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    name = "distbug_campaign",
    about = "Drives DistBug through many generated courses and compares its verdicts with the truth",
    after_help = "\
A verdict is correct if it is `unreachable` and there is no way, or `reached`, there is a way, and the robot really is
within 50 mm of the goal, or within 250 mm with noise. Contacts are counted apart. The exit status is 0 if every verdict
is correct and nothing was touched, else 1.

The results do not depend on --threads. The course of one seed is that of `--seed SEED --worlds 1`."
)]
pub(crate) struct CampaignArgs {
    /// How many courses to draw.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) worlds: u64,

    /// Seed of the first course and its runs; each course has the next.
    #[arg(long, value_name = "N", default_value_t = 1, allow_hyphen_values = true)]
    pub(crate) seed: u64,

    /// Levels of noise: 0 ideal, 1 as on the real robot, up to 5.
    #[arg(long, value_name = "F,...", default_value = "0,1,2", value_delimiter = ',', value_parser = parse_noise, allow_hyphen_values = true)]
    pub(crate) noise: Vec<f64>,

    /// How many threads drive [default: one for each core].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) threads: Option<NonZero<usize>>,

    /// Write the courses that went wrong into this folder, as .sim and .wld.
    #[arg(long, value_name = "DIR")]
    pub(crate) save: Option<PathBuf>,

    /// Print exactly one JSON object on standard output, and nothing else there.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The work of the campaign.
pub(crate) fn campaign(args: &CampaignArgs) -> Result<Printed, Failure> {
    if let Some(folder) = &args.save {
        save::prepare(folder)?;
    }
    let stopwatch = Stopwatch::start();
    let trials = trials(args)?;
    let wall_time = stopwatch.seconds();
    if let Some(folder) = &args.save {
        save::failures(&trials, folder)?;
    }
    let clean = trials.iter().flat_map(|trial| &trial.runs).all(super::trial::Run::is_clean);
    let text = if args.json {
        table::json(args, &trials, wall_time)
    } else {
        table::with_times(args, &trials, wall_time)
    };
    Ok(Printed { text, message: None, status: u8::from(!clean) })
}

/// All trials in the order of their seeds, driven by as many threads as the options say.
pub(crate) fn trials(args: &CampaignArgs) -> Result<Vec<Trial>, Failure> {
    share_out("courses", args.worlds, threads(args.threads), |index| {
        trial(args.seed.wrapping_add(index), &args.noise)
    })
}
