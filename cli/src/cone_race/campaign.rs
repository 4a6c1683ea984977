//! Races on many tracks.

use roverlab::io::sim::Fleet;

use super::Args;
use super::race::race;
use super::rival::{self, Rival};
use crate::common::{Failure, Outcome, Report, Stage, campaign_report, portable, rounded, wrong_seeds};
use crate::cones::{Course, Spoils, check_campaign, refuse};

/// Result of a race.
#[derive(Debug, Clone)]
struct Trial {
    /// How it ended, for the table.
    ending: String,
    clean: bool,
    finished: bool,
    laps: usize,
    cones_hit: usize,
    off_course: usize,
    /// Mean speed in each lap but the first one (m/s).
    speeds: Vec<f64>,
    over_optimum: Vec<f64>,
}

portable!(struct Trial {
    ending, clean, finished, laps, cones_hit, off_course, speeds, over_optimum,
});

/// Result of a race for places.
#[derive(Debug, Clone)]
#[allow(clippy::struct_excessive_bools, reason = "each counts by itself")]
struct ForPlaces {
    passed: bool,
    touched: bool,
    won: bool,
    finished: bool,
    cones_hit: usize,
    off_course: usize,
    rival_cones_hit: usize,
    rival_off_course: usize,
}

portable!(struct ForPlaces {
    passed, touched, won, finished, cones_hit, off_course, rival_cones_hit, rival_off_course,
});

/// Races on a number of generated tracks, starting with the seed, and reports those that were not clean.
pub(crate) fn run(args: &Args, tracks: u32, spoils: Spoils) -> Result<Report, Failure> {
    let common = &args.common;
    check_campaign(common)?;
    let given = [("--line", args.line.is_some())];
    refuse(&given, "found a campaign; expected it with one race")?;
    if let Some(rival) = args.rival {
        return for_places(args, tracks, spoils, rival);
    }
    let trials = args.parts.share_out(&common.origin, "races", tracks.into(), None, |track| {
        let seed = common.seed.wrapping_add(track);
        Ok((seed, trial(args, spoils, seed)?))
    })?;
    for (seed, trial) in trials.iter().filter(|(_, trial)| !trial.clean) {
        common.tell(format_args!(
            "track {seed}: {}, {} laps, {} cones hit, {} times off course",
            trial.ending, trial.laps, trial.cones_hit, trial.off_course
        ));
    }
    let all = || trials.iter().map(|(_, trial)| trial);
    let count = |is: fn(&Trial) -> bool| all().filter(|trial| is(trial)).count();
    let sum = |of: fn(&Trial) -> usize| all().map(of).sum::<usize>();
    let clean = count(|trial| trial.clean);
    let times: Vec<f64> = all().flat_map(|trial| trial.speeds.iter().copied()).collect();
    let ratios: Vec<f64> = all().flat_map(|trial| trial.over_optimum.iter().copied()).collect();
    let worst = ratios.iter().copied().reduce(f64::max);
    Ok(Report::new(Outcome::verdict("raced"))
        .field("tracks", tracks)
        .field("clean", clean)
        .field("clean_share", rounded(clean as f64 / f64::from(tracks)))
        .field("finished", count(|trial| trial.finished))
        .field("laps", sum(|trial| trial.laps))
        .field("cones_hit", sum(|trial| trial.cones_hit))
        .field("off_course", sum(|trial| trial.off_course))
        .field("not_clean", wrong_seeds(&trials, |trial| trial.clean))
        .field("mean_racing_speed_m_s", mean(&times).map(rounded))
        .field("mean_lap_over_optimum", mean(&ratios).map(rounded))
        .field("worst_lap_over_optimum", worst.map(rounded)))
}

fn trial(args: &Args, spoils: Spoils, seed: u64) -> Result<Trial, Failure> {
    let mut course = Course::generated(seed)?;
    course.spoil(spoils, seed);
    let settings = args.settings(seed);
    let stage = Stage::simulated(&settings.scene(&course), settings.options(), args.common.faults()?)?;
    let outcome = race(&course, &settings, &stage)?;
    let verdict = &outcome.verdict;
    Ok(Trial {
        ending: format!("{:?}", outcome.ending),
        clean: outcome.is_clean(),
        finished: outcome.is_finished(),
        laps: verdict.lap_times.len(),
        cones_hit: verdict.cones_hit,
        off_course: verdict.off_course,
        speeds: verdict.lap_times.iter().skip(1).map(|time| course.corridor.length() / time).collect(),
        over_optimum: outcome.over_optimum.clone(),
    })
}

/// Least share of races in which the faster car passes the slower one.
const PASSED: f64 = 0.9;

/// Races for places on a number of tracks.
fn for_places(args: &Args, tracks: u32, spoils: Spoils, rival: Rival) -> Result<Report, Failure> {
    let trials = args.parts.share_out(&args.common.origin, "races", tracks.into(), None, |track| {
        let seed = args.common.seed.wrapping_add(track);
        Ok((seed, trial_for_places(args, spoils, rival, seed)?))
    })?;
    let races = trials.iter().map(|(_, race)| race);
    let count = |of: fn(&ForPlaces) -> bool| races.clone().filter(|race| of(race)).count();
    let touched = count(|race| race.touched);
    let passed = count(|race| race.passed);
    let share = passed as f64 / f64::from(tracks);
    let sum = |of: fn(&ForPlaces) -> usize| races.clone().map(of).sum::<usize>();
    let amiss = wrong_seeds(&trials, |race| race.passed && !race.touched);
    Ok(campaign_report(touched == 0 && share >= PASSED, touched as u64, &amiss)
        .field("races", tracks)
        .field("passed", passed)
        .field("passed_share", rounded(share))
        .field("contacts", touched)
        .field("won", count(|race| race.won))
        .field("finished", count(|race| race.finished))
        .field("cones_hit", sum(|race| race.cones_hit))
        .field("off_course", sum(|race| race.off_course))
        .field("rival_cones_hit", sum(|race| race.rival_cones_hit))
        .field("rival_off_course", sum(|race| race.rival_off_course)))
}

fn trial_for_places(args: &Args, spoils: Spoils, rival: Rival, seed: u64) -> Result<ForPlaces, Failure> {
    let mut course = Course::for_two(seed)?;
    course.spoil(spoils, seed);
    let settings = args.settings(seed);
    let mut fleet = Fleet::new(&rival.scene(&course), settings.options()).map_err(Failure::input)?;
    let race = rival::race(&course, &settings, rival, &mut fleet)?;
    let super::race::Outcome { verdict, other, touched, .. } = &race.outcome;
    let finished = race.outcome.is_finished();
    Ok(ForPlaces {
        passed: race.is_passed(rival),
        touched: *touched,
        // The leader at the time limit has won nothing.
        won: finished && race.places[0] == 1,
        finished,
        cones_hit: verdict.cones_hit,
        off_course: verdict.off_course,
        rival_cones_hit: other.as_ref().map_or(0, |other| other.cones_hit),
        rival_off_course: race.rival_off_course,
    })
}

/// Mean of some numbers. `None` without any.
fn mean(numbers: &[f64]) -> Option<f64> {
    (!numbers.is_empty()).then(|| numbers.iter().sum::<f64>() / numbers.len() as f64)
}
