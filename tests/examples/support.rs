//! What the tests of whole examples share. A test that uses it has the examples' `common` module as well.

#![allow(dead_code, reason = "each test uses its own part of this")]

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::Parser;
use serde_json::Value;

use crate::common::{self, CommonArgs, Failure, Report};

/// An example's exit status, its report, and what it said on standard error.
pub(crate) type Ended = (u8, Value, String);

/// Runs an example with `--json`.
pub(crate) fn run<A: Parser + AsRef<CommonArgs>>(
    name: &'static str,
    work: fn(&A) -> Result<Report, Failure>,
    options: &[&str],
) -> Ended {
    let first = [name, "--json"];
    let words = first.iter().chain(options).map(OsString::from);
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = common::run(name, words, &mut out, &mut err, work);
    let report = serde_json::from_slice(&out).unwrap_or(Value::Null);
    (status, report, String::from_utf8(err).unwrap())
}

/// A number of a report.
pub(crate) fn number(report: &Value, name: &str) -> f64 {
    report[name].as_f64().unwrap_or_else(|| panic!("{name} in {report}"))
}

/// The example ended well, with an outcome.
pub(crate) fn assert_outcome((status, report, err): &Ended, outcome: &str) {
    assert_eq!((*status, report["outcome"].as_str()), (0, Some(outcome)), "{report} {err}");
}

/// A file of a test's own.
pub(crate) fn temporary(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// A path as a word of a command line.
pub(crate) fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}
