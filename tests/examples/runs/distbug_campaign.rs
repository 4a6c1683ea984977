//! DistBug on generated courses, in small: the example `distbug_campaign` as a whole.

use std::ffi::OsString;
use std::fs;
use std::path::Path;

use crate::distbug::CampaignArgs;
use crate::{common, distbug};
use clap::Parser;
use serde_json::Value;

fn args(options: &[&str]) -> CampaignArgs {
    CampaignArgs::try_parse_from(std::iter::once(&"distbug_campaign").chain(options)).unwrap()
}

fn run(options: &[&str]) -> (u8, String, String) {
    let words = ["distbug_campaign"].iter().chain(options).map(OsString::from);
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = common::run_printing(words, &mut out, &mut err, distbug::campaign);
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status, text(out), text(err))
}

/// Changes whenever the courses, the simulator or DistBug do: read the difference before accepting it.
#[test]
fn twelve_courses() {
    let args = args(&["--worlds", "12", "--noise", "0,1"]);
    let trials = distbug::trials(&args).unwrap();
    insta::assert_snapshot!(distbug::text(&args.noise, &trials));
}

#[test]
fn the_number_of_threads_makes_no_difference() {
    let table = |threads: &str| {
        let args = args(&["--worlds", "5", "--noise", "0,2", "--threads", threads]);
        distbug::text(&args.noise, &distbug::trials(&args).unwrap())
    };
    assert_eq!(table("1"), table("3"));
}

#[test]
fn a_saved_course_gives_the_same_run() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("distbug_campaign");
    fs::create_dir_all(&folder).unwrap();
    let trial = distbug::trial(5, &[1.0]).unwrap();
    distbug::save(&trial, &folder).unwrap();
    let script = folder.join("course-5.sim");
    let words = ["distbug", "--json", "--seed", "5", "--world", script.to_str().unwrap()];
    let (mut out, mut err) = (Vec::new(), Vec::new());
    common::run("distbug", words.map(OsString::from), &mut out, &mut err, distbug::work);
    let report: Value = serde_json::from_slice(&out).unwrap();
    let (run, number) = (&trial.runs[0], |name: &str| report[name].as_f64().unwrap());
    assert!((number("goal_distance_mm") - 1000.0 * run.goal_distance).abs() < 1e-3, "{report}");
    assert!((number("sim_time_s") - run.sim_time).abs() < 1e-6, "{report}");
}

#[test]
fn the_report_for_programs_is_one_object() {
    let (status, out, err) = run(&["--worlds", "1", "--noise", "0", "--json"]);
    assert!(status <= 1 && err.is_empty() && out.lines().count() == 1, "{out}{err}");
    let report: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(status == 0, report["outcome"] == "passed", "{report}");
    assert_eq!(report["levels"][0]["runs"], 1);
    assert!(report["levels"][0]["sim_time_s"].as_f64().unwrap() > 0.0);
}

#[test]
fn wrong_options_are_refused() {
    for (options, part) in [
        (["--worlds", "0"], "--worlds"),
        (["--noise", "0,6"], "0 to 5"),
        (["--threads", "0"], "--threads"),
        (["--save", "Cargo.toml"], "--save Cargo.toml"),
    ] {
        let (status, out, err) = run(&options);
        assert_eq!((status, out.as_str(), err.lines().count()), (2, "", 1), "{options:?}: {err}");
        assert!(err.contains(part), "{err}");
    }
}
