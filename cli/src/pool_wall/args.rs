use roverlab::geometry::units;

use crate::common::{CampaignArgs, CommonArgs, OF_ONE_RUN};

/// Command line of `pool-wall`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Follows the sides of a pool under water, half a metre beside them, by distance sensors",
    after_help = "\
Without --world, the pool is a rectangle, an L or a kidney, which --seed chooses. A world needs water: a line `water_level MM`.
Where it has no start, the craft starts where the water is widest. Mako dives, drives to a side and follows it at 0.3 m/s with
the side on its left.

With --campaign, generated pools of all kinds, ten laps each.

JSON fields:
  rms_error_mm                of the distance from the side of the hull to the pool's, away from corners
  max_error_mm                the largest such error
  laps                        whole rounds
  depth_rms_error_mm          of the depth of the sensor on the way
  picture
  rows                        with --campaign only: the table, by kind of pool
Away from corners: no side within 1.2 m of the nearest one is turned by more than 45 degrees, nor has one been for 5 s.
Outcomes: round, timed_out, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Rounds along the sides.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000), allow_hyphen_values = true)]
    pub(crate) laps: u32,

    /// Depth of the craft's sensor, at the middle of its hull.
    #[arg(long, value_name = "MM", default_value = "800", value_parser = parse_depth, allow_hyphen_values = true)]
    pub(crate) depth: f64,

    #[command(flatten)]
    pub(crate) trials: CampaignArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["goal"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["laps", "depth"]),
    ("!campaign", &["runs", "threads"]),
]);

fn parse_depth(text: &str) -> Result<f64, String> {
    let depth = text.trim().parse().ok().filter(|depth: &f64| (300.0..=100_000.0).contains(depth));
    depth.map(units::from_mm).ok_or_else(|| "expected 300 to 100000 mm".into())
}
