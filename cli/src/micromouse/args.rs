use std::num::NonZero;
use std::path::PathBuf;

use crate::common::{CommonArgs, OF_ONE_RUN, OF_PARTS, PartArgs, parse_seconds};

/// Command line of `micromouse`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Explores a maze in any format until the best path is proved, and drives it as fast as the robot can",
    after_help = "\
Formats: the micromouse text format, kerikun11's .maze, mms's map and num, EyeSim's .maz, and the old binary files. The
format is recognised from the content. Unknown walls count as walls. Without --maze, a built-in maze.

With --plan, a path through the known maze without a drive. Otherwise, a micromouse that knows the size of the maze, its
start and its goal explores it: to the goal, then to the unknown walls that could improve the route with the fewest
steps or the fastest one, and back. Then it drives the fastest run, with smooth turns and diagonals.

JSON fields:
  maze, format                file name, and format: text, maze, map, num, eyesim or binary
  width, height               cells
  start, start_heading        [x, y] of the start cell; north, east, south or west
  goals                       [x, y] of each goal cell
  defects                     description of errors in the file and the maze
  reachable_cells             cells reachable from the start, including itself
  shortest_steps              steps of the shortest route from start to goal; -1 if there is none
  min_turns                   fewest turns of all shortest routes; -1 if there is none. Turns are counted for a robot that faces
                              north at the start, independent of start_heading
  fewest_turns                fewest turns of any route; -1 if there is none
  fewest_turns_steps          steps of the shortest of those routes; -1 if there is none
  route                       route with the fewest steps, then turns; one letter n, e, s or w per step
With a drive instead of the last six:
  proved_optimal              whether no unknown wall can improve the best route or create one
  visited_cells, looks        visited cells, and stops for measurements
  unknown_walls               irrelevant walls that remain unknown
  exploration_s               simulated seconds until the return to the start
  fast_run_planned_s          planned seconds from standstill to standstill; null without a path
  fast_run_s                  the same, measured
  fast_run_steps              cells of the fast run
  localisation_error_mm       final true error of the robot's position estimate
  goal_error_mm               true distance after the fast run to the middle of a goal cell; null without one
  cell_mm
  picture                     always
With --campaign:
  folder
  mazes                       files with a maze
  rows                        one row per size and one for all: mazes, runs, proved, collided, with the best plan, raced within
                              2 percent of the plan, largest relative difference, largest localisation error in mm
  failures                    maze, seed and error of each failed run
A run succeeds if it proves its maze without a contact, plans the fastest run of the true maze, follows that plan, and
ends within a quarter of a cell of the goal.
With --mms-run, after the fields of the maze, with its start in the lower left corner, facing north, and its goal in the centre:
  program                     the executed command
  solved, score               whether a run reached the goal; the simulator's score: lower is better, 2000 is unsolved
  commands, ignored_lines     lines of the program that were commands, and other lines
  total_distance, total_turns, total_effective_distance   cells, quarter turns, cells with long straights counted half
  best_run_distance, best_run_turns, best_run_effective_distance   the same of the best run; null without one
Outcomes: planned, raced, unreachable, timed_out, collided, failed; of a campaign passed, wrong; of a program solved,
unsolved, failed."
)]
#[allow(clippy::struct_excessive_bools, reason = "a switch each")]
pub(crate) struct Args {
    /// Maze file.
    #[arg(long, value_name = "FILE")]
    pub(crate) maze: Option<PathBuf>,

    /// Only plan the route.
    #[arg(long, conflicts_with = "explore")]
    pub(crate) plan: bool,

    /// Explore and race (default).
    #[arg(long)]
    pub(crate) explore: bool,

    /// Use an EyeBot S4 in a maze of twice the size, as in the book.
    #[arg(long)]
    pub(crate) doubled: bool,

    /// Explore and race through all mazes in a folder and its subfolders, and print a table.
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["maze", "plan", "explore", "world"])]
    pub(crate) campaign: Option<PathBuf>,

    /// Runs through each maze of a campaign, with seeds starting at --seed.
    #[arg(long, value_name = "N", default_value_t = 1, requires = "campaign")]
    pub(crate) runs: u64,

    /// Number of threads in a campaign [default: one per core].
    #[arg(long, value_name = "N", requires = "campaign")]
    pub(crate) threads: Option<NonZero<usize>>,

    /// Act as a mouse for the simulator mms: commands on standard output, answers on standard input.
    #[arg(long, conflicts_with_all = ["maze", "plan", "explore", "campaign", "mms_run"])]
    pub(crate) mms: bool,

    /// Run a mouse written for mms in the maze, with its arguments after blanks.
    #[arg(long, value_name = "PROGRAM", conflicts_with_all = ["plan", "explore", "campaign"])]
    pub(crate) mms_run: Option<String>,

    /// Seconds without output from the program after which it is stopped.
    #[arg(long, value_name = "S", value_parser = parse_seconds, default_value = "10", allow_hyphen_values = true)]
    pub(crate) patience: f64,

    /// Total time limit of the program in seconds.
    #[arg(long, value_name = "S", value_parser = parse_seconds, default_value = "600", allow_hyphen_values = true)]
    pub(crate) mms_limit: f64,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("campaign", OF_ONE_RUN),
    ("!campaign", OF_PARTS),
    ("plan", &["seed", "noise", "time_limit", "quantised", "realtime", "fault", "supervised", "doubled"]),
    ("mms_run", &["seed", "noise", "time_limit", "quantised", "realtime", "fault", "supervised", "picture", "animation", "doubled"]),
    ("!mms_run", &["patience", "mms_limit"]),
]);
