//! The commands `cone-race` and `cone-drive` as wholes.

use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;

use super::support::{Ended, run};
use roverlab::geometry::{Point, Pose, direction};
use roverlab::race::{Cone, ConeColour, ConeTrack, write_eufs, write_fssim};
use serde_json::Value;

/// Runs the race. Returns status, report, and standard error.
fn race(options: &[&str]) -> Ended {
    run("cone_race", options)
}

/// Status and standard error of the race.
fn race_told(options: &[&str]) -> (u8, String) {
    let (status, _, err) = race(options);
    (status, err)
}

/// Runs `cone_drive`. Returns status and standard error.
fn drive(options: &[&str]) -> (u8, String) {
    let (status, _, err) = run("cone_drive", options);
    (status, err)
}

#[test]
fn files_of_cones_are_raced_on() {
    for file in ["oval.csv", "oval.yaml"] {
        let track = format!("../tests/data/cones/{file}");
        let options = ["--track", &track, "--laps", "3", "--line", "../tests/data/cones/oval_line.csv"];
        let (status, report, err) = race(&options);
        assert_eq!((status, err.as_str()), (0, ""), "{report}");
        assert!(
            report["mapped"] == true && report["off_course"] == 0 && report["cones_hit"] == 0,
            "{report}"
        );
        let times: Vec<f64> =
            report["lap_times_s"].as_array().unwrap().iter().map(|time| time.as_f64().unwrap()).collect();
        // The last lap is on the racing line, and the first one is timed too.
        assert!(report["laps"] == 3 && times.len() == 3 && times[times.len() - 1] < times[0], "{report}");
        assert!(report["racing_line_rms_m"].as_f64().unwrap() < 2.0, "{report}");
    }
}

#[test]
fn a_circuit_of_tum_is_lined_and_raced_on() {
    let (status, report, err) = race(&["--track", "../tests/data/cones/oval_tum.csv", "--laps", "3"]);
    assert_eq!((status, err.as_str()), (0, ""), "{report}");
    assert!(report["mapped"] == true && report["laps"] == 3 && report["outcome"] == "finished", "{report}");
}

#[test]
fn cameras_see_the_cones_of_laps() {
    for (sensors, laps) in [("camera", 2), ("both", 1)] {
        let count = laps.to_string();
        let options = ["--track", "../tests/data/cones/oval.csv", "--laps", &count, "--sensors", sensors];
        let (status, report, err) = race(&options);
        assert_eq!((status, err.as_str()), (0, ""), "{report}");
        assert!(report["laps"] == laps && report["outcome"] == "finished", "{report}");
        assert!(report["mapped"] == true || laps < 2, "{report}");
    }
}

#[test]
fn campaigns_without_flying_laps_have_no_figures_of_them() {
    let (status, report, err) = race(&["--campaign", "2", "--laps", "1", "--seed", "3"]);
    assert_eq!((status, err.as_str()), (0, ""), "{report}");
    assert!(report["finished"] == 2 && report["laps"] == 2, "{report}");
    for field in ["mean_racing_speed_m_s", "mean_lap_over_optimum", "worst_lap_over_optimum"] {
        assert_eq!(report[field], Value::Null, "{report}");
    }
}

#[test]
fn a_car_that_has_lost_its_lane_stops() {
    let (status, report, err) = race(&["--seed", "3", "--missing", "0.9"]);
    assert_eq!(status, 1, "{report} {err}");
    assert!(report["outcome"] == "lost" || report["outcome"] == "collided", "{report}");
    assert!(err.contains("found no lane, and stopped"), "{err}");
    assert!(report["sim_time_s"].as_f64().unwrap() < 120.0, "{report}");
}

#[test]
fn options_without_effect_are_refused() {
    let log = "../tests/data/cones/log.json";
    let line = "../tests/data/cones/oval_line.csv";
    for (options, option) in [
        (vec!["--quantised"], "--quantised: "),
        (vec!["--realtime"], "--realtime: "),
        (vec!["--start", "1,2,3"], "--start: "),
        (vec!["--campaign", "1", "--line", line], "--line: "),
        (vec!["--campaign", "1", "--animation", "x.svg"], "--animation: "),
        (vec!["--campaign", "1", "--supervised"], "--supervised: "),
        (vec!["--track", log, "--laps", "3"], "--laps: "),
        (vec!["--track", log, "--noise", "1"], "--noise: "),
        (vec!["--track", log, "--time-limit", "10"], "--time-limit: "),
        (vec!["--track", log, "--seed", "1"], "--seed: "),
        (vec!["--animation", "/nonexistent/x.svg"], "--animation /nonexistent/x.svg: "),
        (vec!["--picture", "x.svg", "--animation", "./x.svg"], "--picture x.svg: "),
        (vec!["--animation", "x.png"], "invalid value 'x.png'"),
    ] {
        let (status, _, err) = race(&options);
        assert!(status == 2 && err.starts_with(option) && err.contains("expected"), "{options:?}: {err}");
    }
    for (option, value) in [("--goal", "1,2"), ("--robot", "y"), ("--world", "x")] {
        let (status, err) = drive(&[option, value]);
        assert!(status == 2 && err.contains("has no meaning for a race"), "{err}");
    }
}

#[test]
fn tracks_that_are_none_are_refused() {
    let folder = std::env::temp_dir().join(format!("roverlab-no-tracks-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let ring = |name: &str, count: u32, radius: f64, row: &dyn Fn(f64, f64) -> String, header: &str| {
        let arm = |k| direction(TAU * f64::from(k) / f64::from(count)) * radius;
        let rows: String = (0..count).map(arm).map(|arm| row(arm.x, arm.y)).collect();
        let file = folder.join(name);
        fs::write(&file, format!("{header}\n{rows}")).unwrap();
        file.display().to_string()
    };
    let tum = |x: f64, y: f64| format!("{x},{y},0.5,0.5\n");
    let pair = |x: f64, y: f64| {
        let out = Point::new(x, y).coords.normalize() * 1.6;
        let (a, b) = (Point::new(x, y) - out, Point::new(x, y) + out);
        format!("blue,{},{},0,0,0,0\nyellow,{},{},0,0,0,0\n", a.x, a.y, b.x, b.y)
    };
    let blue = |x: f64, y: f64| format!("- [{x}, {y}]\n");
    let header = "# x_m,y_m,w_tr_right_m,w_tr_left_m";
    for (file, expected) in [
        (ring("short.csv", 8, 0.75, &tum, header), "expected a closed corridor of 30 to 50000 m"),
        (ring("tiny.csv", 4, 0.5, &tum, header), "expected at least 5"),
        (ring("long.csv", 500, 9e4, &tum, header), "expected a closed corridor of 30 to 50000 m"),
        (ring("far.csv", 20, 8e4, &pair, "tag,x,y"), "expected at most 50 m"),
        (ring("cut.yaml", 20, 30.0, &blue, "cones_left:"), "found no start, 20 blue and 0 yellow cones"),
    ] {
        for (status, err) in [drive(&["--track", &file]), race_told(&["--track", &file])] {
            assert!(status == 2 && err.contains(&file) && err.contains(expected), "{err}");
        }
    }
    let skidpad = folder.join("skidpad.csv").display().to_string();
    fs::write(&skidpad, write_eufs(&self::skidpad())).unwrap();
    let (status, err) = drive(&["--track", &skidpad]);
    assert!(status == 2 && err.contains("which `cone_race` drives"), "{err}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn flying_laps_are_near_the_optimum() {
    let (_, report, err) = race(&["--seed", "3", "--laps", "4"]);
    assert_eq!(err, "", "{report}");
    let ratios = report["lap_over_optimum"].as_array().unwrap();
    // All laps but the mapping lap and the one with a slow start.
    assert!(ratios.len() == 2 && report["cones_hit"] == 0 && report["laps"] == 4, "{report}");
    // No lap is faster than possible for a car without yaw inertia and lags.
    assert!(ratios.iter().all(|ratio| (1.0..1.08).contains(&ratio.as_f64().unwrap())), "{report}");
}

#[test]
fn the_printed_driver_drives_some_way() {
    let options = ["--track", "../tests/data/cones/oval.csv", "--time-limit", "60"];
    let (status, report, err) = run("cone_drive", &options);
    assert_eq!((status, err.len()), (0, 0), "{report}");
    assert!(report["distance_clean_m"].as_f64().unwrap() > 100.0, "{report}");
    let words = ["--track", "../tests/data/cones/oval.csv", "--time-limit", "40"];
    assert_eq!(drive(&words).0, 1, "half a lap is none");
}

#[test]
fn a_line_is_one_of_the_track() {
    let folder = std::env::temp_dir().join(format!("roverlab-line-elsewhere-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let file = folder.join("line.csv");
    fs::write(&file, "# x_m,y_m\n0,500\n10,500\n10,510\n0,510\n").unwrap();
    let (status, _, err) =
        race(&["--track", "../tests/data/cones/oval.csv", "--line", file.to_str().unwrap()]);
    assert_eq!(status, 2, "{err}");
    assert!(err.contains("m from the middle of the track; expected a line on it"), "{err}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn two_cars_do_not_touch() {
    // In the second one, the cars touched when the second car was driven by the book's program; in the
    // others, when its side looked like cones.
    for seed in ["1", "14", "15", "24", "50"] {
        let (_, report, err) = race(&["--seed", seed, "--laps", "2", "--other"]);
        assert_eq!(err, "", "{report}");
        assert!(report["touched"] == false && report["laps"] == 2 && report["cones_hit"] == 0, "{report}");
        assert_eq!(report["other_cones_hit"], 0, "{report}");
    }
    let (status, _, err) = race(&["--other", "--sensors", "camera"]);
    assert!(status == 2 && err.contains("expected lidar or both"), "{err}");
}

#[test]
fn two_racers_of_different_kinds_race_for_places() {
    for (rival, outcome) in [("gap", "won"), ("recorded", "beaten")] {
        let (_, report, err) = race(&["--seed", "1", "--laps", "2", "--rival", rival]);
        assert_eq!(err, "", "{report}");
        assert!(report["outcome"] == outcome && report["touched"] == false, "{report}");
        let passed = [&report["passed"], &report["overtaken"]].map(|passed| passed == true);
        assert_eq!(passed, [rival == "gap", rival == "recorded"], "{report}");
        assert_eq!(report["rival_off_course"], 0, "{report}");
    }
    for option in [&["--sensors", "camera"][..], &["--supervised"], &["--fault", "stuck@3"]] {
        let (status, _, err) = race(&[&["--rival", "gap"], option].concat());
        assert!(status == 2 && err.contains("a race for places, by lidar alone"), "{option:?}: {err}");
    }
}

/// The racer starts ahead of a recorded rival, and is still there after a second.
#[test]
fn a_race_for_places_is_won_at_its_end_alone() {
    let (_, report, err) =
        race(&["--rival", "recorded", "--campaign", "1", "--laps", "1", "--time-limit", "1"]);
    assert!(report["won"] == 0 && report["finished"] == 0 && report["races"] == 1, "{report} {err}");
}

#[test]
fn the_same_seed_gives_the_same_race() {
    let options = ["--track", "../tests/data/cones/oval.csv", "--laps", "2", "--seed", "4"];
    let [a, b] = [0, 1].map(|_| race(&options).1["lap_times_s"].clone());
    assert_eq!(a, b);
}

#[test]
fn pictures_are_drawn() {
    let folder = std::env::temp_dir().join(format!("roverlab-cones-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let [still, moving] = ["race.svg", "moving.svg"].map(|name| folder.join(name).display().to_string());
    let options = [
        "--track",
        "../tests/data/cones/oval.csv",
        "--laps",
        "2",
        "--picture",
        &still,
        "--animation",
        &moving,
    ];
    let (_, report, err) = race(&options);
    assert_eq!(err, "", "{report}");
    assert!(fs::read_to_string(&still).unwrap().contains("racing line"));
    assert!(fs::read_to_string(&moving).unwrap().contains("animateTransform"));
    fs::remove_dir_all(folder).unwrap();
}

/// A strip of 75 m between two lines of large cones, and a lane of 25 m behind it.
fn strip() -> ConeTrack {
    let mut cones = Vec::new();
    for x in 0..=20_u8 {
        let colours = match x {
            0 | 15 => [ConeColour::BigOrange; 2],
            1..15 => [ConeColour::Blue, ConeColour::Yellow],
            _ => [ConeColour::Orange; 2],
        };
        for (y, colour) in [1.6, -1.6].into_iter().zip(colours) {
            cones.push(Cone::new(Point::new(5.0 * f64::from(x), y), colour));
        }
    }
    cones.push(Cone::new(Point::new(100.0, 0.0), ConeColour::Orange));
    ConeTrack { cones, start: Some(Pose::new(-2.45, 0.0, 0.0)), ..ConeTrack::default() }
}

/// The skidpad by the rules.
fn skidpad() -> ConeTrack {
    let mut cones = Vec::new();
    for (side, inner, outer) in
        [(1.0, ConeColour::Blue, ConeColour::Yellow), (-1.0, ConeColour::Yellow, ConeColour::Blue)]
    {
        let centre = Point::new(0.0, 9.125 * side);
        for k in 0..16_u8 {
            let arm = direction(TAU * f64::from(k) / 16.0);
            cones.push(Cone::new(centre + arm * 7.625, inner));
            let place = centre + arm * 10.625;
            cones.extend((place.y * side > 1.0).then(|| Cone::new(place, outer)));
        }
        let lane = [-15.0, -11.0, 11.0, 16.0, 21.0];
        cones.extend(lane.map(|x| Cone::new(Point::new(x, 1.5 * side), ConeColour::Orange)));
    }
    ConeTrack { cones, start: Some(Pose::new(-17.15, 0.0, 0.0)), ..ConeTrack::default() }
}

/// A temporary folder with the files of both events.
pub(super) fn events(test: &str) -> (PathBuf, [String; 2]) {
    let folder = std::env::temp_dir().join(format!("roverlab-{test}-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let files = ["strip.csv", "skidpad.yaml"].map(|name| folder.join(name).display().to_string());
    fs::write(&files[0], write_eufs(&strip())).unwrap();
    fs::write(&files[1], write_fssim(&skidpad())).unwrap();
    (folder, files)
}

#[test]
fn acceleration_and_skidpad_are_driven_as_what_they_are() {
    let (folder, files) = events("events");
    // A skidpad is one without its small orange cones, too.
    let bare = folder.join("bare.csv").display().to_string();
    let mut track = skidpad();
    track.cones.retain(|cone| cone.colour != ConeColour::Orange);
    fs::write(&bare, write_eufs(&track)).unwrap();
    for (file, event, times, sensors) in [
        (&files[0], "acceleration", 1, &["lidar", "both"][..]),
        (&files[1], "skidpad", 2, &["both"]),
        (&bare, "skidpad", 2, &["lidar"]),
    ] {
        for sensors in sensors {
            let (status, report, err) =
                race(&["--track", file, "--laps", "7", "--sensors", sensors, "--seed", "6"]);
            assert_eq!((status, err.as_str()), (0, ""), "{report}");
            assert_eq!(report["outcome"], "finished", "{report}");
            assert!(report["event"] == event && report["laps"] == 1, "{report}");
            assert!(report["cones_hit"] == 0 && report["off_course"] == 0, "{report}");
            let ratios = report["lap_over_optimum"].as_array().unwrap();
            assert!(report["lap_times_s"].as_array().unwrap().len() == times && ratios.len() == times);
            assert!(ratios.iter().all(|ratio| (1.0..1.08).contains(&ratio.as_f64().unwrap())), "{report}");
        }
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn events_without_cones_or_time_are_not_finished() {
    let (folder, files) = events("unfinished");
    for file in &files {
        let (status, report, err) = race(&["--track", file, "--fault", "lost@3"]);
        assert_eq!(report["laps"], 0, "{report}");
        assert!(status != 0 && report["outcome"] != "finished", "{report} {err}");
        let (status, report, err) = race(&["--track", file, "--time-limit", "2"]);
        assert_eq!((status, report["outcome"].as_str()), (1, Some("timed_out")), "{report} {err}");
        let (_, report, err) = race(&["--track", file, "--missing", "0.9"]);
        assert!(report["laps"] == 0 && report["outcome"] == "lost", "{report}");
        assert!(err.contains("found no cones that fit its event"), "{err}");
        let (status, _, err) = race(&["--track", file, "--other"]);
        assert!(status == 2 && err.contains("expected one of laps"), "{err}");
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn pictures_of_events_are_named_after_them() {
    let (folder, files) = events("event-pictures");
    for (file, title) in files.iter().zip(["Acceleration", "Skidpad"]) {
        let picture = format!("{file}.svg");
        let (_, report, err) = race(&["--track", file, "--picture", &picture]);
        assert_eq!(err, "", "{report}");
        assert!(fs::read_to_string(&picture).unwrap().contains(title));
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn lanes_of_a_log_are_where_the_car_drove() {
    for sensors in ["lidar", "both"] {
        let (status, report, err) = race(&["--track", "../tests/data/cones/log.json", "--sensors", sensors]);
        assert_eq!((status, err.as_str()), (0, ""), "{report}");
        assert_eq!((&report["outcome"], &report["event"]), (&"planned".into(), &"log".into()));
        assert!(report["frames"] == report["planned"] && report["wrong_side"] == 0, "{report}");
        assert!(report["from_driven_most_m"].as_f64().unwrap() < 1.0, "{report}");
    }
    let (status, _, err) = race(&["--track", "../tests/data/cones/log.json", "--other"]);
    assert!(status == 2 && err.contains("found the log of a drive"), "{err}");
}

#[test]
fn wrong_files_are_told_where() {
    let (status, _, err) = race(&["--track", "../tests/data/cones/broken.csv"]);
    let expected = "../tests/data/cones/broken.csv:3:12: found `oops`; expected a number of metres\n";
    assert_eq!((status, err.as_str()), (2, expected));
    let (status, _, err) = race(&["--track", "../tests/data/cones/oval_line.csv"]);
    assert!(status == 2 && err.contains("expected a track"), "{err}");
    let (status, _, err) = race(&["--goal", "1,2"]);
    assert!(status == 2 && err.contains("has no meaning for a race"), "{err}");
}

/// The last wait ends at the limit, not a control period later.
#[test]
fn a_race_ends_at_its_limit() {
    for (command, limit) in [("cone_race", 3.0), ("cone_race", 0.005), ("cone_drive", 3.02)] {
        let given = limit.to_string();
        let options = ["--track", "../tests/data/cones/oval.csv", "--time-limit", &given];
        let (_, report, err) = run(command, &options);
        let time = report["sim_time_s"].as_f64().unwrap_or_else(|| panic!("{err}"));
        assert!((limit - 0.011..=limit + 1e-9).contains(&time), "{command}: {time} s of {limit} s");
    }
}
