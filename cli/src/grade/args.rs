use std::num::NonZero;
use std::path::PathBuf;

use crate::common::PlainArgs;

/// Command line of `grade`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Runs programs over the worlds and seeds of a rubric, and prints a table of how well they do",
    after_help = "\
A program is a C, C++ or Python file or an executable for RoBIOS, or a command of this program in quotes, such as
\"roverlab a-to-b --goal 2000,1500\". Each run is a process of its own in a folder of its own, with limits on simulated
and real time, memory and file size. After two runs that exceed the real time, a program is not run again. The programs
run with the user's rights: for strangers' programs use an account or a container of its own as well.

The rubric is a TOML file; docs/grading.md explains it, and the folder cli/rubrics has eleven. --html writes a page with
the table and pictures. The runner `robios` is expected beside this program.

JSON fields:
  rubric, title, runs         runs of each program
  programs                    list, in the order given: program, reached, runs, collisions, time_s and path_ratio (medians of
                              the runs that reached), outcomes, beyond_robots (functions that only a simulator has), written
                              (files), output, error
  picture, html
A run is reached, missed, collided, timed_out, crashed or failed.
Outcomes: graded."
)]
pub(crate) struct Args {
    /// The rubric.
    #[arg(value_name = "RUBRIC.toml")]
    pub(crate) rubric: PathBuf,

    /// The programs.
    #[arg(value_name = "PROGRAM", required = true)]
    pub(crate) programs: Vec<String>,

    /// Write a page with the table and pictures.
    #[arg(long, value_name = "FILE.html")]
    pub(crate) html: Option<PathBuf>,

    /// Number of threads [default: one per core].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) threads: Option<NonZero<usize>>,

    #[command(flatten)]
    pub(crate) plain: PlainArgs,
}

crate::common::shares_options!(Args, plain: PlainArgs, unheeded: [("always", &["animation"])]);
