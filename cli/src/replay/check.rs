use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use roverlab::io::log::{Difference, Log};
use serde_json::json;

use super::{Found, read};
use crate::commands::{self, COMMANDS};
use crate::common::Failure;

/// A file that is removed when dropped.
struct Temporary(PathBuf);

impl Temporary {
    fn new() -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        Self(std::env::temp_dir().join(format!("roverlab-check-{}-{number}.mcap", std::process::id())))
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // A missing file needs no removal.
        let _ = fs::remove_file(&self.0);
    }
}

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
    Ok(Found { fields, text, good: difference.is_none() })
}

/// The recording of the program's run on the recorded inputs.
fn replayed(file: &Path, log: &Log) -> Result<Log, Failure> {
    let name = &log.header().program;
    let program = commands::named(name).ok_or_else(|| {
        let known: Vec<&str> =
            COMMANDS.iter().filter(|command| command.drives()).map(|command| command.name).collect();
        let (file, known) = (file.display(), known.join(", "));
        Failure::input(format!("{file}: found a recording of the program `{name}`; expected one of {known}"))
    })?;
    let copy = Temporary::new();
    let option = |name: &str, file: &Path| {
        let mut word = OsString::from(name);
        word.push(file);
        word
    };
    let words = vec![name.into(), "--json".into(), option("--replay=", file), option("--record=", &copy.0)];
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = (program.run)(words, &mut out, &mut err);
    if status == Failure::INPUT {
        return Err(Failure::input(String::from_utf8_lossy(&err).trim_end()));
    }
    read(&copy.0)
}
