use std::num::NonZero;

use super::{CommonArgs, Failure, Outcome, PartArgs, Portable, Report};

/// The options of a campaign, flattened into a command's own.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct CampaignArgs {
    /// Run many times, with the seeds from --seed on, and print a table.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Number of runs in a campaign.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) runs: Option<u64>,

    /// Number of threads in a campaign [default: one per core].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) threads: Option<NonZero<usize>>,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,
}

/// Seeds of failures that a report lists.
const LISTED: usize = 10;

impl CampaignArgs {
    /// The results of all runs, by seed, of which there are `usual` unless the options say otherwise.
    /// `things` names them in the progress line. Fails with the report of a part, if only that was to be
    /// done.
    pub(crate) fn trials<T: Send + Portable>(
        &self,
        common: &CommonArgs,
        things: &str,
        usual: u64,
        trial: impl Fn(u64) -> Result<T, Failure> + Sync,
    ) -> Result<Vec<(u64, T)>, Failure> {
        let runs = self.runs.unwrap_or(usual);
        self.parts.share_out(&common.origin, things, runs, self.threads, |index| {
            let seed = common.seed.wrapping_add(index);
            Ok((seed, trial(seed)?))
        })
    }
}

/// The seeds of the trials that are not good.
pub(crate) fn wrong_seeds<T>(trials: &[(u64, T)], is_good: impl Fn(&T) -> bool) -> Vec<u64> {
    trials.iter().filter(|(_, trial)| !is_good(trial)).map(|(seed, _)| *seed).collect()
}

/// The report of a campaign: passed or wrong, contacts, and the first seeds that are amiss.
pub(crate) fn campaign_report(passed: bool, contacts: u64, wrong: &[u64]) -> Report {
    let outcome = if passed { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    Report { collisions: Some(contacts), ..Report::new(outcome) }
        .field("wrong_seeds", &wrong[..wrong.len().min(LISTED)])
}
