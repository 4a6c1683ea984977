use roverlab::drive::marine::{PoolWallOutcome, PoolWallParameters};
use roverlab::geometry::units;
use roverlab::world::generate::PoolKind;
use serde_json::json;

use super::Args;
use super::job::{generated, kind, limit};
use super::round::{Errors, round};
use crate::common::{Failure, Report, campaign_report, millimetres, portable, wrong_seeds};
use crate::driving::{Conditions, RESERVE};

/// Laps of a pool, and the largest root mean square of the error (m).
const LAPS: u32 = 10;
const RMS: f64 = 0.05;
/// Pools without `--runs`.
const POOLS: u64 = 100;

/// A pool and what came of it.
#[derive(Debug, Clone)]
struct Trial {
    laps: u32,
    contacts: u32,
    errors: Errors,
}

portable!(struct Trial { laps, contacts, errors });

impl Trial {
    fn is_good(&self) -> bool {
        self.laps >= LAPS && self.contacts == 0 && self.errors.rms().is_some_and(|rms| rms <= RMS)
    }
}

/// The campaign's work.
pub(super) fn campaign(args: &Args) -> Result<Report, Failure> {
    let trials = args.trials.trials(&args.common, "pools", POOLS, |seed| trial(args, seed))?;
    let mut rows = Vec::new();
    args.common.tell("pool       pools  laps  contacts  rms error  largest");
    let mut all = Errors::default();
    for shape in PoolKind::ALL {
        let of = || trials.iter().filter(move |(seed, _)| kind(*seed) == shape).map(|(_, trial)| trial);
        let mut errors = Errors::default();
        of().for_each(|trial| errors.add(&trial.errors));
        all.add(&errors);
        let (pools, laps) = (of().count(), of().map(|trial| trial.laps).sum::<u32>());
        let contacts: u32 = of().map(|trial| trial.contacts).sum();
        let (rms, largest) = (errors.rms().unwrap_or(0.0), errors.largest);
        args.common.tell(format_args!(
            "{:<9}  {pools:>5}  {laps:>4}  {contacts:>8}  {:>6.1} mm  {:>4.0} mm",
            format!("{shape:?}"),
            units::to_mm(rms),
            units::to_mm(largest)
        ));
        rows.push(json!({
            "pool": format!("{shape:?}").to_lowercase(), "pools": pools, "laps": laps, "contacts": contacts,
            "rms_error_mm": millimetres(rms), "max_error_mm": millimetres(largest),
        }));
    }
    let wrong = wrong_seeds(&trials, Trial::is_good);
    let contacts: u64 = trials.iter().map(|(_, trial)| u64::from(trial.contacts)).sum();
    Ok(campaign_report(wrong.is_empty(), contacts, &wrong)
        .field("rms_error_mm", all.rms().map(millimetres))
        .field("max_error_mm", millimetres(all.largest))
        .field("laps", trials.iter().map(|(_, trial)| trial.laps).sum::<u32>())
        .table("rows", rows))
}

fn trial(args: &Args, seed: u64) -> Result<Trial, Failure> {
    let scene = generated(seed)?;
    let parameters = PoolWallParameters { laps: LAPS, ..PoolWallParameters::default() };
    let limit = args.common.time_limit.unwrap_or_else(|| limit(&scene, &parameters));
    let conditions =
        Conditions { seed, common: None, reserve: RESERVE, ..Conditions::new(&args.common, limit)? };
    let done = round(&scene, parameters, &conditions, |_| {})?;
    let laps = match done.run.ending {
        Ok((PoolWallOutcome::Round | PoolWallOutcome::TimedOut, laps)) => laps,
        _ => 0,
    };
    Ok(Trial { laps, contacts: done.run.truth.contacts, errors: done.errors })
}
