//! The command `traffic`.

mod campaign;
mod drawing;
mod drive;
mod setting;

use roverlab::drive::traffic::{EvasionElement, EvasionScore};
use serde_json::{Value, json};

use crate::common::{CampaignArgs, CommonArgs, Failure, OF_A_CAMPAIGN, OF_ONE_RUN, Outcome, Report, rounded};
use drive::Drive;
use setting::Setting;

/// The command line of `traffic`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Drives a model car in traffic by its camera: past obstacles, to halts at lines and before pedestrians",
    after_help = "\
The course is drawn by a seed, or read from a file (docs/courses.md); --seed puts boxes and pedestrians on it, and draws noise.
The car sees the road by a camera of 320 x 240 pixels, 30 times a second, and knows its odometry.

The referee is that of Obstacle Evasion (CAuDri-Challenge 2025) for obstacles that stand, move or come in
the other lane, no-passing zones, barred areas, stop and give-way lines, traffic from the right, crosswalks,
speed zones, and turns by arrows at crossings of the road with itself. Five minutes, or --time-limit. There
are no signs, and `parking` is a command of its own.

With --campaign, many courses, each with worn paint, patches of light, and a light of 50 to 150 %.

JSON fields:
  course, course_length_m, sensors
  laps                        completed laps
  points, points_possible     of all elements, minus 2 per departure (at most 10 times), 5 per speed zone driven through too
                              fast, and 5 for a car that is taken over
  collisions                  number of boxes that the car has touched
  departures                  number of times that two wheels left the lane away from obstacles
  speedings                   number of times that the car was too fast in a speed zone
  elements                    rows: element, points, seen, right, neutral, negative
  picture
  courses, clean              campaign: number of courses, those without collision
  faultless                   campaign: number of courses without a negative element
  wrong_seeds                 campaign: first seeds without full points
Outcomes: finished, unfinished (the time was over, or the car was taken over), collided, failed; with --campaign: passed (95 % of
the points, 98 % without collision, 95 % without a negative element), wrong."
)]
pub(crate) struct Args {
    /// Course to drive: a seed, or a file in the format of docs/courses.md.
    #[arg(long, value_name = "SEED|FILE", default_value = "1")]
    pub(crate) course: String,

    /// Number of laps.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=100), allow_hyphen_values = true)]
    pub(crate) laps: u32,

    #[command(flatten)]
    pub(crate) trials: CampaignArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["world", "robot", "start", "goal", "quantised", "robios", "supervised"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["course"]),
    ("!campaign", OF_A_CAMPAIGN),
]);

/// Runs the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.trials.campaign {
        return campaign::run(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let setting = Setting::of(args)?;
    let stage = common.stage(&setting.scene()?, setting.options(args))?;
    let drive = drive::drive(args, &setting, &stage)?;
    let report = report(args, &setting, &drive);
    Ok(common.draw(report, "traffic.svg", || drawing::picture(&setting, &drive)))
}

fn report(args: &Args, setting: &Setting, drive: &Drive) -> Report {
    let score = &drive.score;
    let (word, error) = match &drive.ending {
        Err(error) => (Outcome::failure("failed"), Some(error.clone())),
        Ok(()) if score.collisions > 0 => (Outcome::failure("collided"), None),
        Ok(()) if score.laps >= args.laps => (Outcome::verdict("finished"), None),
        Ok(()) => (Outcome::failure("unfinished"), None),
    };
    args.common.tell(table(score));
    let report = Report {
        sim_time: Some(score.time),
        collisions: Some(score.collisions.into()),
        path_length: Some(drive.truth.path_length),
        pose: Some(drive.truth.pose),
        odometry: Some(setting.scene.course.start().compose(&drive.truth.odometry)),
        error,
        ..Report::new(word)
    };
    report
        .field("course", &setting.name)
        .field("course_length_m", rounded(setting.scene.course.line.length()))
        .field("sensors", "camera")
        .field("laps", score.laps)
        .field("points", rounded(score.points()))
        .field("points_possible", rounded(drive.possible))
        .field("departures", score.departures)
        .field("speedings", score.speedings)
        .table("elements", rows(score))
}

/// The rows of a score as JSON.
fn rows(score: &EvasionScore) -> Vec<Value> {
    let row = |(element, row): (&EvasionElement, &roverlab::drive::traffic::EvasionRow)| {
        json!({
            "element": element.name(), "points": element.points().0,
            "seen": row.seen, "right": row.right, "neutral": row.neutral, "negative": row.negative,
        })
    };
    EvasionElement::ALL.iter().zip(&score.rows).map(row).collect()
}

/// The same as text.
fn table(score: &EvasionScore) -> String {
    let mut lines =
        vec![format!("{:<26}{:>5}{:>7}{:>9}{:>10}", "element", "seen", "right", "neutral", "negative")];
    lines.extend(EvasionElement::ALL.iter().zip(&score.rows).map(|(element, row)| {
        format!("{:<26}{:>5}{:>7}{:>9}{:>10}", element.name(), row.seen, row.right, row.neutral, row.negative)
    }));
    lines.join("\n")
}
