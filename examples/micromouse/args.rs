use std::path::PathBuf;

use crate::common::CommonArgs;

/// The command line of the example `micromouse`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    name = "micromouse",
    about = "Reads a maze of any format and plans the way through it",
    after_help = "\
Formats: the micromouse text format, kerikun11's .maze, mms's map and num, EyeSim's .maz, and the old binary files. They are
told from the content. Unknown walls count as walls. Without --maze, a maze of the example's own.

JSON fields:
  maze, format                the file, and its format: text, maze, map, num, eyesim or binary
  width, height               cells
  start, start_heading        [x, y] of the start cell; north, east, south or west
  goals                       [x, y] of each goal cell
  defects                     what is wrong with the file and the maze, in words
  reachable_cells             cells that a way leads to from the start, itself included
  shortest_steps              steps of the shortest route from start to goal; -1 when there is none
  min_turns                   fewest turns of all routes that short, for a robot that faces the start heading; -1 when none
  fewest_turns                fewest turns of any route; -1 when there is none
  fewest_turns_steps          steps of the shortest of those routes; -1 when there is none
  route                       the route of the fewest steps and then turns, a letter n, e, s or w for each step
  picture
Outcomes: planned, unreachable."
)]
pub(crate) struct Args {
    /// The maze.
    #[arg(long, value_name = "FILE")]
    pub(crate) maze: Option<PathBuf>,

    /// Plan the way and do not drive.
    #[arg(long)]
    pub(crate) plan: bool,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

impl AsRef<CommonArgs> for Args {
    fn as_ref(&self) -> &CommonArgs {
        &self.common
    }
}
