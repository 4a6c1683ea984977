use roverlab::geometry::units;
use roverlab::random::Stream;
use serde_json::json;

use super::Args;
use super::hunt::{DEPTH, Hunt, hunt};
use super::scene::{TURBIDITIES, scene, turbidity};
use crate::common::{Failure, Report, campaign_report, millimetres, portable, wrong_seeds};
use crate::driving::{Conditions, RESERVE};
use crate::terrain::percent;
use crate::water::{Site, limit};

/// Pools without `--runs`.
const POOLS: u64 = 200;
/// The light, and what a campaign must come to: shares of finds, and of pools without a false one; and the error
/// of a find's place (m).
const LIGHT: [f64; 2] = [0.3, 1.5];
const FOUND: f64 = 0.98;
const TRUE: f64 = 0.99;
const PLACE: f64 = 0.15;

/// A pool and what came of it.
#[derive(Debug, Clone)]
struct Trial {
    found: bool,
    is_false: bool,
    error: Option<f64>,
    contacts: u32,
}

portable!(struct Trial { found, is_false, error, contacts });

impl Trial {
    fn is_good(&self) -> bool {
        self.found && !self.is_false && self.contacts == 0 && self.error.is_some_and(|error| error <= PLACE)
    }
}

/// The campaign's work.
pub(super) fn campaign(args: &Args) -> Result<Report, Failure> {
    let trials = args.trials.trials(&args.common, "pools", POOLS, |seed| trial(args, seed))?;
    args.common.tell("turbidity  pools  found  false  contacts  worst place");
    let mut rows = Vec::new();
    for water in TURBIDITIES {
        let of = || trials.iter().filter(move |(seed, _)| turbidity(*seed) == water).map(|(_, trial)| trial);
        let count = |what: fn(&Trial) -> bool| of().filter(|trial| what(trial)).count();
        let (pools, found, untrue) =
            (of().count(), count(|trial| trial.found), count(|trial| trial.is_false));
        let contacts: u32 = of().map(|trial| trial.contacts).sum();
        let worst = of().filter(|trial| !trial.is_false).filter_map(|trial| trial.error).fold(0.0, f64::max);
        args.common.tell(format_args!(
            "{water:>5} 1/m  {pools:>5}  {found:>5}  {untrue:>5}  {contacts:>8}  {:>8.0} mm",
            units::to_mm(worst)
        ));
        rows.push(json!({
            "turbidity": water, "pools": pools, "found": found, "false": untrue, "contacts": contacts,
            "max_position_error_mm": millimetres(worst),
        }));
    }
    let share = |what: fn(&Trial) -> bool| {
        trials.iter().filter(|(_, trial)| what(trial)).count() as f64 / trials.len().max(1) as f64
    };
    let (found, untrue) = (share(|trial| trial.found && !trial.is_false), share(|trial| trial.is_false));
    let near = |trial: &Trial| trial.is_false || trial.error.is_none_or(|error| error <= PLACE);
    let placed = trials.iter().all(|(_, trial)| near(trial) && trial.contacts == 0);
    let contacts: u64 = trials.iter().map(|(_, trial)| u64::from(trial.contacts)).sum();
    let passed = found >= FOUND && 1.0 - untrue >= TRUE && placed;
    Ok(campaign_report(passed, contacts, &wrong_seeds(&trials, Trial::is_good))
        .field("found_percent", percent(found))
        .field("false_percent", percent(untrue))
        .table("rows", rows))
}

fn trial(args: &Args, seed: u64) -> Result<Trial, Failure> {
    let scene = scene(seed);
    let mut stream = Stream::new(seed).child("light", 0);
    let light = stream.between(LIGHT[0], LIGHT[1]);
    let time = args.common.time_limit.unwrap_or_else(|| limit(&Site::of(&scene, DEPTH), 1.0));
    let conditions =
        Conditions { seed, light, common: None, reserve: RESERVE, ..Conditions::new(&args.common, time)? };
    let done: Hunt = hunt(&scene, &conditions, |_| {})?;
    Ok(Trial {
        found: done.place.is_some(),
        is_false: done.is_false(),
        error: done.error,
        contacts: done.run.truth.contacts,
    })
}
