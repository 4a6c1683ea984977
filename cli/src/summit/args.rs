use roverlab::geometry::units;
use roverlab::nav::elevation::Climber;
use roverlab::world::RobotSpec;

use crate::common::{CampaignArgs, CommonArgs, OF_A_CAMPAIGN, OF_ONE_RUN, portable};

/// Method of climbing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Method {
    /// Maps the hills, leaves local maxima, and ends on the highest reachable place.
    Search,
    /// Steepest ascent, by lidar.
    Ascent,
    /// Steepest ascent, by distance sensors that point down.
    Psd,
}

portable!(
    enum Method {
        Search,
        Ascent,
        Psd,
    }
);

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
    about = "Drives a tracked robot to the highest reachable place of unknown hills",
    after_help = "\
Without --world, the hills are generated from --seed. A world needs hills: a line `terrain WIDTH HEIGHT TOP FILE`, whose file
is an image or an ESRI grid. If it has no robot, a Blizzard drives. The robot knows the level of the world's water, if any.

With --campaign, generated ranges by each method.

JSON fields:
  height_mm                   true elevation at the end
  highest_reachable_mm        elevation of the highest place reachable within the slope limit
  distance_mm                 true horizontal distance from that place
  max_tilt_deg                maximum tilt of the robot
  slip_percent                motion that the wheels did not report, as a share of theirs, or null
  planned_length_mm           length of the path planned on the true map, or null
  slope_limit_deg             maximum slope that the robot drives on
  looks                       number of looks around
  unknown_m2                  area that may be higher and reachable for all the robot knows, or null
  time_limit_s, picture
  runs, reached, mishaps, median_path_ratio, ways, wrong_seeds   with --campaign only
Reached: at most 100 mm from the highest reachable place, or 2 % of the relief and 1 mm below it.
Outcomes: reached, local_maximum, stuck, tipped, fell, drowned, collided, timed_out, failed; with
--campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Method of climbing.
    #[arg(long, value_enum, default_value_t = Method::Search)]
    pub(crate) method: Method,

    /// Steepest slope [default: 70 % of the slope at which the robot slips or tips].
    #[arg(long, value_name = "DEG", value_parser = parse_slope, allow_hyphen_values = true)]
    pub(crate) slope: Option<f64>,

    #[command(flatten)]
    pub(crate) trials: CampaignArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["goal"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["method"]),
    ("!campaign", OF_A_CAMPAIGN),
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
