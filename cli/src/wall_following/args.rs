use roverlab::drive::WallSide;

use crate::common::{CommonArgs, OF_ONE_RUN, OF_PARTS, PartArgs};

/// Command line of `wall-following`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Drives a robot along the walls of a room, and measures how well it keeps its distance",
    after_help = "\
Without --world, the room is random, by the seed: corners of 60 to 300 degrees, curves, doors. The run ends after --laps
laps.

Errors are those of the true distance from the robot's centre to the nearest wall on the followed side, once it has
driven 300 mm along a wall, or once round along shorter ones. Away from
corners means farther from a corner than the robot's path round it plus 150 mm. A lap is at least 180 mm wide.

With --campaign, many rooms instead of one, also with the book's controller, and a table.

JSON fields:
  controller                  psd, pid, lidar or book
  side                        left or right; null if no wall was found
  laps                        number of complete laps
  rms_error_mm, max_error_mm  away from corners; null without measurements
  rms_error_everywhere_mm     including corners
  lap_length_mm               true length of the first lap
  time_limit_s, picture
  rows                        with --campaign only: the table
Outcomes: followed, blocked, timed_out, collided, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Controller of the robot.
    #[arg(long, value_enum, default_value = "psd")]
    pub(crate) controller: Controller,

    /// Side of the robot on which to keep the wall; auto: the one that takes less turning. The book's program
    /// only supports the left.
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) side: Side,

    /// Distance of the robot's centre from the wall, in millimetres.
    #[arg(long, value_name = "MM", default_value_t = 200.0, value_parser = parse_distance, allow_hyphen_values = true)]
    pub(crate) distance: f64,

    /// Speed along the wall in millimetres per second.
    #[arg(long, value_name = "MM", default_value_t = 200.0, value_parser = parse_speed, allow_hyphen_values = true)]
    pub(crate) speed: f64,

    /// Number of laps.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..), allow_hyphen_values = true)]
    pub(crate) laps: u32,

    /// Drive through many rooms and print a table.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Number of rooms in a campaign.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) rooms: u64,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("campaign", OF_ONE_RUN),
    ("!campaign", &["rooms"]),
    ("!campaign", OF_PARTS),
]);

/// Controller by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Controller {
    /// Three distance sensors, with lines and curves fitted to their points.
    Psd,
    /// A PID controller on the range to one side.
    Pid,
    /// The shortest beam of a lidar, as in section 9.4.
    Lidar,
    /// The book's program 6.1.
    Book,
}

impl Controller {
    pub(crate) const ALL: [Self; 4] = [Self::Psd, Self::Pid, Self::Lidar, Self::Book];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Psd => "psd",
            Self::Pid => "pid",
            Self::Lidar => "lidar",
            Self::Book => "book",
        }
    }
}

/// Side by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Side {
    /// Wall on the left.
    Left,
    /// Wall on the right.
    Right,
    /// The side that takes less turning.
    Auto,
}

impl Side {
    pub(crate) fn side(self) -> Option<WallSide> {
        match self {
            Self::Left => Some(WallSide::Left),
            Self::Right => Some(WallSide::Right),
            Self::Auto => None,
        }
    }
}

fn parse_distance(text: &str) -> Result<f64, String> {
    let distance = text.parse().ok().filter(|distance: &f64| (100.0..=2000.0).contains(distance));
    distance.ok_or_else(|| "expected 100 to 2000 mm".into())
}

fn parse_speed(text: &str) -> Result<f64, String> {
    let speed = text.parse().ok().filter(|speed: &f64| (10.0..=1000.0).contains(speed));
    speed.ok_or_else(|| "expected 10 to 1000 mm per second".into())
}
