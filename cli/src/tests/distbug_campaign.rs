//! DistBug on a few generated courses: `distbug --campaign` as a whole.

use std::fs;

use super::support::{self, number, said, temporary};
use crate::distbug::{self, Args};
use clap::Parser;
use serde_json::Value;

fn args(options: &[&str]) -> Args {
    Args::try_parse_from(["distbug", "--campaign"].iter().chain(options)).unwrap()
}

fn run(options: &[&str]) -> (u8, String, String) {
    said("distbug", &[&["--campaign"], options].concat())
}

/// Changes with the courses, the simulator or DistBug: inspect the difference before accepting it.
#[test]
fn twelve_courses() {
    let args = args(&["--worlds", "12", "--levels", "0,1"]);
    let trials = distbug::trials(&args).unwrap();
    insta::assert_snapshot!(distbug::text(&args.levels, &trials));
}

#[test]
fn the_number_of_threads_makes_no_difference() {
    let table = |threads: &str| {
        let args = args(&["--worlds", "5", "--levels", "0,2", "--threads", threads]);
        distbug::text(&args.levels, &distbug::trials(&args).unwrap())
    };
    assert_eq!(table("1"), table("3"));
}

#[test]
fn a_saved_course_gives_the_same_run() {
    let folder = temporary("distbug_campaign");
    fs::create_dir_all(&folder).unwrap();
    let trial = distbug::trial(5, &[1.0]).unwrap();
    distbug::save(&trial, &folder).unwrap();
    let script = folder.join("course-5.sim");
    let (_, report, _) = support::run("distbug", &["--seed", "5", "--world", script.to_str().unwrap()]);
    let (run, number) = (&trial.runs[0], |name| number(&report, name));
    assert!((number("goal_distance_mm") - 1000.0 * run.goal_distance).abs() < 1e-3, "{report}");
    assert!((number("sim_time_s") - run.sim_time).abs() < 1e-6, "{report}");
}

#[test]
fn the_report_for_programs_is_one_object() {
    let (status, out, err) = run(&["--worlds", "1", "--levels", "0", "--json"]);
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
        (["--levels", "0,6"], "0 to 5"),
        (["--threads", "0"], "--threads"),
        (["--save", "Cargo.toml"], "--save Cargo.toml"),
    ] {
        let (status, out, err) = run(&options);
        assert_eq!((status, out.as_str(), err.lines().count()), (2, "", 1), "{options:?}: {err}");
        assert!(err.contains(part), "{err}");
    }
}

/// Options unsupported by a campaign are rejected, and so are a campaign's options without one.
#[test]
fn options_without_a_meaning_are_refused() {
    for options in [["--campaign", "--noise=0"], ["--campaign", "--time-limit=9"], ["--json", "--levels=0"]] {
        let (status, out, err) = said("distbug", &options);
        assert_eq!((status, out.as_str(), err.lines().count()), (2, "", 1), "{options:?}: {err}");
    }
}
