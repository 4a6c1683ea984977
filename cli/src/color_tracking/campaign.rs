use roverlab::random::Stream;

use super::job::{Truth, one, wanted};
use super::{Args, Job, scene};
use crate::common::{Failure, Outcome, Report};
use crate::driving::Conditions;

/// Results of a campaign.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) scenes: u64,
    pub(crate) reached: u64,
    /// Seeds of the failures.
    pub(crate) wrong: Vec<u64>,
}

/// Drives in many scenes.
pub(crate) fn campaign(args: &Args) -> Result<Report, Failure> {
    if let Some(light) = args.light {
        return Err(Failure::input(format!(
            "--light: found {light}; expected none, as each scene of a campaign has its own"
        )));
    }
    let tally = tally(args)?;
    let share = tally.reached as f64 / tally.scenes.max(1) as f64;
    let outcome = if share >= 0.99 { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    Ok(Report::new(outcome)
        .field("job", args.job.name())
        .field("method", args.method.name())
        .field("scenes", tally.scenes)
        .field("reached", tally.reached)
        .field("wrong", tally.wrong))
}

pub(crate) fn tally(args: &Args) -> Result<Tally, Failure> {
    let mut tally = Tally { scenes: args.scenes, ..Tally::default() };
    let scenes = args.parts.share_out(&args.common.origin, "scenes", args.scenes, None, |index| {
        let seed = args.common.seed.wrapping_add(index);
        Ok((seed, good(args, seed)?))
    })?;
    for (seed, good) in scenes {
        if good { tally.reached += 1 } else { tally.wrong.push(seed) }
    }
    Ok(tally)
}

/// Whether the robot does its task in a scene without a contact.
fn good(args: &Args, seed: u64) -> Result<bool, Failure> {
    let scene = scene::drawn(seed);
    let light = Stream::new(seed).child("light", 0).between(0.3, 1.5);
    let home = args.job == Job::Home;
    let conditions =
        Conditions { seed, light, pushing: home, common: None, ..Conditions::new(&args.common, 300.0)? };
    let (hue, run) = one(args, &scene, &conditions, &mut |_| {})?;
    let Ok(ended) = run.ending else { return Ok(false) };
    let truth = Truth::new(&wanted(&scene, hue, args.tolerance)?, &scene, &run);
    Ok(run.truth.contacts == 0 && !truth.verdict(ended).is_failure())
}
