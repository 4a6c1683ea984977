use std::num::NonZero;

use roverlab::geometry::units;
use roverlab::nav::elevation::Climber;
use roverlab::world::RobotSpec;

use crate::common::{CommonArgs, OF_ONE_RUN};

/// How the robot goes up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Method {
    /// Maps what it sees, leaves local maxima behind, and ends on the highest place that it can reach.
    Search,
    /// The steepest way up, by what the lidar shows around.
    Ascent,
    /// The steepest way up, by distance sensors that look down.
    Psd,
}

impl Method {
    pub(crate) const ALL: [Self; 3] = [Self::Search, Self::Ascent, Self::Psd];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Search => "search",
            Self::Ascent => "ascent",
            Self::Psd => "psd",
        }
    }
}

/// The command line of `summit`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Drives a tracked robot to the highest place of hills that it does not know",
    after_help = "\
Without --world, the robot stands on generated hills, which --seed chooses. A world needs hills: a line `terrain WIDTH HEIGHT
TOP FILE`, whose file is an image or an ESRI grid. A Blizzard drives where it has no robot. In a world with water the robot
is told how high that is.

With --campaign, generated ranges by each way of going up.

JSON fields:
  height_mm                   true elevation at the end
  highest_reachable_mm        elevation of the highest place that can be reached within the slope limit
  distance_mm                 true distance from that place over the map
  max_tilt_deg                the most that the robot was tilted
  slip_percent                how far it moved otherwise than its wheels said, as a share of their way
  planned_length_mm           the way there of who knows the map, or null
  slope_limit_deg             of the ground that the robot trusts itself on
  looks                       how often it has looked around
  unknown_m2                  ground that may be higher and may be reached, for all that it knows
  time_limit_s, picture
  runs, reached, mishaps, median_path_ratio, ways, wrong_seeds   with --campaign only
Reached is what lies at most 100 mm from the highest reachable place, or 2 % of the relief below it.
Outcomes: reached, local_maximum, stuck, tipped, fell, drowned, timed_out, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// How the robot goes up.
    #[arg(long, value_enum, default_value_t = Method::Search)]
    pub(crate) method: Method,

    /// The steepest ground on which the robot trusts itself [default: seven tenths of where it would slip or
    /// tip].
    #[arg(long, value_name = "DEG", value_parser = parse_slope, allow_hyphen_values = true)]
    pub(crate) slope: Option<f64>,

    /// Climb many hills.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Hills of a campaign; each has the next seed.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) runs: u64,

    /// How many threads climb in a campaign [default: one for each core].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) threads: Option<NonZero<usize>>,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["goal"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["method"]),
    ("!campaign", &["runs", "threads"]),
]);

impl Args {
    /// What the robot trusts itself on.
    pub(crate) fn climber(&self, spec: &RobotSpec) -> Climber {
        let usual = Climber::of(spec);
        self.slope.map_or(usual, |slope| usual.with_slope(slope))
    }
}

fn parse_slope(text: &str) -> Result<f64, String> {
    let slope = text.trim().parse().ok().filter(|degrees| (1.0..=60.0).contains(degrees));
    slope.map(units::from_deg).ok_or_else(|| "expected degrees from 1 to 60".into())
}
