use std::num::NonZero;

use roverlab::nav::BugKind;
use roverlab::world::generate::CourseFamily;

use crate::common::CommonArgs;

/// Command line of `bug-compare`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Compares the algorithms of the bug family: path lengths by kind of world, and verdicts against the truth",
    after_help = "\
Without --world, every algorithm drives through the same courses of every family. With --world it drives through that
world alone, --runs times; start and goal are as for the command `distbug`.

With --campaign, all drive through generated courses of every kind instead, and every verdict is compared with the truth.
At noise 0, paths are compared with the algorithms' bounds as well: the perimeters in them are those of the boundaries
that the robot's middle follows, plus 2 %. The outcome is `passed` if every verdict of an algorithm that is proved complete
is right, nothing was touched and no bound was broken.

--picture shows the paths of all on the world of --world, or else on the first course of the campaign or of the first
family. With --record, all drive through this one world alone, side by side in the recording.

JSON fields:
  rows               list of {bug, family, runs, correct, contacts, and over correct runs: mean_path_mm, path_ci_mm,
                     mean_ratio and ratio_ci (to the shortest way, null where there is none), mean_hits}
  runs               list of {bug, family, seed, outcome, reachable, correct, contacts, path_mm, shortest_mm, hits}
  picture            the file's name, or null
and with --campaign, instead of rows and runs:
  bugs               list of {bug, complete, runs, correct, contacts, wrong_seeds, contact_seeds, bounds_checked,
                     bounds_broken, closest} where `closest` is the largest ratio of a path to its bound
Intervals are [low, high]: 95 %, by the bootstrap over courses.
Outcomes: compared, wrong (a verdict of an algorithm that is proved complete, or a bound), passed, collided."
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

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["quantised"]),
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
