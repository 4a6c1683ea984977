//! The command `replay`.

mod args;
mod check;
mod export;
mod info;
#[cfg(feature = "ros2")]
mod ros2;

use std::fmt::Display;
use std::io::Write;
use std::path::Path;

use roverlab::files::write_whole;
use roverlab::io::log::{Log, LogFile, recover};
use serde_json::{Value, json};

use crate::common::{Failure, Printed, recording_bytes, unrecordable};
pub(crate) use args::{Args, Command};
#[cfg(feature = "native")]
pub(crate) use export::true_path;

/// Result of a command: its report, and whether it succeeded.
struct Found {
    fields: Value,
    text: String,
    good: bool,
    /// Sentences on what the result does not have.
    warning: Option<String>,
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Printed, Failure> {
    let found = match &args.command {
        Command::Check { file } => check::check(file),
        Command::Recover { file, out, force } => recovered(file, (out, *force)),
        Command::Info { file } => info::info(&read(file)?),
        #[cfg(feature = "ros2")]
        Command::Export { file, ros2: Some(bag), force, .. } => ros2::export(&read(file)?, (bag, *force)),
        #[cfg(feature = "ros2")]
        Command::Import { ros2, out, force, scan, odometry, camera, commands } => {
            let wanted = ros2::Wanted {
                scan: scan.as_deref(),
                odometry: odometry.as_deref(),
                camera: camera.as_deref(),
                commands: commands.as_deref(),
            };
            ros2::import((ros2, &bytes(ros2)?), (out, *force), &wanted)
        }
        Command::Export { file, csv, picture, .. } => {
            export::export(&read(file)?, csv.as_deref(), picture.as_deref())
        }
    }?;
    let text = if args.json { found.fields.to_string() } else { found.text };
    Ok(Printed { text, message: found.warning, status: u8::from(!found.good) })
}

fn bytes(file: &Path) -> Result<Vec<u8>, Failure> {
    recording_bytes(file)
        .map_err(|error| Failure::input(format!("{}: {error}; expected a recording", file.display())))
}

fn read(file: &Path) -> Result<Log, Failure> {
    Log::read(bytes(file)?).map_err(|error| Failure::input(format!("{}: {error}", file.display())))
}

fn write(file: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_whole(file, bytes).map_err(|error| unwritable(file.display(), &error))
}

fn unwritable(name: impl Display, error: &dyn Display) -> Failure {
    Failure::run(format!("{name}: {error}; expected a file that can be written"))
}

/// A recording to write whole or not at all, which takes the place of other files only by `force`.
fn created(name: impl Display, (file, force): (&Path, bool)) -> Result<LogFile, Failure> {
    let created = if force { LogFile::replace(file) } else { LogFile::create(file) };
    created.map(LogFile::whole).map_err(|error| unrecordable(name, &error))
}

fn recovered(file: &Path, out: (&Path, bool)) -> Result<Found, Failure> {
    let saved =
        recover(&bytes(file)?).map_err(|error| Failure::input(format!("{}: {error}", file.display())))?;
    if saved.messages == 0 {
        return Err(Failure::input(format!(
            "{}: found no message that is whole; expected a recording with at least one",
            file.display()
        )));
    }
    let name = out.0.display();
    let mut sink = created(&name, out)?;
    sink.write_all(&saved.bytes).and_then(|()| sink.complete()).map_err(|error| unwritable(&name, &error))?;
    let (chunks, messages, header, lost) = (saved.chunks, saved.messages, saved.header, saved.lost);
    let without = if header { "" } else { "; the header is lost, so they cannot be replayed" };
    Ok(Found {
        fields: json!({
            "example": "replay", "command": "recover", "outcome": "recovered",
            "chunks": chunks, "messages": messages, "header": header, "lost_bytes": lost,
        }),
        text: format!("recovered {chunks} chunks with {messages} messages; {lost} bytes are lost{without}"),
        good: true,
        warning: None,
    })
}
