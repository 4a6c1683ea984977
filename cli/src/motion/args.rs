use crate::common::{CommonArgs, OF_ONE_RUN, OF_PARTS, PartArgs};

/// Command line of `motion`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Detects motion in three sectors of the image and turns to the strongest one, also while turning",
    after_help = "\
Without --world, there are two robots among cans: one observes, the other drives in circles. In a world from a file, the
second robot does the same; with --still it does not move.

With --approach, the robot drives until it sees something move, and then to it: how what stands still moves in the image
is predicted from odometry and the camera's geometry, and subtracted.

With --campaign, pairs of images 0.1 s apart from a standing robot, of other robots that stand or drive: the threshold
at which at most one still pair in 1000 causes an alarm, the fraction of moving pairs above it, and the same for the
book's method, the mean absolute difference, with its threshold of 15 and with an optimal one. With --approach as well,
many scenes: false alarms while the robot drives past what stands still, the fraction of moving robots that it finds
while it drives, and the fraction that it reaches.

JSON fields:
  images, alarms              number of compared images; of those with motion
  sectors                     alarms by sector: left, middle, right
  strongest                   largest change of blocks, in standard deviations of the noise
  turned_deg                  true change of the robot's heading
  time_limit_s, picture
  pairs                       campaign: number of each kind
  threshold, false_alarms, detected
  at_best, book, book_at_best the same with the lowest threshold with few alarms; for the book's method
  distance_mm                 approach: true distance from the nearest other robot at the end
  scenes, pairs, false_alarms, found, reached, missed_seeds, lost_seeds
                              campaign of approaches: pairs of images while driving, the fractions of moving robots
                              found and reached, and the first seeds in which they were not
Outcomes: watched, timed_out (no images compared), collided, failed; with --approach: reached, timed_out; with --campaign:
passed, wrong."
)]
pub(crate) struct Args {
    /// Keep the other robot still.
    #[arg(long)]
    pub(crate) still: bool,

    /// Brightness of the light; 1 is a well lit room.
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = parse_light, allow_hyphen_values = true)]
    pub(crate) light: f64,

    /// Drive until something moves, and then to it.
    #[arg(long)]
    pub(crate) approach: bool,

    /// Compare many pairs of images and print the detection rates.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Number of pairs of each kind in a campaign.
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) pairs: u64,

    /// Number of scenes in a campaign of approaches.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) scenes: u64,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["goal"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["time_limit", "still"]),
    ("!campaign", &["pairs", "scenes"]),
    ("approach", &["pairs"]),
    ("!campaign", OF_PARTS),
    ("!approach", &["scenes"]),
    ("!approach", OF_PARTS),
]);

fn parse_light(text: &str) -> Result<f64, String> {
    let light = text.parse().ok().filter(|light: &f64| (0.0..=10.0).contains(light));
    light.ok_or_else(|| "expected a number from 0 to 10".into())
}
