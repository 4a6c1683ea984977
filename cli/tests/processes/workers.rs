//! Evolution by workers that a command starts.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::{roverlab, said};

/// An evolution in two processes.
fn evolution(more: &[&str]) -> Command {
    let words = "starman --json --population 12 --generations 3 --seconds 3 --seed 5 --processes 2";
    roverlab(&[&words.split(' ').collect::<Vec<_>>(), more].concat())
}

/// A script that starts a worker: it notes the words that it is given, and may end before.
fn script(name: &str, before: &str) -> (PathBuf, PathBuf) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("workers {name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let (file, starts) = (folder.join("worker.sh"), folder.join("starts"));
    let (note, program) = (starts.display(), env!("CARGO_BIN_EXE_roverlab"));
    let text = format!("echo \"$@\" >> '{note}'\n{before}\nexec '{program}' \"$@\"\n");
    fs::write(&file, text).unwrap();
    (file, starts)
}

/// What the evolution prints with workers of a script, and how often these were started.
fn by(script: &Path, starts: &Path, piece: &str) -> ((i32, String), usize) {
    let command = format!("sh \"{}\"", script.display());
    let own = ["--worker-command", &command, "--worker-piece", piece];
    let printed = said(&mut evolution(&own));
    let starts = fs::read_to_string(starts).unwrap();
    assert!(starts.lines().all(|words| words.split(' ').count() == 5), "{starts}");
    (printed, starts.lines().count())
}

/// Who starts the workers, and how many individuals these are sent at once, is no part of the result.
#[test]
fn a_command_starts_workers() {
    let whole = said(&mut evolution(&[]));
    assert!(whole.0 == 0 && whole.1.contains("best_last"), "{whole:?}");
    let (file, starts) = script("all", "");
    for (piece, started) in [("1", 2), ("5", 4)] {
        assert_eq!(by(&file, &starts, piece), (whole.clone(), started));
    }
}

/// A worker that is lost is started again.
#[test]
fn a_lost_worker_is_started_again() {
    let (file, starts) = script("one lost", "mkdir \"$(dirname \"$0\")/lost\" 2>/dev/null && exit 1");
    assert_eq!(by(&file, &starts, "3"), (said(&mut evolution(&[])), 3));
}

/// A command that starts no worker is named.
#[test]
fn a_command_without_workers_fails() {
    let (status, text) = said(&mut evolution(&["--worker-command", "no-such-program"]));
    assert!(status != 0 && text.contains("no-such-program"), "{text}");
}
