//! Races on many tracks.

use super::Args;
use super::race::race;
use crate::common::{Failure, Outcome, Report, Stage, rounded};
use crate::cones::{Course, Spoils};

/// Races on so many tracks of our own, from the seed on, and tells of those that were not clean.
pub(crate) fn run(args: &Args, tracks: u32, spoils: Spoils) -> Result<Report, Failure> {
    let common = &args.common;
    common.check_placeless("the tracks of a campaign are drawn")?;
    let (mut clean, mut finished, mut cones, mut off) = (0_u32, 0_u32, 0, 0);
    let (mut times, mut ratios) = (Vec::new(), Vec::new());
    for seed in (0..u64::from(tracks)).map(|track| common.seed.wrapping_add(track)) {
        let mut course = Course::generated(seed)?;
        course.spoil(spoils, seed);
        let settings = args.settings(seed);
        let stage = Stage::race(settings.world(&course).map_err(Failure::run)?, common.faults()?);
        let outcome = race(&course, &settings, &stage)?;
        let verdict = &outcome.verdict;
        clean += u32::from(outcome.is_clean());
        finished += u32::from(outcome.is_finished());
        cones += verdict.cones_hit;
        off += verdict.off_course;
        if !outcome.is_clean() {
            common.tell(format_args!(
                "track {seed}: {:?}, {} laps, {} cones hit, {} times off course",
                outcome.ending,
                verdict.lap_times.len(),
                verdict.cones_hit,
                verdict.off_course
            ));
        }
        ratios.extend(outcome.over_optimum.iter().copied());
        times.extend(verdict.lap_times.iter().skip(1).map(|time| course.corridor.length() / time));
    }
    let mean = times.iter().sum::<f64>() / times.len().max(1) as f64;
    let worst = ratios.iter().copied().fold(0.0, f64::max);
    let ratio = ratios.iter().sum::<f64>() / ratios.len().max(1) as f64;
    Ok(Report::new(Outcome::verdict("raced"))
        .field("tracks", tracks)
        .field("clean", clean)
        .field("clean_share", rounded(f64::from(clean) / f64::from(tracks)))
        .field("finished", finished)
        .field("cones_hit", cones)
        .field("off_course", off)
        .field("mean_racing_speed_m_s", rounded(mean))
        .field("mean_lap_over_optimum", rounded(ratio))
        .field("worst_lap_over_optimum", rounded(worst)))
}
