//! Drives on many courses.

use std::num::NonZero;

use super::course::Setting;
use super::drive::Plan;
use super::{drive, rules};
use crate::common::{Failure, Outcome, PartArgs, Report, Stage, millimetres, portable, rounded};

/// Limit of Duckietown's survival time (s).
const MINUTE: f64 = 60.0;

/// Scores on courses, by seed.
#[derive(Debug, Clone)]
pub(crate) struct Scores(Vec<(u64, Score)>);

/// Score on a course.
#[derive(Debug, Clone, Copy)]
struct Score {
    light: f64,
    time: f64,
    distance: f64,
    departures: u32,
    interventions: u32,
    survival: f64,
    offset_rms: f64,
    /// Share of the time without interventions (percent).
    autonomy: f64,
}

portable!(struct Score {
    light, time, distance, departures, interventions, survival, offset_rms, autonomy,
});

impl Score {
    fn is_clean(&self) -> bool {
        self.departures + self.interventions == 0
    }
}

/// Drives on a number of courses, with consecutive seeds.
pub(crate) fn scores(
    plan: &Plan<'_>,
    courses: u64,
    crew: Option<NonZero<usize>>,
    parts: &PartArgs,
) -> Result<Scores, Failure> {
    let trials = parts.share_out(&plan.common.origin, "courses", courses, crew, |index| {
        let seed = plan.common.seed.wrapping_add(index);
        let setting = Setting::drawn(seed)?;
        let options = setting.options(plan.common.noise);
        let stage = Stage::simulated(&setting.scene()?, options, Vec::new())?;
        let outcome = drive::drive(plan, &setting, &stage)?;
        outcome.ending.map_err(Failure::run)?;
        let score = outcome.score;
        Ok((
            seed,
            Score {
                light: setting.light,
                time: score.time,
                distance: score.distance,
                departures: score.departures,
                interventions: score.interventions,
                survival: score.survival,
                offset_rms: score.offset_rms(),
                autonomy: score.autonomy(&rules()),
            },
        ))
    })?;
    for (seed, score) in &trials {
        plan.common.tell(format_args!(
            "course {seed}: {:.1} m, {} departures, {} interventions, offset {:.1} mm, light {:.0} %",
            score.distance,
            score.departures,
            score.interventions,
            1000.0 * score.offset_rms,
            100.0 * score.light,
        ));
    }
    Ok(Scores(trials))
}

impl Scores {
    fn sum(&self, of: impl Fn(&Score) -> f64) -> f64 {
        self.0.iter().map(|(_, score)| of(score)).sum()
    }

    /// Share of the courses that were driven without a fault.
    pub(crate) fn clean_share(&self) -> f64 {
        self.sum(|score| f64::from(u8::from(score.is_clean()))) / self.0.len() as f64
    }

    /// Share of the time driven without interventions (percent).
    pub(crate) fn autonomy(&self) -> f64 {
        self.sum(|score| score.time * score.autonomy) / self.sum(|score| score.time).max(1e-9)
    }

    /// The report, if so much is good.
    pub(crate) fn report(&self, driver: &str, good: bool) -> Report {
        let outcome = if good { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
        let clean = self.0.iter().filter(|(_, score)| score.is_clean()).count();
        let unclean: Vec<u64> =
            self.0.iter().filter(|(_, score)| !score.is_clean()).map(|(seed, _)| *seed).collect();
        let survived = |score: &Score| f64::from(u8::from(score.survival >= MINUTE.min(score.time) - 0.1));
        let metres = self.sum(|score| score.distance);
        let squares = self.sum(|score| score.offset_rms * score.offset_rms * score.distance);
        let departures = self.sum(|score| score.departures.into());
        let mut distances: Vec<f64> = self.0.iter().map(|(_, score)| score.distance).collect();
        distances.sort_by(f64::total_cmp);
        Report { sim_time: Some(self.sum(|score| score.time)), ..Report::new(outcome) }
            .field("driver", driver)
            .field("courses", self.0.len())
            .field("clean", clean)
            .field("unclean", unclean)
            .field("survived", self.sum(survived) as u64)
            .field("departures", departures as u64)
            .field("interventions", self.sum(|score| score.interventions.into()) as u64)
            .field("departures_per_km", rounded(1000.0 * departures / metres.max(1e-9)))
            .field("autonomy_percent", rounded(self.autonomy()))
            .field("distance_m", rounded(metres))
            .field("distance_median_m", distances.get(distances.len() / 2).copied().map(rounded))
            .field("distance_least_m", distances.first().copied().map(rounded))
            .field("offset_rms_mm", millimetres((squares / metres.max(1e-9)).sqrt()))
    }
}
