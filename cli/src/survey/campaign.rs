use roverlab::drive::marine::SurveyOutcome;
use roverlab::geometry::units;
use serde_json::json;

use super::Args;
use super::floor::{Floor, floor, scene};
use super::tour::{COVERED, Quality, tour};
use crate::common::{Failure, Report, campaign_report, millimetres, portable, rounded, wrong_seeds};
use crate::driving::{Conditions, RESERVE};
use crate::terrain::percent;
use crate::water::{Site, limit};

/// The most errors in 95 % (m): depth and place; shares within two standard deviations; the longest way; and
/// the altitude's most root mean square error (m).
const DEPTH: f64 = 0.03;
const POSITION: f64 = 0.2;
const INSIDE: [f64; 2] = [0.93, 0.97];
const WAY: f64 = 1.3;
const ALTITUDE: f64 = 0.03;
/// Floors without `--runs`.
const FLOORS: u64 = 12;

/// A survey and what came of it.
#[derive(Debug, Clone)]
struct Trial {
    contacts: u32,
    covered: bool,
    quality: Quality,
}

portable!(struct Trial { contacts, covered, quality });

impl Trial {
    /// Whether it did as it should, apart from what it says of its own errors.
    fn is_good(&self) -> bool {
        let Quality { coverage, depth, position, way, altitude, .. } = self.quality;
        self.covered
            && self.contacts == 0
            && coverage >= COVERED
            && depth.is_some_and(|error| error <= DEPTH)
            && position.is_some_and(|error| error <= POSITION)
            && way <= WAY
            && altitude.is_none_or(|error| error <= ALTITUDE)
    }
}

/// The campaign's work.
pub(super) fn campaign(args: &Args) -> Result<Report, Failure> {
    let trials = args.trials.trials(&args.common, "surveys", FLOORS, |seed| trial(args, seed))?;
    args.common
        .tell("floor  surveys  good  covered  depth p95  place p95  within 2 sigma  way   altitude rms");
    let mut rows = Vec::new();
    for kind in Floor::ALL {
        let is_kind = move |seed: u64| floor(seed, args.altitude) == kind;
        let of = || trials.iter().filter(move |(seed, _)| is_kind(*seed)).map(|(_, trial)| trial);
        if of().next().is_none() {
            continue;
        }
        let (count, good) = (of().count(), of().filter(|trial| trial.is_good()).count());
        let least = |part: fn(&Quality) -> f64| of().map(|trial| part(&trial.quality)).fold(1.0, f64::min);
        let most = |part: fn(&Quality) -> f64| of().map(|trial| part(&trial.quality)).fold(0.0, f64::max);
        let inside = of().map(|trial| trial.quality.inside).sum::<f64>() / count.max(1) as f64;
        let (coverage, way) = (least(|q| q.coverage), most(|q| q.way));
        let depth = most(|q| q.depth.unwrap_or(f64::INFINITY));
        let position = most(|q| q.position.unwrap_or(f64::INFINITY));
        let altitude = args.altitude.map(|_| most(|q| q.altitude.unwrap_or(f64::INFINITY)));
        args.common.tell(format_args!(
            "{:<5}  {count:>7}  {good:>4}  {:>5.1} %  {:>6.0} mm  {:>6.0} mm  {:>12.1} %  {way:.2}  {}",
            kind.name(),
            100.0 * coverage,
            units::to_mm(depth),
            units::to_mm(position),
            100.0 * inside,
            altitude.map_or("-".into(), |error| format!("{:.0} mm", units::to_mm(error)))
        ));
        rows.push(json!({
            "floor": kind.name(), "surveys": count, "good": good, "least_coverage_percent": percent(coverage),
            "depth_error_p95_mm": millimetres(depth), "position_error_p95_mm": millimetres(position),
            "inside_2_sigma_percent": percent(inside), "way_ratio": rounded(way),
            "altitude_rms_error_mm": altitude.map(millimetres),
        }));
    }
    let inside =
        trials.iter().map(|(_, trial)| trial.quality.inside).sum::<f64>() / trials.len().max(1) as f64;
    let wrong = wrong_seeds(&trials, Trial::is_good);
    let good = wrong.is_empty() && (INSIDE[0]..=INSIDE[1]).contains(&inside);
    let contacts: u64 = trials.iter().map(|(_, trial)| u64::from(trial.contacts)).sum();
    Ok(campaign_report(good, contacts, &wrong)
        .field("inside_2_sigma_percent", percent(inside))
        .table("rows", rows))
}

fn trial(args: &Args, seed: u64) -> Result<Trial, Failure> {
    let scene = scene(seed, args.altitude);
    let site = Site::of(&scene, args.depth);
    let limit = args.common.time_limit.unwrap_or_else(|| limit(&site, args.spacing));
    let conditions =
        Conditions { seed, common: None, reserve: RESERVE, ..Conditions::new(&args.common, limit)? };
    let done = tour(&scene, args.parameters(&scene.world), &conditions, |_| {})?;
    let covered = done.run.ending == Ok(SurveyOutcome::Covered);
    Ok(Trial { contacts: done.run.truth.contacts, covered, quality: done.quality })
}
