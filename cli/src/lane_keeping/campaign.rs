//! Drives on many courses.

use super::course::Setting;
use super::{Args, drive, is_clean};
use crate::common::{Failure, Outcome, Report, Stage, millimetres, rounded};

/// Share of courses that must be driven without a fault.
const ENOUGH: f64 = 0.98;
/// Limit of Duckietown's survival time (s).
const MINUTE: f64 = 60.0;

/// Drives on a number of courses, with consecutive seeds.
pub(super) fn run(args: &Args) -> Result<Report, Failure> {
    let (mut clean, mut survived) = (0_u64, 0_u64);
    let (mut distances, mut unclean) = (Vec::new(), Vec::new());
    let (mut squares, mut metres) = (0.0, 0.0);
    for seed in (0..args.courses).map(|course| args.common.seed.wrapping_add(course)) {
        let setting = Setting::drawn(seed)?;
        let stage = Stage::simulated(&setting.scene()?, setting.options(args), Vec::new())?;
        let outcome = drive::drive(args, &setting, &stage)?;
        outcome.ending.map_err(Failure::run)?;
        let score = outcome.score;
        survived += u64::from(score.survival >= MINUTE.min(score.time) - 0.1);
        squares += score.offset_rms() * score.offset_rms() * score.distance;
        metres += score.distance;
        distances.push(score.distance);
        if is_clean(&score) {
            clean += 1;
        } else {
            unclean.push(seed);
        }
        args.common.tell(format_args!(
            "course {seed}: {:.1} m, {} departures, {} interventions, offset {:.1} mm, light {:.0} %",
            score.distance,
            score.departures,
            score.interventions,
            1000.0 * score.offset_rms(),
            100.0 * setting.light,
        ));
    }
    distances.sort_by(f64::total_cmp);
    let share = clean as f64 / args.courses as f64;
    let outcome = if share >= ENOUGH { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    Ok(Report::new(outcome)
        .field("driver", args.driver.name())
        .field("courses", args.courses)
        .field("clean", clean)
        .field("unclean", unclean)
        .field("survived", survived)
        .field("distance_m", rounded(metres))
        .field("distance_median_m", distances.get(distances.len() / 2).copied().map(rounded))
        .field("distance_least_m", distances.first().copied().map(rounded))
        .field("offset_rms_mm", millimetres((squares / metres.max(1e-9)).sqrt())))
}
