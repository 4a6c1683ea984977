use roverlab::geometry::units;

use crate::common::{CampaignArgs, CommonArgs, OF_A_CAMPAIGN, OF_ONE_RUN};
use crate::water::WaterArgs;

/// Command line of `pool-wall`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Follows the sides of a pool under water at a distance of half a metre, by distance sensors",
    after_help = "\
Without --world, --seed draws the pool: a rectangle, an L or a kidney. A world needs water: a line `water_level MM`.
If it has no start, the craft starts where the water is widest. Mako dives, drives to a side and follows it at 0.3 m/s with
the side on its left. Its Doppler log tells it what a current does.

With --campaign, generated pools of all kinds, ten laps each.

JSON fields:
  rms_error_mm                root mean square error of the distance between hull and side, away from corners
  max_error_mm                the largest such error
  laps                        number of complete laps
  depth_rms_error_mm          root mean square error of the sensor's depth
  picture
  rows                        with --campaign only: the table, by kind of pool
Away from corners: for 5 s, the craft has been beside a side, and no side within 1.2 m of it at more than 45 degrees to it.
Outcomes: round, timed_out, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Number of laps.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000), allow_hyphen_values = true)]
    pub(crate) laps: u32,

    /// Depth of the craft's pressure sensor, at the middle of its hull.
    #[arg(long, value_name = "MM", default_value = "800", value_parser = parse_depth, allow_hyphen_values = true)]
    pub(crate) depth: f64,

    #[command(flatten)]
    pub(crate) waters: WaterArgs,

    #[command(flatten)]
    pub(crate) trials: CampaignArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["goal"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["water", "laps", "depth"]),
    ("!campaign", OF_A_CAMPAIGN),
]);

fn parse_depth(text: &str) -> Result<f64, String> {
    let depth = text.trim().parse().ok().filter(|depth: &f64| (300.0..=100_000.0).contains(depth));
    depth.map(units::from_mm).ok_or_else(|| "expected 300 to 100000 mm".into())
}
