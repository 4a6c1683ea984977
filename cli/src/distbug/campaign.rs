use super::trial::{Judgement, Trial, trial};
use super::{Args, save, table};
use crate::common::{Failure, Outcome, Report, Stopwatch};

/// Runs a campaign.
pub(crate) fn campaign(args: &Args) -> Result<Report, Failure> {
    args.common.check_placeless("the courses of a campaign are generated")?;
    if let Some(folder) = &args.save {
        save::prepare(folder)?;
    }
    let stopwatch = Stopwatch::start();
    let trials = trials(args)?;
    let wall_time = stopwatch.seconds();
    if let Some(folder) = &args.save {
        save::failures(&trials, folder)?;
    }
    args.common.tell(table::explained(args, &trials));
    let runs = || trials.iter().flat_map(|trial| &trial.runs);
    let good = runs().all(|run| run.judgement == Judgement::Correct);
    let sim_time = runs().map(|run| run.sim_time).sum();
    Ok(Report {
        sim_time: Some(sim_time),
        mixed_noise: true,
        collisions: Some(runs().map(|run| u64::from(run.contacts)).sum()),
        ..Report::new(if good { Outcome::verdict("passed") } else { Outcome::failure("wrong") })
    }
    .field("worlds", args.worlds)
    .table("levels", table::json(&args.levels, &trials))
    .timing("real_time_factor", sim_time / wall_time.max(1e-9)))
}

/// All trials in the order of their seeds, driven by several threads.
pub(crate) fn trials(args: &Args) -> Result<Vec<Trial>, Failure> {
    args.parts.share_out(&args.common.origin, "courses", args.worlds, args.threads, |index| {
        trial(args.common.seed.wrapping_add(index), &args.levels)
    })
}
