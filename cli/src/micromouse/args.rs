use std::num::NonZero;
use std::path::PathBuf;

use crate::common::{CommonArgs, OF_ONE_RUN, parse_seconds};

/// Command line of `micromouse`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Explores a maze of any format with a robot until the best way is proved, and drives it as fast as the robot can",
    after_help = "\
Formats: the micromouse text format, kerikun11's .maze, mms's map and num, EyeSim's .maz, and the old binary files. They are
told from the content. Unknown walls count as walls. Without --maze, a maze of the command's own.

With --plan, the way through the known maze and no drive. Without it, a micromouse that knows the size of the maze, its start and
its goal explores it: to the goal, then to such unknown walls as could make the route with the fewest steps or the fastest
one better, and back. Then it drives the fastest run, with smooth turns and diagonals.

JSON fields:
  maze, format                the file, and its format: text, maze, map, num, eyesim or binary
  width, height               cells
  start, start_heading        [x, y] of the start cell; north, east, south or west
  goals                       [x, y] of each goal cell
  defects                     what is wrong with the file and the maze, in words
  reachable_cells             cells that a way leads to from the start, itself included
  shortest_steps              steps of the shortest route from start to goal; -1 when there is none
  min_turns                   fewest turns of all routes that short; -1 when there is none. Turns are counted for a robot that faces
                              north at the start, whatever start_heading is
  fewest_turns                fewest turns of any route; -1 when there is none
  fewest_turns_steps          steps of the shortest of those routes; -1 when there is none
  route                       the route of the fewest steps and then turns, a letter n, e, s or w for each step
With a drive instead of the last six:
  proved_optimal              whether no unknown wall can make the best route better, or give one where there is none
  visited_cells, looks        cells that the robot has been in, and stops to look around
  unknown_walls               walls that it need not know
  exploration_s               simulated seconds until it is back at the start
  fast_run_planned_s          seconds from standstill to standstill by the plan; null without a way
  fast_run_s                  the same as driven
  fast_run_steps              cells of the fast run
  localisation_error_mm       true error of where the robot takes itself to be in the end
  goal_error_mm               from where it truly is after the fast run to the middle of a cell of the goal; null without one
  cell_mm
  picture                     always
With --campaign:
  folder
  mazes                       files that hold a maze
  rows                        a row for each size and for all: mazes, runs, proved, collided, with the best plan, raced within
                              2 percent of the plan, the worst relative difference, the largest localisation error in mm
  failures                    maze, seed, and what went wrong, of each run that is not good
A run is good if it proves its maze without a contact, plans the fastest run of the true maze, keeps to that plan, and
ends it within a quarter of a cell of the goal.
With --mms-run, after the fields of the maze, whose start is the lower left corner, facing north, and whose goal is the centre:
  program                     the command that was run
  solved, score               whether a run came to the goal; the simulator's score, the lower the better, 2000 unsolved
  commands, ignored_lines     lines of the program that were commands, and that were none
  total_distance, total_turns, total_effective_distance   cells, quarter turns, cells with long straights counted by half
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

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

impl Args {
    /// Number of threads.
    pub(crate) fn threads(&self) -> usize {
        let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
        self.threads.map_or_else(cores, NonZero::get)
    }
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("campaign", OF_ONE_RUN),
    ("plan", &["seed", "noise", "time_limit", "quantised", "realtime", "fault", "supervised", "doubled"]),
    ("mms_run", &["seed", "noise", "time_limit", "quantised", "realtime", "fault", "supervised", "picture", "animation", "doubled"]),
    ("!mms_run", &["patience", "mms_limit"]),
]);
