//! The examples `cone_race` and `cone_drive` as wholes.

use std::ffi::OsString;
use std::fs;

use crate::{common, cone_drive, cone_race};
use serde_json::Value;

/// Runs the example with `--json`. Returns its status and its report, and what it said on standard error.
fn race(options: &[&str]) -> (u8, Value, String) {
    let words = ["cone_race", "--json"].iter().chain(options).map(OsString::from);
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = common::run("cone_race", words, &mut out, &mut err, cone_race::work);
    (status, serde_json::from_slice(&out).unwrap_or(Value::Null), String::from_utf8(err).unwrap())
}

#[test]
fn files_of_cones_are_raced_on() {
    for file in ["oval.csv", "oval.yaml"] {
        let track = format!("tests/data/cones/{file}");
        let options = ["--track", &track, "--laps", "3", "--line", "tests/data/cones/oval_line.csv"];
        let (_, report, err) = race(&options);
        assert_eq!(err, "", "{report}");
        assert!(report["mapped"] == true && report["off_course"] == 0, "{report}");
        let times: Vec<f64> =
            report["lap_times_s"].as_array().unwrap().iter().map(|time| time.as_f64().unwrap()).collect();
        // The last lap is on the racing line, and the first one counts as well.
        assert!(report["laps"] == 3 && times.len() == 3 && times[times.len() - 1] < times[0], "{report}");
        assert!(report["racing_line_rms_m"].as_f64().unwrap() < 2.0, "{report}");
    }
}

#[test]
fn flying_laps_are_near_the_optimum() {
    let (_, report, err) = race(&["--seed", "3", "--laps", "4"]);
    assert_eq!(err, "", "{report}");
    let ratios = report["lap_over_optimum"].as_array().unwrap();
    // All but the lap of the map and the one that begins slowly.
    assert!(ratios.len() == 2 && report["cones_hit"] == 0 && report["laps"] == 4, "{report}");
    // None is faster than a car without yaw and lags could be.
    assert!(ratios.iter().all(|ratio| (1.0..1.08).contains(&ratio.as_f64().unwrap())), "{report}");
}

#[test]
fn the_printed_driver_drives_some_way() {
    let words = ["cone_drive", "--json", "--track", "tests/data/cones/oval.csv", "--time-limit", "40"];
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status =
        common::run("cone_drive", words.iter().map(OsString::from), &mut out, &mut err, cone_drive::work);
    let report: Value = serde_json::from_slice(&out).unwrap();
    assert_eq!((status, err.len()), (0, 0), "{report}");
    assert!(report["distance_clean_m"].as_f64().unwrap() > 1.0, "{report}");
}

#[test]
fn two_cars_do_not_touch() {
    for seed in ["1", "2"] {
        let (_, report, err) = race(&["--seed", seed, "--laps", "2", "--other"]);
        assert_eq!(err, "", "{report}");
        assert!(report["touched"] == false && report["laps"] == 2 && report["cones_hit"] == 0, "{report}");
    }
}

#[test]
fn the_same_seed_gives_the_same_race() {
    let options = ["--track", "tests/data/cones/oval.csv", "--laps", "2", "--seed", "4"];
    let [a, b] = [0, 1].map(|_| race(&options).1["lap_times_s"].clone());
    assert_eq!(a, b);
}

#[test]
fn pictures_are_drawn() {
    let folder = std::env::temp_dir().join(format!("roverlab-cones-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let [still, moving] = ["race.svg", "moving.svg"].map(|name| folder.join(name).display().to_string());
    let options =
        ["--track", "tests/data/cones/oval.csv", "--laps", "2", "--picture", &still, "--animation", &moving];
    let (_, report, err) = race(&options);
    assert_eq!(err, "", "{report}");
    assert!(fs::read_to_string(&still).unwrap().contains("racing line"));
    assert!(fs::read_to_string(&moving).unwrap().contains("animateTransform"));
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn wrong_files_are_told_where() {
    let (status, _, err) = race(&["--track", "tests/data/cones/broken.csv"]);
    let expected = "tests/data/cones/broken.csv:3:12: found `oops`; expected a number of metres\n";
    assert_eq!((status, err.as_str()), (2, expected));
    let (status, _, err) = race(&["--track", "tests/data/cones/oval_line.csv"]);
    assert!(status == 2 && err.contains("expected a track"), "{err}");
    let (status, _, err) = race(&["--goal", "1,2"]);
    assert!(status == 2 && err.contains("has no meaning for a race"), "{err}");
}
