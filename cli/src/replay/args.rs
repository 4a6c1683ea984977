use std::path::PathBuf;

use crate::common::{Heeds, Unheeded, parse_picture};

/// Command line of `replay`.
#[derive(Debug, clap::Parser)]
#[command(
    about = "Replays recordings, shows their content, and recovers damaged ones",
    after_help = "\
JSON fields: example, command, outcome;
  check     program, difference: null, or {robot, time_s, found, expected}
  recover   chunks, messages, header (whether it is recovered), lost_bytes
  info      program, version, schema, seed, options, robots, start_s, end_s, bytes, chunks, topics, attachments,
            attachments_hash, attachments_lost (whether any are lost), compression
  export    rows, csv, picture
Outcomes: same, different, recovered, read, exported. The exit status is 1 for `different`."
)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Command,

    /// Print exactly one JSON object on standard output, and nothing else there.
    #[arg(long, global = true)]
    pub(crate) json: bool,
}

impl Heeds for Args {
    const UNHEEDED: &'static [Unheeded] = &[];
}

/// Task of the command.
#[derive(Debug, Clone, clap::Subcommand)]
pub(crate) enum Command {
    /// Runs the recording's program on the recorded inputs, and compares the new recording byte for byte.
    Check {
        /// The recording.
        file: PathBuf,
    },
    /// Recovers every complete chunk of a truncated or damaged recording.
    Recover {
        /// The damaged recording.
        file: PathBuf,
        /// The file to write.
        out: PathBuf,
    },
    /// Shows the content of a recording.
    Info {
        /// The recording.
        file: PathBuf,
    },
    /// Writes a recording's calls as a table, and its paths as a picture.
    Export {
        /// The recording.
        file: PathBuf,
        /// The table to write.
        #[arg(long, value_name = "FILE.csv", required_unless_present = "picture")]
        csv: Option<PathBuf>,
        /// The picture to draw: .svg or .png.
        #[arg(long, value_name = "FILE", value_parser = parse_picture)]
        picture: Option<PathBuf>,
    },
}
