//! Shared parts of the tests of whole commands.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::commands::dispatch;

/// Small files of the project.
pub(crate) const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data");

/// A folder of the published data, which are not part of the project.
pub(crate) fn published(folder: &str) -> PathBuf {
    let data = std::env::var_os("ROVERLAB_DATA").expect("ROVERLAB_DATA names the folder of published data");
    Path::new(&data).join(folder)
}

/// A command's exit status, report, and standard error.
pub(crate) type Ended = (u8, Value, String);

/// Runs a command. Returns exit status, standard output, and standard error.
pub(crate) fn said(command: &str, options: &[&str]) -> (u8, String, String) {
    let words = ["roverlab", command].iter().chain(options).map(OsString::from).collect();
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = dispatch(words, &mut out, &mut err);
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status, text(out), text(err))
}

/// Runs a command with `--json`.
pub(crate) fn run(command: &str, options: &[&str]) -> Ended {
    let (status, out, err) = said(command, &[&["--json"], options].concat());
    (status, serde_json::from_str(&out).unwrap_or(Value::Null), err)
}

/// A number in a report.
pub(crate) fn number(report: &Value, name: &str) -> f64 {
    report[name].as_f64().unwrap_or_else(|| panic!("{name} in {report}"))
}

/// The command succeeded with an outcome.
pub(crate) fn assert_outcome((status, report, err): &Ended, outcome: &str) {
    assert_eq!((*status, report["outcome"].as_str()), (0, Some(outcome)), "{report} {err}");
}

/// Folder for files of tests, beside that of the test program.
pub(crate) fn folder() -> PathBuf {
    let program = std::env::current_exe().unwrap();
    let folder = program.ancestors().nth(2).unwrap().join("tmp");
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Path of a test's own file.
pub(crate) fn temporary(name: &str) -> PathBuf {
    folder().join(name)
}

/// A path as a command-line argument.
pub(crate) fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}
