//! The command `lane-keeping`.

mod campaign;
mod course;
mod drawing;
mod drive;

use roverlab::drive::traffic::{FreeDriveRules, FreeDriveScore};

use crate::common::{CommonArgs, Failure, OF_ONE_RUN, Outcome, Report, millimetres, rounded};
use course::Setting;
use drive::Drive;

/// The command line of `lane-keeping`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Drives a model car along the lane of a course by its camera alone, before the referee of Free Drive",
    after_help = "\
The course is drawn by a seed, or read from a file (docs/courses.md). The car sees the road by a camera of 320 x 240 pixels, 30
times a second, and knows its odometry. With --driver book, it drives by the book's pipeline of Canny and Hough.

The referee is that of Free Drive (CAuDri-Challenge 2025): two wheels over a line of the own lane are one departure. Whoever
is a lane's width astray, or stands for 5 s, is taken over by remote control, which drives it back into its lane at 0.3 m/s.

With --campaign, many courses, each with worn paint, patches of light, and a light of 50 to 150 %.

JSON fields:
  course, course_length_m, driver, sensors, light
  distance_m                  along the lane, without what was driven by remote control
  result_m                    the same less 5 m for each departure and each intervention, and less the metres outside
  departures, interventions   how often two wheels left the lane, and how often the car was taken over
  offset_rms_mm, deviation_mm root of the mean squared distance of the car's middle from its lane's, and the mean one
  autonomy_percent            share of the time, where an intervention costs 6 s
  survival_s                  seconds to the first departure, or to the end
  picture
  courses, clean, unclean     campaign: how many, those without departure and intervention, and the seeds of the others
  distance_median_m           campaign: of all courses
  survived                    campaign: how many survived the first minute
Outcomes: kept, departed (of lanes), failed; with --campaign: passed (at least 98 % are clean), wrong."
)]
pub(crate) struct Args {
    /// Course to drive: a seed, or a file in the format of docs/courses.md.
    #[arg(long, value_name = "SEED|FILE", default_value = "1")]
    pub(crate) course: String,

    /// Minutes to drive.
    #[arg(long, value_name = "N", default_value_t = 2.0, value_parser = minutes, allow_hyphen_values = true)]
    pub(crate) minutes: f64,

    /// What the car sees its lane by.
    #[arg(long, value_enum, default_value = "camera")]
    pub(crate) sensors: Sensors,

    /// Who drives.
    #[arg(long, value_enum, default_value = "ours")]
    pub(crate) driver: Driver,

    /// Fastest speed in m/s [default: 2.6, 0.5 for the book's driver].
    #[arg(long, value_name = "M/S", value_parser = speed, allow_hyphen_values = true)]
    pub(crate) speed: Option<f64>,

    /// Brightness of the light; 1 is a well lit room.
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = light, allow_hyphen_values = true)]
    pub(crate) light: f64,

    /// Drive on many courses, from --seed on, and print how many went well.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Courses of a campaign.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=100_000), allow_hyphen_values = true)]
    pub(crate) courses: u64,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["world", "robot", "start", "goal", "quantised", "robios", "supervised"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["course", "light"]),
    ("!campaign", &["courses"]),
]);

/// What a car sees its lane by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Sensors {
    /// Its camera alone.
    Camera,
}

/// Who drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Driver {
    /// A road fitted to the markings.
    Ours,
    /// The book's edges and straight lines.
    Book,
}

impl Driver {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Ours => "ours",
            Self::Book => "book",
        }
    }
}

fn within(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| (least..=most).contains(value));
    value.ok_or_else(|| format!("expected a number from {least} to {most}"))
}

fn minutes(text: &str) -> Result<f64, String> {
    within(text, 0.01, 1000.0)
}

fn speed(text: &str) -> Result<f64, String> {
    within(text, 0.05, 3.0)
}

fn light(text: &str) -> Result<f64, String> {
    within(text, 0.0, 10.0)
}

/// The work of the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.campaign {
        return campaign::run(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let setting = Setting::of(args)?;
    let stage = common.stage(&setting.scene()?, setting.options(args))?;
    let drive = drive::drive(args, &setting, &stage)?;
    let report = report(args, &setting, &drive);
    Ok(common.draw(report, "lane_keeping.svg", || drawing::picture(&setting, &drive)))
}

/// The rules that the referee goes by.
fn rules() -> FreeDriveRules {
    FreeDriveRules::default()
}

/// Whether a car has kept its lane all the time.
fn is_clean(score: &FreeDriveScore) -> bool {
    score.departures + score.interventions == 0
}

fn report(args: &Args, setting: &Setting, drive: &Drive) -> Report {
    let score = &drive.score;
    let (word, error) = match &drive.ending {
        Err(error) => (Outcome::failure("failed"), Some(error.clone())),
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
        .field("driver", args.driver.name())
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
