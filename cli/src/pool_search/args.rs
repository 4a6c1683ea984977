use crate::common::{CampaignArgs, CommonArgs, OF_A_CAMPAIGN, OF_ONE_RUN};
use crate::water::WaterArgs;

/// Command line of `pool-search`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Searches the floor of a pool for something red, by camera, and says where it is",
    after_help = "\
Without --world, --seed chooses a pool, a red thing among others on its floor, and the turbidity of the water: 0.05, 0.3 or 1
per metre. A world needs water: a line `water_level MM`, and one `turbidity B` if it is not clear. Mako drives lanes with its
camera down, the first ones along the sides, and knows its place by Doppler log, compass and, where the water ends at four straight
sides, by these. It sees no colour in what is much darker than the floor, and nothing in
corners, of which it keeps clear by a metre.

With --campaign, 200 pools in light from 30 to 150 %.

JSON fields:
  found                       whether something red was found
  position_error_mm           from the find to the nearest red thing, or null
  place_mm                    where the find is in the pool's frame, or null
  turbidity                   of the water (1/m)
  light
  picture
  rows                        with --campaign only: the table, by turbidity
Outcomes: found, not_found (a success where nothing is red), blind (it was too dark for colours), false_find (more than 300 mm
from anything red), timed_out, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Brightness of the light; 1 is a well lit pool [default: 1].
    #[arg(long, value_name = "F", value_parser = parse_light, allow_hyphen_values = true)]
    pub(crate) light: Option<f64>,

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
    ("campaign", &["water", "light"]),
    ("!campaign", OF_A_CAMPAIGN),
]);

fn parse_light(text: &str) -> Result<f64, String> {
    let light = text.parse().ok().filter(|light: &f64| (0.0..=10.0).contains(light));
    light.ok_or_else(|| "expected a number from 0 to 10".into())
}
