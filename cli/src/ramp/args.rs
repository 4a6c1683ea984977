use crate::common::{CampaignArgs, CommonArgs, OF_A_CAMPAIGN, OF_ONE_RUN};

/// The command line of `ramp`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Drives a tracked robot up a ramp, across a level and down another ramp",
    after_help = "\
Without --world, the levels are generated from --seed: ramps of 7 to 20 degrees, and friction coefficients of 0.4 to 1. A
world needs hills: a line `terrain WIDTH HEIGHT TOP FILE`, and a start in front of a ramp. A Blizzard drives where it has no
robot. The robot knows neither the slope nor where the ramps are.

With --campaign, many generated levels.

JSON fields:
  crossed                     whether it went up by one ramp and came down by another
  edge_distance_mm            smallest true distance between the outline and an edge, or null
  height_mm                   true elevation at the end
  level_mm                    highest true elevation
  max_tilt_deg                the most that the robot was tilted
  slip_percent                motion that the wheels did not report, as a share of theirs, or null
  friction                    coefficient of friction
  looks                       how often it has looked around
  time_limit_s, picture
  runs, passed, falls, median_edge_distance_mm, wrong_seeds   with --campaign only
Outcomes: crossed, not_crossed, no_way_up, no_way_down, stuck, tipped, fell, drowned, collided, timed_out,
failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    #[command(flatten)]
    pub(crate) trials: CampaignArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["goal"]),
    ("campaign", OF_ONE_RUN),
    ("!campaign", OF_A_CAMPAIGN),
]);
