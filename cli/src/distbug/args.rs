use std::num::NonZero;
use std::path::PathBuf;

use crate::common::{CommonArgs, OF_PARTS, PartArgs, parse_noise};

/// Command line of `distbug`.
#[derive(Debug, clap::Parser)]
#[command(
    about = "Drives a robot with a lidar to a goal among unknown obstacles, or proves that there is no way (DistBug)",
    after_help = "\
Without --world, the robot drives in a built-in world. A .sim provides robot, start and goal (its first robot and first
marker), a .maz start and goal (the letters S and G), a .wld the start (`position`); --robot, --start and --goal take
precedence. Other robots stand still.

The default --time-limit is generous for the size of the world. Without --picture, the run is drawn to
target/pictures/distbug.svg, except with --json.

With --campaign, generated courses instead of one. A verdict is correct if it is `unreachable` and there is no path, or
`reached`, there is a path, and the robot is truly within 50 mm of the goal, or within 250 mm with noise. Contacts are
counted separately. The results do not depend on --threads; the course of one seed is that of `--seed SEED --worlds 1`.

JSON fields:
  goal                       [x, y] mm
  goal_distance_mm           true distance at the end
  hit_points, leave_points   lists of [x, y] mm in the world, as estimated by the robot
  contact_points             list of [x, y] mm, true
  time_limit_s               time limit of the run in simulated seconds
  picture                    file name, or null
  error                      reason, only if the robot failed
  worlds, levels             with --campaign only: number of courses; results at each noise level
  timing                     with --timing and --campaign: real_time_factor
Outcomes: reached, missed (the robot says reached, and is not within 50 mm, or 250 mm with noise), unreachable, no_room
(the robot is too large for the goal), timed_out, collided, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Drive through many generated courses and compare the verdicts with the truth. Their noise levels are
    /// given by --levels, and their time limits depend on their size.
    #[arg(long, conflicts_with_all = ["noise", "time_limit", "realtime", "quantised", "supervised"])]
    pub(crate) campaign: bool,

    /// Number of courses in a campaign. Each has the next seed.
    #[arg(long, value_name = "N", default_value_t = 1000, requires = "campaign", value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) worlds: u64,

    /// Noise levels of a campaign.
    #[arg(long, value_name = "F,...", default_value = "0,1,2", requires = "campaign", value_delimiter = ',', value_parser = parse_noise, allow_hyphen_values = true)]
    pub(crate) levels: Vec<f64>,

    /// Number of threads in a campaign [default: one per core].
    #[arg(long, value_name = "N", requires = "campaign", allow_hyphen_values = true)]
    pub(crate) threads: Option<NonZero<usize>>,

    /// Write the failed courses of a campaign into this folder, as .sim and .wld.
    #[arg(long, value_name = "DIR", requires = "campaign")]
    pub(crate) save: Option<PathBuf>,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [("!campaign", OF_PARTS)]);
