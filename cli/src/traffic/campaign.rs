//! Drives on many courses.

use roverlab::drive::traffic::EvasionScore;

use super::setting::Setting;
use super::{Args, drive, rows, table};
use crate::common::{Failure, Report, Stage, campaign_report, portable, rounded, wrong_seeds};

/// Number of courses without `--runs`.
const COURSES: u64 = 100;
/// Required shares: of the points, of courses without collision, and of courses without a negative element.
const POINTS: f64 = 0.95;
const CLEAN: f64 = 0.98;
const FAULTLESS: f64 = 0.95;

/// The result on a course.
#[derive(Debug, Clone)]
struct Trial {
    score: EvasionScore,
    possible: f64,
}

portable!(struct Trial { score, possible });

/// Drives on a number of courses, with consecutive seeds.
pub(super) fn run(args: &Args) -> Result<Report, Failure> {
    let trials = args.trials.trials(&args.common, "courses", COURSES, |seed| trial(args, seed))?;
    for (seed, Trial { score, possible }) in &trials {
        args.common.tell(format_args!(
            "course {seed}: {:.0} of {possible:.0} points, {} laps in {:.0} s, {} collisions, {} negative, {} departures",
            score.points(),
            score.laps,
            score.time,
            score.collisions,
            score.negative(),
            score.departures,
        ));
    }
    let all = sum(&trials);
    args.common.tell(table(&all));
    let count =
        |is_good: fn(&EvasionScore) -> bool| trials.iter().filter(|(_, trial)| is_good(&trial.score)).count();
    let (clean, faultless) = (count(|score| score.collisions == 0), count(|score| score.negative() == 0));
    let points: f64 = trials.iter().map(|(_, trial)| trial.score.points()).sum();
    let possible: f64 = trials.iter().map(|(_, trial)| trial.possible).sum();
    let courses = trials.len() as f64;
    let passed = points >= POINTS * possible
        && clean as f64 >= CLEAN * courses
        && faultless as f64 >= FAULTLESS * courses;
    let wrong = wrong_seeds(&trials, |trial| trial.score.points() >= trial.possible);
    Ok(campaign_report(passed, all.collisions.into(), &wrong)
        .field("courses", trials.len())
        .field("laps", all.laps)
        .field("points", rounded(points))
        .field("points_possible", rounded(possible))
        .field("clean", clean)
        .field("faultless", faultless)
        .field("departures", all.departures)
        .field("speedings", all.speedings)
        .table("elements", rows(&all)))
}

fn trial(args: &Args, seed: u64) -> Result<Trial, Failure> {
    let setting = Setting::drawn(seed)?;
    let stage = Stage::simulated(&setting.scene()?, setting.options(args), Vec::new())?;
    let drive = drive::drive(args, &setting, &stage)?;
    drive.ending.map_err(Failure::run)?;
    Ok(Trial { score: drive.score, possible: drive.possible })
}

/// The sum of all scores.
fn sum(trials: &[(u64, Trial)]) -> EvasionScore {
    let mut all = EvasionScore::default();
    for (_, Trial { score, .. }) in trials {
        all.laps += score.laps;
        all.collisions += score.collisions;
        all.departures += score.departures;
        all.speedings += score.speedings;
        for (sum, row) in all.rows.iter_mut().zip(&score.rows) {
            sum.seen += row.seen;
            sum.right += row.right;
            sum.neutral += row.neutral;
            sum.negative += row.negative;
        }
    }
    all
}
