//! The command `view`.

use std::path::PathBuf;
use std::thread;

use roverlab::io::log::Log;
use roverlab_view::serve::{Opening, Player};

use crate::common::{Failure, Heeds, Printed, Unheeded, announce, port_failure, recording_bytes};

/// Command line of `view`.
#[derive(Debug, clap::Parser)]
#[command(
    about = "Shows a recording in a page, and to Foxglove and Lichtblick",
    after_help = "Prints the page's local address on standard error, and serves it until it is ended (Ctrl-C)."
)]
pub(crate) struct Args {
    /// The recording.
    #[arg(value_name = "FILE.mcap")]
    file: PathBuf,

    /// Port of the page; a free one if 0.
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    port: u16,
}

impl Heeds for Args {
    const UNHEEDED: &'static [Unheeded] = &[];
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Printed, Failure> {
    let name = args.file.display();
    let bytes = recording_bytes(&args.file)
        .map_err(|error| Failure::input(format!("{name}: {error}; expected a recording")))?;
    let log = Log::read(bytes).map_err(|error| Failure::input(format!("{name}: {error}")))?;
    let header = log.header();
    let words = [vec![header.program.replace('_', "-")], header.options.clone()].concat();
    let opening = Opening { port: args.port, command: words.join(" ") };
    let player = Player::open(&log, &opening).map_err(|error| port_failure("--port", args.port, &error))?;
    drop(log);
    announce(player.address());
    loop {
        thread::park();
    }
}
