//! The commands in water as a whole.

use std::fs;

use super::support::{assert_outcome, number, run, temporary};

#[test]
fn mako_dives_and_holds_its_depth() {
    let ended = run("dive", &["--depth", "800", "--seed", "2"]);
    assert_outcome(&ended, "held");
    assert!(number(&ended.1, "settle_s") < 20.0 && number(&ended.1, "overshoot_mm") < 50.0, "{}", ended.1);
    let pose = &ended.1["pose"];
    // The sensor is 260 mm above the origin, in 1900 mm of water.
    assert!((number(pose, "z_mm") - 840.0).abs() < 15.0 && number(pose, "pitch_deg").abs() < 3.0, "{pose}");
    assert!(number(&ended.1, "path_length_mm") > 0.0 && ended.1["odometry"].is_object(), "{}", ended.1);
}

/// Mako floats so deep that it cannot settle at 150 mm; that it was there last says nothing.
#[test]
fn a_depth_that_is_never_held_has_no_time_and_a_film() {
    let film = temporary("shallow.svg");
    let (_, report, err) = run("dive", &["--depth", "150", "--animation", film.to_str().unwrap()]);
    assert!(report["outcome"] == "not_held" && report["settle_s"].is_null(), "{report} {err}");
    assert!(fs::read_to_string(film).unwrap().contains("<animateTransform"));
}

/// In a current, a craft that holds its depth is carried along.
#[test]
fn water_is_an_option() {
    let ended = run("dive", &["--water", "current 100 0, turbidity 0.3"]);
    assert_outcome(&ended, "held");
    // It begins 12.5 m from the pool's side, and drifts for 80 s.
    assert!((number(&ended.1["pose"], "x_mm") - 20_000.0).abs() < 700.0, "{}", ended.1);
    let (status, _, err) = run("dive", &["--water", "current 100 0, curent 1"]);
    assert!(status == 2 && err.contains("found `curent`; expected one of water_density, current"), "{err}");
}

/// A fault stops its motors, and it comes up by itself.
#[test]
fn mako_comes_up_after_a_fault() {
    let (_, report, err) = run("dive", &["--supervised", "--fault", "hang@20"]);
    assert_eq!(
        (&report["safety"][0]["state"], &report["collisions"]),
        (&"SafeStop".into(), &0.into()),
        "{report} {err}"
    );
    // Never at its depth after that, and never below it.
    let (within, below) = (number(&report, "within_10mm_percent"), number(&report, "overshoot_mm"));
    assert!(number(&report, "settle_s") < 20.0 && within == 0.0 && below < 10.0, "{report}");
}

#[test]
fn threads_do_not_change_a_campaign() {
    let of = |threads| run("dive", &["--campaign", "--runs", "2", "--threads", threads]);
    let (one, two) = (of("1"), of("2"));
    assert_outcome(&one, "passed");
    assert_eq!(one.1, two.1);
}

#[test]
fn mako_goes_round_a_pool_without_touching_it() {
    let ended = run("pool_wall", &["--seed", "3"]);
    assert_outcome(&ended, "round");
    assert!(ended.1["collisions"] == 0 && number(&ended.1, "rms_error_mm") < 50.0, "{}", ended.1);
}

#[test]
fn mako_comes_to_a_side_at_a_small_angle_without_touching_it() {
    let ended = run("pool_wall", &["--seed", "96"]);
    assert_outcome(&ended, "round");
    assert_eq!(ended.1["collisions"], 0, "{}", ended.1);
}

#[test]
fn mako_goes_round_in_a_current() {
    for (seed, current) in [("1", "100 0"), ("2", "0 -50")] {
        let world =
            small_pool(&format!("current{seed}"), &format!("water_level 1900\ncurrent {current}\n"), 2000);
        let ended = run("pool_wall", &["--world", &world, "--seed", seed]);
        assert_outcome(&ended, "round");
        assert!(ended.1["collisions"] == 0 && number(&ended.1, "rms_error_mm") < 60.0, "{}", ended.1);
    }
}

/// A current carries it to the side at which a lane ends, while it turns there.
#[test]
fn a_survey_turns_clear_of_the_sides_in_a_current() {
    let ended = run("survey", &["--seed", "2", "--water", "current 0 -100"]);
    assert_outcome(&ended, "covered");
    assert!(ended.1["collisions"] == 0 && ended.1["coverage_percent"] == 100.0, "{}", ended.1);
}

/// Lanes along the sides are nearer to them than a craft may turn; cells are never narrower than such a lane
/// needs.
#[test]
fn narrow_lanes_cover_the_floor_up_to_the_sides() {
    let ended = run("survey", &["--spacing", "400"]);
    assert_outcome(&ended, "covered");
    assert!(number(&ended.1, "coverage_percent") >= 99.0 && ended.1["collisions"] == 0, "{}", ended.1);
    let inside = number(&ended.1, "inside_2_sigma_percent");
    assert!(
        (92.0..98.0).contains(&inside) && number(&ended.1, "position_error_p95_mm") < 200.0,
        "{}",
        ended.1
    );
}

#[test]
fn a_survey_holds_its_altitude_up_and_down_a_ridge() {
    let ended = run("survey", &["--altitude", "1000", "--spacing", "5000"]);
    assert_outcome(&ended, "covered");
    let error = number(&ended.1, "altitude_rms_error_mm");
    assert!(error > 0.0 && error < 30.0 && ended.1["collisions"] == 0, "{}", ended.1);
}

/// All cells that are mapped are judged: whole ones, which fill the narrower side.
#[test]
fn a_survey_maps_whole_cells_however_wide() {
    let map = temporary("wide.png");
    for (spacing, shape) in [("8000", ["ncols 3", "nrows 6"]), ("100000", ["ncols 1", "nrows 2"])] {
        let ended = run("survey", &["--spacing", spacing, "--map", map.to_str().unwrap()]);
        assert_outcome(&ended, "covered");
        let grid = fs::read_to_string(map.with_extension("asc")).unwrap();
        let lines: Vec<&str> = grid.lines().collect();
        assert_eq!(lines[..2], shape, "{grid}");
        // The middle of the book's pool, which is 25 m wide.
        let [left, cell] = [lines[2], lines[4]].map(|line| line.split(' ').next_back().unwrap());
        let (left, cell): (f64, f64) = (left.parse().unwrap(), cell.parse().unwrap());
        let columns: f64 = shape[0][6..].parse().unwrap();
        assert!((left + 0.5 * (columns - 1.0) * cell - 12_500.0).abs() < 1.0, "{grid}");
        assert!((22_000.0..24_000.0).contains(&(columns * cell)), "{grid}");
    }
}

/// A pool of a world's file, with walls of so many mm, in the middle of which a craft starts.
fn small_pool(name: &str, lines: &str, height: u32) -> String {
    let world = temporary(&format!("{name}.wld"));
    let walls = ["0 0 6000 0", "6000 0 6000 5000", "6000 5000 0 5000", "0 5000 0 0"];
    let walls = walls.map(|line| format!("{line} 10 {height}\n")).concat();
    fs::write(&world, format!("floor 6000 5000\n{walls}{lines}")).unwrap();
    world.to_str().unwrap().to_owned()
}

#[test]
fn a_survey_maps_a_pool_with_honest_uncertainty() {
    let world = small_pool("surveyed", "water_level 1900\n", 200);
    let map = temporary("surveyed.png");
    let ended = run("survey", &["--world", &world, "--map", map.to_str().unwrap()]);
    assert_outcome(&ended, "covered");
    let report = &ended.1;
    assert!(
        number(report, "coverage_percent") > 99.0 && number(report, "depth_error_p95_mm") < 30.0,
        "{report}"
    );
    assert!(number(report, "position_error_p95_mm") < 100.0 && number(report, "way_ratio") < 1.3, "{report}");
    // Only the sides of a terrain tell the position.
    assert!(number(report, "inside_2_sigma_percent") > 80.0 && report["by_walls"] == false, "{report}");
    let table = fs::read_to_string(map.with_extension("csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 5 * 4, "{table}");
}

#[test]
fn something_red_is_found_in_turbid_water_and_only_there() {
    let ended = run("pool_search", &["--seed", "5", "--light", "0.5"]);
    assert_outcome(&ended, "found");
    assert!(number(&ended.1, "position_error_mm") < 150.0, "{}", ended.1);
    // A pool whose width is no multiple of its ground's samples.
    let ended = run("pool_search", &["--seed", "12"]);
    assert_outcome(&ended, "found");
    assert_eq!(ended.1["collisions"], 0, "{}", ended.1);
    let world = small_pool("searched", "water_level 1900\nturbidity 0.3\n", 200);
    let ended = run("pool_search", &["--world", &world]);
    assert_outcome(&ended, "not_found");
    assert!(ended.1["found"] == false && ended.1["position_error_mm"].is_null(), "{}", ended.1);
    // Beside upright walls, where lanes end, it turns on the spot.
    let walled = small_pool("walled", "water_level 1900\n", 2000);
    for seed in ["1", "2", "3"] {
        let ended = run("pool_search", &["--world", &walled, "--seed", seed]);
        assert_outcome(&ended, "not_found");
        assert_eq!(ended.1["collisions"], 0, "{}", ended.1);
    }
    // In the dark nobody knows what is there.
    for options in [["--seed", "5"], ["--world", &world]] {
        let (status, report, err) = run("pool_search", &[&options[..], &["--light", "0"]].concat());
        assert_eq!((status, &report["outcome"]), (1, &"blind".into()), "{report} {err}");
    }
}

#[test]
fn a_boat_keeps_its_course_in_waves() {
    for seed in ["1", "2"] {
        let ended = run("boat", &["--seed", seed]);
        assert_outcome(&ended, "arrived");
        assert!(number(&ended.1, "cross_track_rms_mm") < 250.0 && ended.1["collisions"] == 0, "{}", ended.1);
    }
}

#[test]
fn what_is_no_water_is_refused() {
    let dry = small_pool("dry", "", 200);
    for command in ["pool_wall", "survey", "boat", "pool_search"] {
        let course = if command == "boat" { &["--course", "1000,1000"][..] } else { &[] };
        let (status, _, err) = run(command, &[&["--world", &dry], course].concat());
        assert!(status == 2 && err.contains("without water"), "{command}: {err}");
    }
    let wet = small_pool("wet", "water_level 1900\n", 200);
    for (command, options, expected) in [
        ("boat", vec!["--world", &wet], "course"),
        ("boat", vec!["--world", &wet, "--course", "99000,0"], "outside"),
        ("boat", vec!["--course", "0,5000;5000,5000"], "ashore"),
        ("boat", vec!["--course", "x"], "waypoints in mm"),
        ("survey", vec!["--spacing", "1"], "200 to"),
        ("survey", vec!["--altitude", "1"], "200 to"),
        ("survey", vec!["--depth", "1900"], "less than 1640"),
        ("survey", vec!["--depth", "3000", "--altitude", "3000"], "less than 2740"),
        ("pool_search", vec!["--light", "-1"], "--light"),
        ("pool_search", vec!["--world", &wet, "--robot", "SolarRaft"], "camera"),
        ("dive", vec!["--depth", "9000"], "1.9 m"),
    ] {
        let (status, _, err) = run(command, &options);
        assert!(status == 2 && err.contains(expected), "{command} {options:?}: {err}");
    }
}
