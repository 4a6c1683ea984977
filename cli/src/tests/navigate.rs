//! The command `navigate` as a whole.

use std::fs;
use std::path::PathBuf;

use super::support::{self, Ended, temporary};
use crate::navigate;
use clap::Parser;
use serde_json::Value;

/// Runs the command. Returns status, report, and standard error.
fn run(options: &[&str]) -> Ended {
    support::run("navigate", options)
}

fn assert_reached((status, report, err): &Ended) {
    assert_eq!((*status, report["outcome"].as_str(), err.as_str()), (0, Some("reached"), ""), "{report}");
    assert!(report["goal_distance_mm"].as_f64().unwrap() < 60.0, "{report}");
    assert!(report["position_error_mm"].as_f64().unwrap() < 40.0, "{report}");
}

fn file(name: &str, text: &str) -> String {
    let path: PathBuf = temporary(name);
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn what_the_robot_was_not_told_of_changes_its_plan() {
    let mut replans = 0;
    for seed in ["1", "2", "3"] {
        let ended = run(&["--seed", seed]);
        assert_reached(&ended);
        assert_eq!(ended.1["unmapped"], 3);
        replans += ended.1["replans"].as_u64().unwrap();
    }
    assert!(replans > 0);
    // With a complete map, it plans once.
    let ended = run(&["--unmapped", "0", "--noise", "0"]);
    assert_reached(&ended);
    assert_eq!((&ended.1["replans"], &ended.1["recoveries"]), (&0.into(), &0.into()), "{}", ended.1);
}

#[test]
fn a_campaign_reaches_its_goals_without_contact() {
    let args = navigate::Args::try_parse_from(["navigate", "--campaign", "--runs", "6"]).unwrap();
    let trials = navigate::trials(&args).unwrap();
    assert!(trials.iter().all(|trial| trial.is_reached() && trial.contacts == 0), "{trials:?}");
    assert!(trials.iter().any(|trial| trial.unmapped > 1 && trial.replans > 0), "{trials:?}");
    let one = navigate::Args::try_parse_from(["navigate", "--campaign", "--runs", "6", "--threads", "1"]);
    assert_eq!(navigate::trials(&one.unwrap()).unwrap(), trials);
}

#[test]
fn closed_worlds_are_told_at_once() {
    let world = file(
        "closed.wld",
        "floor 3000 2000\n0 0 3000 0\n3000 0 3000 2000\n3000 2000 0 2000\n0 2000 0 0\n1500 0 1500 2000\n",
    );
    let (status, report, err) = run(&["--world", &world, "--start", "500,1000,0", "--goal", "2500,1000"]);
    assert_eq!((status, report["outcome"].as_str(), err.as_str()), (0, Some("unreachable"), ""), "{report}");
    assert!(
        report["sim_time_s"].as_f64().unwrap() < 1.0 && report["planned_length_mm"].is_null(),
        "{report}"
    );
    // Outside, and in a wall.
    for goal in ["9000,1000", "1500,1000"] {
        let (status, report, _) = run(&["--world", &world, "--start", "500,1000,0", "--goal", goal]);
        assert_eq!((status, report["outcome"].as_str()), (0, Some("unreachable")), "{goal}: {report}");
    }
}

#[test]
fn a_grid_map_is_a_floor() {
    let map = "type octile\nheight 6\nwidth 9\nmap\n.........\n.@@@@@@..\n.@....@..\n.@.@@.@..\n...@.....\n....@@@@.\n";
    let world = file("floor.map", map);
    // Column 2, row 2 of the map, and its upper right cell.
    let ended = run(&["--world", &world, "--start", "1250,1750,0", "--goal", "4250,2750"]);
    assert_reached(&ended);
    // The inside of a blocked cell is solid, though the world's walls only surround it.
    let (status, _, err) = run(&["--world", &world, "--start", "750,2250,0", "--goal", "4250,2750"]);
    assert!(status == 2 && err.contains("--start: found a start at 750, 2250 mm, in a wall"), "{err}");
    let (status, report, _) = run(&["--world", &world, "--start", "1250,1750,0", "--goal", "750,2250"]);
    assert_eq!((status, report["outcome"].as_str()), (0, Some("unreachable")), "{report}");
}

#[test]
fn what_makes_no_sense_is_refused() {
    for (options, part) in [
        (&["--clearance", "0"][..], "--clearance"),
        (&["--clearance", "nan"], "--clearance"),
        (&["--clearance", "10", "--least-clearance", "20"], "clearance"),
        (&["--unmapped", "1000"], "--unmapped"),
        (&["--goal", "100,100,90"], "--goal: found a heading"),
        (&["--world", "no/such.map", "--start", "1,1,0", "--goal", "2,2"], "no/such.map:1:1"),
        (&["--campaign", "--runs", "0"], "--runs"),
        (&["--start", "9000,400,0"], "--start: found a start at 9000, 400 mm, outside of the world"),
        (&["--start", "1400,300,0"], "--start: found a start at 1400, 300 mm, in a wall"),
        (&["--start", "nan,400,0"], "--start"),
        (&["--goal", "nan,400"], "--goal"),
        (&["--goal", "inf,400"], "--goal"),
    ] {
        let (status, report, err) = run(options);
        assert_eq!((status, report, err.lines().count()), (2, Value::Null, 1), "{options:?}: {err}");
        assert!(err.contains(part), "{options:?}: {err}");
    }
}

/// A wall with a mistyped coordinate is omitted from maps with a warning, and changes nothing else.
#[test]
fn a_stray_wall_changes_nothing() {
    let file = temporary("stray.wld");
    let world = file.to_str().unwrap();
    let room =
        "0 0 3000 0\n3000 0 3000 2000\n3000 2000 0 2000\n0 2000 0 0\n0 900 1500 900\nposition 500 600 20\n";
    let commands: [(&str, &[&str]); 5] = [
        ("navigate", &["--goal", "2500,1500"]),
        ("localise", &["--patience", "8"]),
        ("distbug", &["--goal", "2500,1500"]),
        ("random_drive", &["--time-limit", "5"]),
        ("wall_following", &["--time-limit", "20"]),
    ];
    for (command, options) in commands {
        let options = [options, &["--world", world]].concat();
        fs::write(&file, format!("floor 3000 2000\n{room}")).unwrap();
        let (_, without, _) = support::run(command, &options);
        for far in ["1000000", "1000000000"] {
            fs::write(&file, format!("{far} 0 {far} 1000\n{room}")).unwrap();
            let (_, report, _) = support::run(command, &options);
            assert_eq!(report["outcome"], without["outcome"], "{command}");
            assert_eq!(report["pose"], without["pose"], "{command}");
        }
    }
}

/// In the place with fewer walls of two far from each other, and from one to the other.
#[test]
fn commands_with_maps_work_in_the_place_of_the_start() {
    let file = temporary("places.wld");
    let world = file.to_str().unwrap();
    let room = |x: u32| {
        let far = x + 3000;
        format!("{x} 0 {far} 0\n{far} 0 {far} 2000\n{far} 2000 {x} 2000\n{x} 2000 {x} 900\n")
    };
    let text = format!("floor 3000 2000\n{}position 500 600 20\n", room(0));
    let mut reports = Vec::new();
    for there in [String::new(), room(150_000).repeat(2)] {
        fs::write(&file, text.clone() + &there).unwrap();
        let runs = [
            ("localise", &[][..]),
            ("coverage", &[]),
            ("follow_me", &["--time-limit", "40"]),
            ("navigate", &["--goal", "2500,1500"]),
            ("distbug", &["--goal", "2500,1500"]),
        ];
        reports.push(runs.map(|(command, options)| {
            let (_, mut report, _) = support::run(command, &[options, &["--world", world]].concat());
            report.as_object_mut().unwrap().remove("time_limit_s");
            report
        }));
    }
    assert_eq!(reports[0], reports[1]);
    assert_eq!(reports[0][0]["outcome"], "localised", "{}", reports[0][0]);
    let (_, report, err) = support::run("navigate", &["--world", world, "--goal", "150500,500"]);
    assert!(report["planned_length_mm"].as_f64().is_some_and(|length| length > 150e3), "{report} {err}");
}

/// Where nothing is to be seen, the robot relies on odometry.
#[test]
fn a_goal_that_odometry_misses_is_not_reached() {
    let file = temporary("open.wld");
    fs::write(&file, "floor 40000 5000\n0 0 40000 0\n").unwrap();
    let world = file.to_str().unwrap();
    let trip = ["--world", world, "--start", "1000,2500,0", "--goal", "39000,2500"];
    let (status, report, _) = support::run("distbug", &[&trip[..], &["--noise", "0"]].concat());
    assert_eq!((status, &report["outcome"]), (0, &"reached".into()), "{report}");
    let (status, report, _) = support::run("distbug", &[&trip[..], &["--noise", "3"]].concat());
    assert_eq!((status, &report["outcome"]), (1, &"missed".into()), "{report}");
    assert!(report["goal_distance_mm"].as_f64().unwrap() > 250.0);
}
