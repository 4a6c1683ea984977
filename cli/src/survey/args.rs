use std::path::PathBuf;

use roverlab::drive::marine::SurveyParameters;
use roverlab::geometry::units;
use roverlab::world::World;

use super::tour::OFF;
use crate::common::{CampaignArgs, CommonArgs, OF_A_CAMPAIGN, OF_ONE_RUN, parse_png};
use crate::water::{NEAREST, WaterArgs};

/// Command line of `survey`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Maps the floor of a pool in lanes under water, with the uncertainty of each depth",
    after_help = "\
Without --world, Mako surveys the book's pool of 25 x 50 m, whose floor --seed draws: slopes, steps, or a bowl. A world needs
water: a line `water_level MM`. With --altitude, the floor is a ridge with slopes of 20 % in deeper water. Mako has a Doppler
log, a compass and distance sensors; where the water ends at four straight sides, it localises by these too. It starts where the
water is widest, unless the world or --start states a start.

Cells are at least half a metre from the sides, and at most as wide as the spacing or half a metre, whichever is more, so that
whole ones fill the narrower side. Where lanes are narrow, the first ones lead along the sides; of half a metre, the cell in each
corner is out of reach. In currents of 50 mm/s and more, it may touch the sides where it turns. The uncertainty of a depth has the
noise, place, datum and waves of its soundings in it, and how far the floor around is off a quadratic surface. --map writes a colour
picture, and beside it the depths as an ESRI grid (.asc) and all cells with their uncertainty as a table (.csv), in mm.

With --campaign, floors of all kinds: 12 of them without --runs.

JSON fields:
  coverage_percent            share of the cells with a depth
  depth_error_p95_mm          95th percentile of the error of a cell's mean depth
  position_error_p95_mm       95th percentile of the position error
  inside_2_sigma_percent      share of the depths within two of their standard deviations
  way_ratio                   length of the path relative to area by spacing
  altitude_rms_error_mm       with --altitude only: root mean square error of the altitude, from when it was first reached
  by_walls                    whether the sides were used for localisation
  map, picture
  rows                        with --campaign only: the table
Outcomes: covered, not_covered (less than 99 % of the cells), timed_out, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Distance between lanes.
    #[arg(long, value_name = "MM", default_value = "1000", value_parser = parse_spacing, allow_hyphen_values = true)]
    pub(crate) spacing: f64,

    /// Depth of the craft's pressure sensor.
    #[arg(long, value_name = "MM", default_value = "500", value_parser = parse_depth, allow_hyphen_values = true)]
    pub(crate) depth: f64,

    /// Altitude above the floor to hold, of the sensor that points down, instead of the depth, which is then
    /// the least one.
    #[arg(long, value_name = "MM", value_parser = parse_altitude, allow_hyphen_values = true)]
    pub(crate) altitude: Option<f64>,

    /// Write the map to a .png file, with .asc and .csv files beside it.
    #[arg(long, value_name = "OUT.png", value_parser = parse_png)]
    pub(crate) map: Option<PathBuf>,

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
    ("campaign", &["water", "map"]),
    ("!campaign", OF_A_CAMPAIGN),
]);

impl Args {
    /// The parameters of a survey in a world's water.
    pub(super) fn parameters(&self, world: &World) -> SurveyParameters {
        let parameters = SurveyParameters::default();
        SurveyParameters {
            spacing: self.spacing,
            brim: (OFF + 0.5 * self.spacing).clamp(NEAREST, parameters.margin),
            depth: self.depth,
            altitude: self.altitude,
            density: world.water.density,
            waves: world.water.waves,
            ..parameters
        }
    }
}

fn parse_spacing(text: &str) -> Result<f64, String> {
    let spacing = text.trim().parse().ok().filter(|spacing: &f64| (200.0..=100_000.0).contains(spacing));
    spacing.map(units::from_mm).ok_or_else(|| "expected 200 to 100000 mm".into())
}

fn parse_depth(text: &str) -> Result<f64, String> {
    let depth = text.trim().parse().ok().filter(|depth: &f64| (300.0..=100_000.0).contains(depth));
    depth.map(units::from_mm).ok_or_else(|| "expected 300 to 100000 mm".into())
}

fn parse_altitude(text: &str) -> Result<f64, String> {
    let altitude = text.trim().parse().ok().filter(|altitude: &f64| (200.0..=100_000.0).contains(altitude));
    altitude.map(units::from_mm).ok_or_else(|| "expected 200 to 100000 mm".into())
}
