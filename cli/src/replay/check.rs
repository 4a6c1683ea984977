use std::ffi::OsString;
use std::path::Path;

use roverlab::files::TemporaryFolder;
use roverlab::io::log::{Difference, Log};
use serde_json::json;

use super::{Found, read};
use crate::commands::{self, COMMANDS};
use crate::common::Failure;

/// Replays a recording strictly while recording it anew.
pub(super) fn check(file: &Path) -> Result<Found, Failure> {
    let log = read(file)?;
    let again = replayed(file, &log)?;
    let program = &log.header().program;
    let difference = Difference::between(&log, &again);
    let fields = json!({
        "example": "replay", "command": "check",
        "outcome": if difference.is_none() { "same" } else { "different" },
        "program": program,
        "difference": difference.as_ref().map(|difference| json!({
            "robot": difference.robot.map(|robot| robot + 1),
            "time_s": difference.time,
            "found": difference.found,
            "expected": difference.expected,
        })),
    });
    let text = match &difference {
        None => format!("same: the replay of `{program}` gives the same {} bytes", log.bytes().len()),
        Some(difference) => format!("different: the replay of `{program}`, {difference}"),
    };
    Ok(Found { fields, text, good: difference.is_none(), warning: None })
}

/// The recording of the program's run on the recorded inputs.
fn replayed(file: &Path, log: &Log) -> Result<Log, Failure> {
    let name = &log.header().program;
    let program = commands::named(name).ok_or_else(|| {
        let known: Vec<&str> =
            COMMANDS.iter().filter(|command| command.drives()).map(|command| command.name).collect();
        let (file, name, known) =
            (file.display(), name.replace('_', "-"), known.join(", ").replace('_', "-"));
        Failure::input(format!("{file}: found a recording of the program `{name}`; expected one of {known}"))
    })?;
    let folder = TemporaryFolder::new("roverlab-check-").map_err(Failure::run)?;
    let copy = folder.path().join("again.mcap");
    let option = |name: &str, file: &Path| {
        let mut word = OsString::from(name);
        word.push(file);
        word
    };
    let words = vec![name.into(), "--json".into(), option("--replay=", file), option("--record=", &copy)];
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = (program.run)(words, &mut out, &mut err);
    if status == Failure::INPUT {
        return Err(Failure::input(String::from_utf8_lossy(&err).trim_end()));
    }
    read(&copy)
}
