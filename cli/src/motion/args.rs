use crate::common::{CommonArgs, OF_ONE_RUN};

/// Command line of `motion`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Watches for motion in three sectors of the image and turns to where most of it is, also while turning",
    after_help = "\
Without --world, two robots among cans: one watches, the other drives in circles. In a world from a file, the second robot
does the same; --still lets it stand.

With --campaign, pairs of images 0.1 s apart by a standing robot, of other robots that stand or drive: the threshold at which
at most one still pair in 1000 is an alarm, the share of moving pairs above it, and the same for the book's method, the mean
of the absolute difference, with its threshold of 15 and with one of its own.

JSON fields:
  images, alarms              compared images; those with motion
  sectors                     alarms by sector: left, middle, right
  strongest                   the largest change of blocks, in standard deviations of the noise
  turned_deg                  how far the robot turned, by its true heading
  time_limit_s, picture
  pairs                       campaign: of each kind
  threshold, false_alarms, detected
  at_best, book, book_at_best the same with the lowest threshold of few alarms; for the book's method
Outcomes: watched, collided, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Keep the other robot still.
    #[arg(long)]
    pub(crate) still: bool,

    /// Brightness of the light; 1 is a well lit room.
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = parse_light, allow_hyphen_values = true)]
    pub(crate) light: f64,

    /// Compare many pairs of images and print the detection rates.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Number of pairs of each kind in a campaign.
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) pairs: u64,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["goal"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["time_limit", "still"]),
    ("!campaign", &["pairs"]),
]);

fn parse_light(text: &str) -> Result<f64, String> {
    let light = text.parse().ok().filter(|light: &f64| (0.0..=10.0).contains(light));
    light.ok_or_else(|| "expected a number from 0 to 10".into())
}
