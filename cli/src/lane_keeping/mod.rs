//! The command `lane-keeping`.

mod campaign;
mod course;
mod drawing;
mod drive;

use std::num::NonZero;
use std::path::PathBuf;

use roverlab::drive::traffic::{FreeDriveRules, FreeDriveScore};

use crate::common::{
    CommonArgs, Failure, OF_ONE_RUN, OF_PARTS, Outcome, PartArgs, Report, millimetres, rounded, write_image,
};
use crate::end_to_end::steering;
pub(crate) use campaign::scores;
pub(crate) use course::{Setting, course};
pub(crate) use drawing::{area, parking_sides, road};
use drive::Drive;
#[cfg(feature = "learn")]
pub(crate) use drive::keeper;
pub(crate) use drive::{Pilot, Plan};

/// The command line of `lane-keeping`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Drives a model car along the lane of a course by its camera alone, before the referee of Free Drive",
    after_help = "\
The course is drawn by a seed, or read from a file (docs/courses.md). The car sees the road by a camera of 320 x 240 pixels, 30
times a second, and knows its odometry. With --driver book, it drives by the book's pipeline of Canny and Hough, with --driver net
by a trained network (see `end-to-end`).

The referee is that of Free Drive (CAuDri-Challenge 2025): two wheels over a line of the own lane are one departure. A car that
is a lane's width astray, or stands for 5 s, is taken over by remote control, which drives it back into its lane at 0.3 m/s.

With --campaign, many courses, each with worn paint, patches of light, and a light of 50 to 150 %.

JSON fields:
  course, course_length_m, driver, sensors, light
  distance_m                  along the lane, without distance under remote control
  result_m                    the same minus 5 m per departure and intervention, and minus the distance outside
  departures, interventions   number of times that two wheels left the lane; interventions by remote control
  offset_rms_mm, deviation_mm root mean square and mean offset of the car's centre from the lane's centre
  autonomy_percent            of the time; an intervention costs 6 s
  survival_s                  seconds to the first departure, or to the end
  picture
  courses, clean, unclean     campaign: number of courses, those without departure and intervention, seeds of the others
  distance_median_m           campaign: of all courses
  survived                    campaign: number that survived the first minute
  departures_per_km           campaign: of all courses, as departures, interventions, autonomy_percent and offset_rms_mm
Outcomes: kept, departed (of lanes), timed_out (in its lane, before --minutes were over), failed; with --campaign: passed (at least
98 % are clean), wrong."
)]
pub(crate) struct Args {
    /// Course to drive: a seed, or a file in the format of docs/courses.md.
    #[arg(long, value_name = "SEED|FILE", default_value = "1")]
    pub(crate) course: String,

    /// Minutes to drive.
    #[arg(long, value_name = "N", default_value_t = 2.0, value_parser = minutes, allow_hyphen_values = true)]
    pub(crate) minutes: f64,

    /// Sensors for the lane.
    #[arg(long, value_enum, default_value = "camera")]
    pub(crate) sensors: Sensors,

    /// Driver.
    #[arg(long, value_enum, default_value = "ours")]
    pub(crate) driver: Driver,

    /// Weights of --driver net, a file that `end-to-end --train` wrote [default: built in].
    #[arg(long, value_name = "FILE.safetensors")]
    pub(crate) weights: Option<PathBuf>,

    /// Maximum speed in m/s [default: 2.6, 0.5 for the book's driver, 1 for the network].
    #[arg(long, value_name = "M/S", value_parser = speed, allow_hyphen_values = true)]
    pub(crate) speed: Option<f64>,

    /// Brightness of the light; 1 is a well lit room.
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = light, allow_hyphen_values = true)]
    pub(crate) light: f64,

    /// Drive on many courses, from --seed on, and print how many were driven without a fault.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Number of courses in a campaign.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=100_000), allow_hyphen_values = true)]
    pub(crate) courses: u64,

    /// Number of threads in a campaign [default: one per core].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) threads: Option<NonZero<usize>>,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["world", "robot", "start", "goal", "quantised", "robios", "supervised"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["course", "light"]),
    ("!campaign", &["courses", "threads"]),
    ("!campaign", OF_PARTS),
    ("driver!=net", &["weights"]),
]);

/// Sensors for the lane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Sensors {
    /// The camera alone.
    Camera,
}

/// Driver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Driver {
    /// A road fitted to the markings.
    Ours,
    /// The book's edges and straight lines.
    Book,
    /// A network that sees the image and steers.
    Net,
}

/// Share of courses that must be driven without a fault.
const ENOUGH: f64 = 0.98;

impl Args {
    fn plan(&self) -> Result<Plan<'_>, Failure> {
        let pilot = match self.driver {
            Driver::Ours => Pilot::Ours,
            Driver::Book => Pilot::Book,
            Driver::Net => {
                Pilot::Network(Box::new(steering(&self.common, "weights", self.weights.as_deref())?))
            }
        };
        Ok(Plan { pilot, speed: self.speed, minutes: self.minutes, attention: None, common: &self.common })
    }
}

fn within(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| (least..=most).contains(value));
    value.ok_or_else(|| format!("expected a number from {least} to {most}"))
}

pub(crate) fn minutes(text: &str) -> Result<f64, String> {
    within(text, 0.01, 1000.0)
}

pub(crate) fn speed(text: &str) -> Result<f64, String> {
    within(text, 0.05, 3.0)
}

pub(crate) fn light(text: &str) -> Result<f64, String> {
    within(text, 0.0, 10.0)
}

/// A curvature of disturbances (1/m).
pub(crate) fn disturbance(text: &str) -> Result<f64, String> {
    within(text, 0.0, 5.0)
}

/// Runs the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    let plan = args.plan()?;
    if args.campaign {
        let scores = scores(&plan, args.courses, args.threads, &args.parts)?;
        return Ok(scores.report(plan.pilot.name(), scores.clean_share() >= ENOUGH));
    }
    one(&plan, &Setting::of(&args.common, &args.course, args.light)?)
}

/// A single drive.
pub(crate) fn one(plan: &Plan<'_>, setting: &Setting) -> Result<Report, Failure> {
    let common = plan.common;
    common.check_picture()?;
    let stage = common.stage(&setting.scene()?, setting.options(common.noise))?;
    let drive = drive::drive(plan, setting, &stage)?;
    let mut report = report(plan, setting, &drive);
    if let (Some(file), Some(image)) = (plan.attention, &drive.attention) {
        let failed = |error| Failure::run(format!("--attention {}: {error}", file.display()));
        write_image(&image.clone().into(), file).map_err(failed)?;
        report = report.field("attention", file.display().to_string());
    }
    Ok(common.draw(report, "lane_keeping.svg", || drawing::picture(setting, &drive)))
}

/// The referee's rules.
fn rules() -> FreeDriveRules {
    FreeDriveRules::default()
}

/// Whether a car kept its lane all the time.
fn is_clean(score: &FreeDriveScore) -> bool {
    score.departures + score.interventions == 0
}

fn report(plan: &Plan<'_>, setting: &Setting, drive: &Drive) -> Report {
    let score = &drive.score;
    let (word, error) = match &drive.ending {
        Err(error) => (Outcome::failure("failed"), Some(error.clone())),
        Ok(()) if is_clean(score) && plan.is_cut() => (Outcome::failure("timed_out"), None),
        Ok(()) if is_clean(score) => (Outcome::verdict("kept"), None),
        Ok(()) => (Outcome::failure("departed"), None),
    };
    let report = Report {
        sim_time: Some(score.time),
        collisions: Some(drive.truth.contacts.into()),
        path_length: Some(drive.truth.path_length),
        pose: Some(drive.truth.pose),
        odometry: Some(setting.course.start().compose(&drive.truth.odometry)),
        error,
        ..Report::new(word)
    };
    report
        .field("course", &setting.name)
        .field("course_length_m", rounded(setting.course.line.length()))
        .field("driver", plan.pilot.name())
        .field("sensors", "camera")
        .field("light", setting.light)
        .field("distance_m", rounded(score.distance))
        .field("result_m", rounded(score.result(&rules())))
        .field("departures", score.departures)
        .field("interventions", score.interventions)
        .field("offset_rms_mm", millimetres(score.offset_rms()))
        .field("deviation_mm", millimetres(score.mean_deviation()))
        .field("autonomy_percent", rounded(score.autonomy(&rules())))
        .field("survival_s", rounded(score.survival))
}
