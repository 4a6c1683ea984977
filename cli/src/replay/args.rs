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
  export    rows, csv, picture; of a bag messages, topics (the number of messages on each), ros2
  import    scans, poses, images, commands, topics, duration_s, out; late (messages with an earlier time than the one before,
            which count as simultaneous); mount (the lidar's pose on the robot; null if the bag does not say)
Outcomes: same, different, recovered, read, exported, imported. The exit status is 1 for `different`."
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

/// What an export can write instead of a table.
#[cfg(feature = "ros2")]
const REQUIRED: [&str; 2] = ["picture", "ros2"];
/// The same without bags.
#[cfg(not(feature = "ros2"))]
const REQUIRED: [&str; 1] = ["picture"];

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
        /// Write in the place of a file that is no recording too.
        #[arg(long)]
        force: bool,
    },
    /// Shows the content of a recording.
    Info {
        /// The recording.
        file: PathBuf,
    },
    /// Writes a recording's calls as a table, its paths as a picture, or its sensors as a bag of ROS 2.
    Export {
        /// The recording.
        file: PathBuf,
        /// The table to write.
        #[arg(long, value_name = "FILE.csv", required_unless_present_any = REQUIRED)]
        csv: Option<PathBuf>,
        /// The picture to draw: .svg or .png.
        #[arg(long, value_name = "FILE", value_parser = parse_picture)]
        picture: Option<PathBuf>,
        /// The bag of ROS 2 to write: scans, odometry, images, commands, transforms and map.
        #[cfg(feature = "ros2")]
        #[arg(long, value_name = "FILE.mcap", conflicts_with_all = ["csv", "picture"])]
        ros2: Option<PathBuf>,
        /// Write the bag in the place of a file that is neither a recording nor a bag too.
        #[cfg(feature = "ros2")]
        #[arg(long, requires = "ros2")]
        force: bool,
    },
    /// Makes a recording of a bag of ROS 2: scans, odometry, images and commands of one robot.
    #[cfg(feature = "ros2")]
    Import {
        /// The bag, an MCAP file.
        #[arg(long, value_name = "FILE.mcap")]
        ros2: PathBuf,
        /// The recording to write.
        #[arg(long, value_name = "FILE.mcap")]
        out: PathBuf,
        /// Write in the place of a file that is no recording too.
        #[arg(long)]
        force: bool,
        /// Topic of the scans, if there are several.
        #[arg(long, value_name = "TOPIC")]
        scan: Option<String>,
        /// Topic of odometry, if there are several.
        #[arg(long, value_name = "TOPIC")]
        odometry: Option<String>,
        /// Topic of the images, if there are several.
        #[arg(long, value_name = "TOPIC")]
        camera: Option<String>,
        /// Topic of the commanded velocities, if there are several.
        #[arg(long, value_name = "TOPIC")]
        commands: Option<String>,
    },
}
