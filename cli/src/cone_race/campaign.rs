//! Races on many tracks.

use roverlab::io::sim::Fleet;

use super::Args;
use super::race::race;
use super::rival::{self, Rival};
use crate::common::{
    Failure, Outcome, Report, Stage, campaign_report, rounded, share_out, threads, wrong_seeds,
};
use crate::cones::{Course, Spoils, check_campaign, refuse};

/// Races on a number of generated tracks, starting with the seed, and reports those that were not clean.
pub(crate) fn run(args: &Args, tracks: u32, spoils: Spoils) -> Result<Report, Failure> {
    let common = &args.common;
    check_campaign(common)?;
    let given = [("--line", args.line.is_some())];
    refuse(&given, "found a campaign; expected it with one race")?;
    if let Some(rival) = args.rival {
        return for_places(args, tracks, spoils, rival);
    }
    let (mut clean, mut finished, mut laps, mut cones, mut off) = (0_u32, 0_u32, 0, 0, 0);
    let (mut times, mut ratios, mut unclean) = (Vec::new(), Vec::new(), Vec::new());
    for seed in (0..u64::from(tracks)).map(|track| common.seed.wrapping_add(track)) {
        let mut course = Course::generated(seed)?;
        course.spoil(spoils, seed);
        let settings = args.settings(seed);
        let stage = Stage::simulated(&settings.scene(&course), settings.options(), common.faults()?)?;
        let outcome = race(&course, &settings, &stage)?;
        let verdict = &outcome.verdict;
        clean += u32::from(outcome.is_clean());
        finished += u32::from(outcome.is_finished());
        laps += verdict.lap_times.len();
        cones += verdict.cones_hit;
        off += verdict.off_course;
        if !outcome.is_clean() {
            unclean.push(seed);
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
    let worst = ratios.iter().copied().reduce(f64::max);
    Ok(Report::new(Outcome::verdict("raced"))
        .field("tracks", tracks)
        .field("clean", clean)
        .field("clean_share", rounded(f64::from(clean) / f64::from(tracks)))
        .field("finished", finished)
        .field("laps", laps)
        .field("cones_hit", cones)
        .field("off_course", off)
        .field("not_clean", unclean)
        .field("mean_racing_speed_m_s", mean(&times).map(rounded))
        .field("mean_lap_over_optimum", mean(&ratios).map(rounded))
        .field("worst_lap_over_optimum", worst.map(rounded)))
}

/// Least share of races in which the faster car passes the slower one.
const PASSED: f64 = 0.9;

/// Races for places on a number of tracks.
fn for_places(args: &Args, tracks: u32, spoils: Spoils, rival: Rival) -> Result<Report, Failure> {
    let trials = share_out("races", tracks.into(), threads(None), |index| {
        let seed = args.common.seed.wrapping_add(index);
        let mut course = Course::for_two(seed)?;
        course.spoil(spoils, seed);
        let settings = args.settings(seed);
        let mut fleet = Fleet::new(&rival.scene(&course), settings.options()).map_err(Failure::input)?;
        Ok((seed, rival::race(&course, &settings, rival, &mut fleet)?))
    })?;
    let races = trials.iter().map(|(_, race)| race);
    let count = |of: &dyn Fn(&rival::Contest) -> bool| races.clone().filter(|race| of(race)).count();
    let touched = count(&|race| race.outcome.touched);
    let passed = count(&|race| race.is_passed(rival));
    let share = passed as f64 / f64::from(tracks);
    let sum = |of: &dyn Fn(&rival::Contest) -> usize| races.clone().map(of).sum::<usize>();
    let amiss = wrong_seeds(&trials, |race| race.is_passed(rival) && !race.outcome.touched);
    Ok(campaign_report(touched == 0 && share >= PASSED, touched as u64, &amiss)
        .field("races", tracks)
        .field("passed", passed)
        .field("passed_share", rounded(share))
        .field("contacts", touched)
        .field("won", count(&|race| race.places[0] == 1))
        .field("finished", count(&|race| race.outcome.is_finished()))
        .field("cones_hit", sum(&|race| race.outcome.verdict.cones_hit))
        .field("off_course", sum(&|race| race.outcome.verdict.off_course))
        .field("rival_cones_hit", sum(&|race| race.outcome.other.as_ref().map_or(0, |other| other.cones_hit)))
        .field("rival_off_course", sum(&|race| race.rival_off_course)))
}

/// Mean of some numbers. `None` without any.
fn mean(numbers: &[f64]) -> Option<f64> {
    (!numbers.is_empty()).then(|| numbers.iter().sum::<f64>() / numbers.len() as f64)
}
