//! The command `grid-benchmark`.

mod job;
mod own_map;
pub(crate) mod picture;

pub(crate) use job::work;

use std::num::NonZero;
use std::path::PathBuf;

use crate::common::PlainArgs;

/// Command line of `grid-benchmark`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Answers the queries of a scenario file on a grid map and compares the paths' lengths with the published ones",
    after_help = "\
Without --map and --scen, map (with rooms) and queries are random, by --seed. The reference lengths are then Dijkstra's.

JSON fields:
  map, algorithm, width, height
  queries                     number of queries
  skipped                     queries that start or end in a blocked cell, or lead from water to land or vice versa
  solved                      queries with a path
  prepared                    false if the map has too many jumps (jps_plus) or sight lines (any_angle) to find all beforehand
  optimal                     queries with a path of the published length, within max(0.006, 2e-5 of the length)
  mean_ratio, worst_ratio     ratio of the length to the published one
  mean_expanded               nodes removed from the queue, per query
  timing                      with --timing: median_us and p95_us of a query, preprocess_ms of the map
  picture                     the longest query with four planners
Outcomes: solved; wrong if a query that was not skipped has no path, or an octile planner's path differs in length from the
published one. Water (`W`) is a separate map: paths are within water or within land. A query that starts or ends outside
of the map is invalid."
)]
pub(crate) struct Args {
    /// MovingAI map.
    #[arg(long, value_name = "FILE.map", requires = "scen")]
    pub(crate) map: Option<PathBuf>,

    /// MovingAI scenarios for the map.
    #[arg(long, value_name = "FILE.scen", requires = "map")]
    pub(crate) scen: Option<PathBuf>,

    /// Planner.
    #[arg(long, value_enum, default_value = "jps_plus")]
    pub(crate) algorithm: Algorithm,

    /// Number of times to answer every query; the fastest time counts.
    #[arg(long, value_name = "N", default_value = "1", allow_hyphen_values = true)]
    pub(crate) repeat: NonZero<u32>,

    #[command(flatten)]
    pub(crate) plain: PlainArgs,
}

crate::common::shares_options!(Args, plain: PlainArgs, unheeded: [("map", &["seed"])]);

/// Planner by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum Algorithm {
    /// Dijkstra's algorithm.
    Dijkstra,
    /// A*.
    Astar,
    /// Jump point search without preparation.
    Jps,
    /// Jump point search with precomputed jumps.
    JpsPlus,
    /// The shortest any-angle paths.
    AnyAngle,
    /// Paths through a quadtree's free squares, pulled straight.
    Quadtree,
}

impl Algorithm {
    /// Name on the command line.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Dijkstra => "dijkstra",
            Self::Astar => "astar",
            Self::Jps => "jps",
            Self::JpsPlus => "jps_plus",
            Self::AnyAngle => "any_angle",
            Self::Quadtree => "quadtree",
        }
    }

    /// Whether its paths are octile, like those of scenario files.
    pub(crate) fn is_octile(self) -> bool {
        matches!(self, Self::Dijkstra | Self::Astar | Self::Jps | Self::JpsPlus)
    }
}
