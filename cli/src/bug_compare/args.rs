use std::num::NonZero;

use roverlab::nav::BugKind;
use roverlab::world::generate::CourseFamily;

use crate::common::{CommonArgs, OF_PARTS, PartArgs};

/// Command line of `bug-compare`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Compares the algorithms of the bug family: path lengths by kind of world, and verdicts against the truth",
    after_help = "\
Without --world, every algorithm drives the same courses of every family. With --world it drives only in that world,
--runs times; start and goal are as for the command `distbug`.

With --campaign, all drive generated courses of every kind instead, and every verdict is compared with the truth. At
noise 0, paths are also compared with the algorithms' bounds, whose perimeters are those of the boundaries for the
robot's centre, plus 2 %. The outcome is `passed` if every verdict of a provably complete algorithm is correct, and
there were no contacts and no violated bounds.

--picture shows all paths in the world of --world, otherwise on the first course of the campaign or of the first family.
With --record, all drive only in this world, and are recorded side by side.

JSON fields:
  rows               list of {bug, family, runs, correct, contacts, and over correct runs: mean_path_mm, path_ci_mm,
                     mean_ratio and ratio_ci (to the shortest path, null if there is none), mean_hits}
  runs               list of {bug, family, seed, outcome, reachable, correct, contacts, path_mm, shortest_mm, hits}
                     reachable: whether a way leads to within 25 mm of the goal for a disc of 1.2 robot radii, the
                     passages that the algorithms count as open; null if some millimetres decide
  picture            file name, or null
and with --campaign, instead of rows and runs:
  bugs               list of {bug, complete, runs, correct, contacts, wrong_seeds, contact_seeds, bounds_checked,
                     bounds_broken, closest} where `closest` is the largest ratio of a path to its bound
Intervals [low, high] are 95 % bootstrap intervals over courses.
Outcomes: compared, wrong (a verdict of a provably complete algorithm, or a bound), timed_out (a run was cut by
--time-limit), passed, collided."
)]
pub(crate) struct Args {
    /// Courses of each family, or runs in the world of --world [default: 10], or courses of the campaign
    /// [default: 1000].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000_000), allow_hyphen_values = true)]
    pub(crate) runs: Option<u64>,

    /// Algorithms to compare [default: all].
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) bugs: Vec<BugKind>,

    /// Families of courses: local-minima, complex-terrain, semi-convex, unreachable [default: all].
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) families: Vec<CourseFamily>,

    /// Compare verdicts with the truth, and paths with their bounds, on many courses.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// How many threads drive [default: one for each core].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) threads: Option<NonZero<usize>>,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["quantised"]),
    ("!campaign", OF_PARTS),
]);

impl Args {
    /// The algorithms to compare.
    pub(crate) fn bugs(&self) -> &[BugKind] {
        if self.bugs.is_empty() { &BugKind::ALL } else { &self.bugs }
    }

    /// The families of courses.
    pub(crate) fn families(&self) -> &[CourseFamily] {
        if self.families.is_empty() { &CourseFamily::ALL } else { &self.families }
    }
}
