use std::num::NonZero;

use crate::common::{CommonArgs, Failure, OF_A_CAMPAIGN, OF_ONE_RUN, PartArgs};
use roverlab::geometry::units;

/// Command line of `navigate`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Drives a robot with a lidar to a goal in a known world with unmapped obstacles",
    after_help = "\
Without --world, the robot drives in a built-in world with three obstacles unknown to it. With --world, the obstacles of
--unmapped are added where they leave a way, and the robot knows the world without them. Other robots stand still and
are also unknown to it.

--world also accepts MovingAI maps (.map): cells of 500 mm, with the lower left corner of the map at 0,0. Unknown cells
of a ROS map are floor.

With --campaign, generated worlds with up to five unmapped obstacles each; every goal is reachable.

JSON fields:
  goal                        [x, y] mm
  goal_distance_mm            true distance at the end
  position_error_mm           final true error of the robot's position estimate
  planned_length_mm           length of the first plan, or null
  clearance_mm                clearance beside the robot in the first plan, or null
  replans                     number of plan changes caused by scans
  recoveries                  number of times that the robot backed off without progress, or discarded earlier measurements
  unmapped                    obstacles unknown to the robot
  contact_points              list of [x, y] mm, true
  time_limit_s, picture
  runs, reached, contacts, wrong_seeds   with --campaign only
Outcomes: reached, missed (the robot says reached, and is not within 100 mm), unreachable, no_room (the robot is too
large for the goal), stuck, timed_out, collided, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Clearance beside the robot where there is room [default: 0.65 of its radius].
    #[arg(long, value_name = "MM", value_parser = parse_length, allow_hyphen_values = true)]
    pub(crate) clearance: Option<f64>,

    /// Clearance required on either side of a passage [default: 0.2 of its radius].
    #[arg(long, value_name = "MM", value_parser = parse_length, allow_hyphen_values = true)]
    pub(crate) least_clearance: Option<f64>,

    /// Number of obstacles missing from the robot's map [default: 0 with --world].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=100), allow_hyphen_values = true)]
    pub(crate) unmapped: Option<u32>,

    /// Drive through many generated worlds.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Number of worlds in a campaign; each has the next seed.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) runs: u64,

    /// Number of threads in a campaign [default: one per core].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) threads: Option<NonZero<usize>>,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("campaign", OF_ONE_RUN),
    ("campaign", &["unmapped"]),
    ("!campaign", OF_A_CAMPAIGN),
]);

impl Args {
    /// Fails if there is no room for the wished clearance.
    pub(crate) fn parameters(
        &self,
        footprint: roverlab::world::Footprint,
    ) -> Result<roverlab::nav::NavigatorParameters, Failure> {
        let usual = roverlab::nav::NavigatorParameters::for_footprint(footprint);
        let wished = self.clearance.unwrap_or(usual.clearance.max(self.least_clearance.unwrap_or(0.0)));
        let parameters = roverlab::nav::NavigatorParameters {
            clearance: wished,
            least_clearance: self.least_clearance.unwrap_or(usual.least_clearance.min(wished)),
            ..usual
        };
        parameters.validate().map_err(Failure::input)?;
        Ok(parameters)
    }
}

fn parse_length(text: &str) -> Result<f64, String> {
    let length = text.trim().parse().ok().filter(|&mm: &f64| mm > 0.0 && mm <= 1e6);
    length.map(units::from_mm).ok_or_else(|| "expected a number of millimetres above 0".into())
}
