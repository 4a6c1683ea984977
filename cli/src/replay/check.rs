use std::ffi::OsString;
use std::fs::{self, DirBuilder};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use roverlab::io::log::{Difference, Log};
use serde_json::json;

use super::{Found, read};
use crate::commands::{self, COMMANDS};
use crate::common::Failure;

/// A new folder that only its user may enter, removed when dropped.
struct Temporary(PathBuf);

impl Temporary {
    fn new() -> Result<Self, Failure> {
        Self::within(&std::env::temp_dir())
    }

    fn within(base: &Path) -> Result<Self, Failure> {
        for attempt in 0..100 {
            let path = base.join(format!("roverlab-check-{}-{attempt}", std::process::id()));
            match private().create(&path) {
                Ok(()) => return Ok(Self(path)),
                // Of another check, or another user's.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => {
                    let path = path.display();
                    return Err(Failure::run(format!("{path}: {error}; expected a folder to write to")));
                }
            }
        }
        Err(Failure::run(format!("{}: no name is free for a folder", base.display())))
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // What cannot be removed stays in the system's folder for such files.
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[cfg(unix)]
fn private() -> DirBuilder {
    use std::os::unix::fs::DirBuilderExt;
    let mut builder = DirBuilder::new();
    builder.mode(0o700);
    builder
}

#[cfg(not(unix))]
fn private() -> DirBuilder {
    DirBuilder::new()
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
    let folder = Temporary::new()?;
    let copy = folder.0.join("again.mcap");
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::support::temporary;

    #[test]
    fn a_check_has_a_folder_of_its_own() {
        let base = temporary("checks");
        let _ = fs::remove_dir_all(&base);
        fs::create_dir(&base).unwrap();
        let first = Temporary::within(&base).unwrap();
        let name = first.0.clone();
        drop(first);
        assert!(!name.exists());
        // Whatever has the name stays as it is.
        fs::write(&name, "of others").unwrap();
        let second = Temporary::within(&base).unwrap();
        assert!(second.0 != name && second.0.is_dir());
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            assert_eq!(fs::metadata(&second.0).unwrap().permissions().mode() & 0o777, 0o700);
        }
        drop(second);
        assert_eq!(fs::read(&name).unwrap(), b"of others");
        assert_eq!(fs::read_dir(&base).unwrap().count(), 1);
        fs::remove_dir_all(&base).unwrap();
    }
}
