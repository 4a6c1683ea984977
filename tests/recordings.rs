//! Recorded and replayed runs of the examples.

#[path = "../examples/a_to_b/mod.rs"]
mod a_to_b;
#[path = "../examples/ackermann/mod.rs"]
mod ackermann;
#[path = "../examples/common/mod.rs"]
mod common;
#[path = "../examples/distbug/mod.rs"]
mod distbug;
#[path = "../examples/driving/mod.rs"]
mod driving;
#[path = "../examples/omni/mod.rs"]
mod omni;

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use common::{CommonArgs, Failure, Report};
use serde_json::Value;

/// Runs an example with `--json`. Returns its status and its report, and what it said on standard error.
fn run<A: clap::Parser + AsRef<CommonArgs>>(
    name: &'static str,
    work: fn(&A) -> Result<Report, Failure>,
    options: &[&str],
) -> (u8, Value, String) {
    let first = [name, "--json"];
    let words = first.iter().chain(options).map(OsString::from);
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = common::run(name, words, &mut out, &mut err, work);
    let mut report: Value = serde_json::from_slice(&out).unwrap_or(Value::Null);
    if let Some(object) = report.as_object_mut() {
        object.remove("wall_time_s");
    }
    (status, report, String::from_utf8(err).unwrap())
}

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// Records a run twice and replays it: all recordings and all reports are the same. Returns the recording.
fn assert_replays<A: clap::Parser + AsRef<CommonArgs>>(
    name: &'static str,
    work: fn(&A) -> Result<Report, Failure>,
    options: &[&str],
) -> PathBuf {
    let [first, second, third] = [1, 2, 3].map(|n| file(&format!("{name}-{}-{n}.mcap", options.concat())));
    let plain = run(name, work, options);
    for recording in [&first, &second] {
        let options = [options, &["--record", recording.to_str().unwrap()]].concat();
        assert_eq!(run(name, work, &options), plain, "recording changes the run {name} {options:?}");
    }
    assert!(
        fs::read(&first).unwrap() == fs::read(&second).unwrap(),
        "{name} {options:?} is not deterministic"
    );
    let options = ["--replay", first.to_str().unwrap(), "--record", third.to_str().unwrap()];
    assert_eq!(run(name, work, &options), plain, "{name} {options:?}");
    assert!(fs::read(&first).unwrap() == fs::read(&third).unwrap(), "the replay of {name} differs");
    for old in [second, third] {
        fs::remove_file(old).unwrap();
    }
    first
}

#[test]
fn runs_replay_to_the_bit() {
    for noise in ["0", "1", "2"] {
        let options = ["--noise", noise, "--seed", "5"];
        assert_replays("distbug", distbug::work, &options);
        for method in ["turn", "spline"] {
            assert_replays("a_to_b", a_to_b::work, &[&options[..], &["--method", method]].concat());
        }
        assert_replays("a_to_b", a_to_b::work, &[&options[..], &["--landmark"]].concat());
        assert_replays("ackermann", ackermann::work, &options);
        assert_replays("omni", omni::work, &options);
    }
}

#[test]
fn faults_and_failures_replay() {
    for fault in ["link@2", "stuck@1", "nan@1.5", "clock@2"] {
        assert_replays("a_to_b", a_to_b::work, &["--fault", fault, "--fault", "late@0.5"]);
    }
    assert_replays("distbug", distbug::work, &["--time-limit", "3"]);
}

#[test]
fn another_behaviour_is_found_at_the_first_call_that_differs() {
    let recording = assert_replays("a_to_b", a_to_b::work, &["--method", "spline"]);
    let name = recording.to_str().unwrap();
    let (status, report, err) = run("a_to_b", a_to_b::work, &["--replay", name, "--scale", "1.01"]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("failed")), "{report}");
    assert!(err.contains("found the call set_speed(") && err.contains("expected set_speed("), "{err}");
    let (status, _, err) = run("distbug", distbug::work, &["--replay", name]);
    assert!(status == 2 && err.contains("`a_to_b`") && err.contains("expected one of `distbug`"), "{err}");
}
