use roverlab::vision::FindMethod;

use crate::common::{CommonArgs, OF_ONE_RUN, OF_PARTS, PartArgs};

/// Command line of `color-tracking`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Learns a hue at a key press, then finds an object of that hue, drives to it, or pushes it home",
    after_help = "\
Without --world, --seed determines the scene: a room of 4 m x 4 m with a red can and objects of other hues. When the
first soft key is pressed, the robot learns the colour of a red card before its camera; --hue gives a hue instead. In a
world from a file, the object is the one of that hue that the robot finds; distances are to the nearest one with the
hue.

With --job home, the robot drives round the object and pushes it to its own start (section 11.6). With --campaign, many
scenes with random places, light from 30 to 150 %, and the noise of --noise.

JSON fields:
  job, method, light
  hue                         taught or given, on RoBIOS's scale
  distance_mm                 final true distance between the centres of robot and object
  home_mm                     home: final true distance of the object from home
  time_limit_s, picture
  scenes, reached, wrong      campaign: numbers, and the seeds of failures
Outcomes: reached, home, missed (if the true distance is above 200 mm), blocked, timed_out, collided, failed; with
--campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Task of the robot.
    #[arg(long, value_enum, default_value = "reach")]
    pub(crate) job: Job,

    /// Method of finding the colour in an image.
    #[arg(long, value_enum, default_value = "blob")]
    pub(crate) method: Method,

    /// Hue to look for instead of a taught one, on RoBIOS's scale: red 42, green 126, blue 210.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(..252))]
    pub(crate) hue: Option<u8>,

    /// Hue tolerance: smaller differences match.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u8).range(1..))]
    pub(crate) tolerance: u8,

    /// Brightness of the light; 1 is a well lit room [default: 1].
    #[arg(long, value_name = "F", value_parser = parse_light, allow_hyphen_values = true)]
    pub(crate) light: Option<f64>,

    /// Drive in many scenes and print the number of successes.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Number of scenes in a campaign.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..))]
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
    ("!campaign", &["scenes"]),
    ("!campaign", OF_PARTS),
]);

/// Task of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Job {
    /// Drive to the object.
    Reach,
    /// Push it home.
    Home,
}

impl Job {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Reach => "reach",
            Self::Home => "home",
        }
    }
}

/// Method of finding a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Method {
    /// By the fullest column of the histogram.
    Histogram,
    /// By the largest connected blob.
    Blob,
}

impl Method {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Histogram => "histogram",
            Self::Blob => "blob",
        }
    }

    pub(crate) fn method(self) -> FindMethod {
        match self {
            Self::Histogram => FindMethod::Histogram,
            Self::Blob => FindMethod::Blob,
        }
    }
}

fn parse_light(text: &str) -> Result<f64, String> {
    let light = text.parse().ok().filter(|light: &f64| (0.0..=10.0).contains(light));
    light.ok_or_else(|| "expected a number from 0 to 10".into())
}
