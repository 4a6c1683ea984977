//! The commands on hills as a whole.

use std::fs;

use super::support::{Ended, number, run, temporary};
use crate::{ramp, summit};
use clap::Parser;
use roverlab::geometry::math;

/// A world whose ground is an ESRI grid: a hill with its top at (1.9, 1.7) m. Returns the name of the world's
/// file.
fn hill(name: &str) -> String {
    let (columns, cell) = (61, 0.05);
    let height = |column: usize, row: usize| {
        let (x, y) = (column as f64 * cell, (columns - 1 - row) as f64 * cell);
        let (ahead, aside) = (x - 1.9, y - 1.7);
        0.25 * math::exp(-1.5 * (ahead * ahead + aside * aside))
    };
    let mut grid = format!("ncols {columns}\nnrows {columns}\nxllcorner 0\nyllcorner 0\ncellsize 50\n");
    for row in 0..columns {
        let line: Vec<String> = (0..columns).map(|column| format!("{:.4}", height(column, row))).collect();
        grid += &(line.join(" ") + "\n");
    }
    let file = temporary(&format!("{name}.asc"));
    fs::write(&file, grid).unwrap();
    let world = temporary(&format!("{name}.wld"));
    let reference = file.file_name().unwrap().to_str().unwrap();
    fs::write(&world, format!("terrain 3000 3000 250 {reference}\n")).unwrap();
    world.to_str().unwrap().to_owned()
}

#[test]
fn a_robot_finds_the_summit_of_a_world() {
    let world = hill("summit");
    for method in ["search", "psd", "ascent"] {
        let options =
            ["--world", &world, "--start", "700,700,0", "--noise", "1", "--seed", "3", "--method", method];
        let (status, report, err): Ended = run("summit", &options);
        assert_eq!((status, err.as_str()), (0, ""), "{report}");
        // Steepest ascent has no map: on so smooth a top, its sensors show a few millimetres in height no
        // more, which are more than 100 mm aside.
        let outcome = report["outcome"].as_str().unwrap();
        assert!(outcome == "reached" || (method != "search" && outcome == "local_maximum"), "{report}");
        let (top, height) = (number(&report, "highest_reachable_mm"), number(&report, "height_mm"));
        assert!(top > 240.0 && (top - height).abs() < 15.0, "{report}");
        assert!(number(&report, "max_tilt_deg") < 30.0 && number(&report, "distance_mm") < 200.0, "{report}");
        assert!(number(&report, "slip_percent") < 60.0, "{report}");
    }
}

/// Errors of a start have its place, and those of a robot its name.
#[test]
fn starts_and_robots_that_are_unfit_for_hills_are_refused() {
    let world = hill("unfit");
    let wet = temporary("wet.wld");
    fs::write(&wet, fs::read_to_string(&world).unwrap() + "water_level 100\n").unwrap();
    let folder = temporary("folder.png");
    fs::create_dir_all(&folder).unwrap();
    let foldered = temporary("foldered.wld");
    fs::write(&foldered, "terrain 3000 3000 250 folder.png\n").unwrap();
    let [wet, foldered] = [&wet, &foldered].map(|file| file.to_str().unwrap());
    for command in ["summit", "ramp"] {
        for (file, start, robot, expected) in [
            (world.as_str(), "50,1500,0", "Blizzard", "a start at 50, 1500 mm"),
            (wet, "500,500,0", "Blizzard", "a start at 500, 500 mm"),
            (world.as_str(), "1500,1500,0", "Mako", "found `Mako`, a craft"),
            (foldered, "1500,1500,0", "Blizzard", "`folder.png`, which is a folder"),
        ] {
            let (status, report, err) = run(command, &["--world", file, "--start", start, "--robot", robot]);
            assert!(status == 2 && err.contains(expected), "{command} {start}: {report} {err}");
        }
    }
}

#[test]
fn what_is_no_hill_is_refused() {
    let flat = temporary("flat.wld");
    fs::write(&flat, "floor 3000 2000\n").unwrap();
    let flat = flat.to_str().unwrap();
    for (command, options, expected) in [
        ("summit", vec!["--world", flat, "--start", "700,700,0"], "without hills"),
        ("summit", vec!["--slope", "0"], "--slope"),
        ("summit", vec!["--goal", "1,1"], "--goal"),
        ("ramp", vec!["--world", flat, "--start", "700,700,0"], "without hills"),
        ("ramp", vec!["--goal", "1,1"], "--goal"),
        ("terrain_plan", vec!["--world", flat, "--start", "700,700,0"], "without hills"),
        ("terrain_plan", vec!["--robot", "R2D2"], "expected one of"),
        ("terrain_plan", vec!["--goal", "99999,0"], "outside"),
    ] {
        let (status, _, err) = run(command, &options);
        assert!(status == 2 && err.contains(expected), "{command} {options:?}: {err}");
    }
}

#[test]
fn a_robot_crosses_levels() {
    let (status, report, err): Ended = run("ramp", &["--seed", "1", "--noise", "1"]);
    assert_eq!((status, report["outcome"].as_str(), err.as_str()), (0, Some("crossed"), ""), "{report}");
    assert!(report["crossed"] == true && number(&report, "edge_distance_mm") > 0.0, "{report}");
    assert!((number(&report, "level_mm") - 200.0).abs() < 10.0, "{report}");
    assert!(number(&report, "height_mm") < 20.0 && number(&report, "max_tilt_deg") < 25.0, "{report}");
}

#[test]
fn levels_of_a_campaign_are_crossed() {
    let args = ramp::Args::try_parse_from(["ramp", "--campaign", "--runs", "2", "--noise", "1"]).unwrap();
    let trials = ramp::trials(&args).unwrap();
    assert!(trials.iter().all(|(_, trial)| trial.crossed && !trial.is_lost()), "{trials:?}");
}

#[test]
fn a_campaign_tells_all_methods_apart() {
    let args =
        summit::Args::try_parse_from(["summit", "--campaign", "--runs", "1", "--time-limit", "60"]).unwrap();
    let trials = summit::trials(&args).unwrap();
    assert_eq!(trials.len(), 3);
    assert!(trials.iter().all(|(_, trial)| trial.sim_time <= 61.0 && !trial.is_lost()), "{trials:?}");
}

#[test]
fn ways_over_hills_are_planned() {
    let world = hill("plan");
    let options = ["--world", &world, "--start", "500,500,0", "--goal", "2500,1900"];
    let cost = |more: &[&str]| {
        let (status, report, err) = run("terrain_plan", &[&options[..], more].concat());
        assert_eq!((status, report["outcome"].as_str(), err.as_str()), (0, Some("found"), ""), "{report}");
        (number(&report, "cost"), number(&report, "climb_mm"), number(&report, "cost_back"))
    };
    let length = cost(&["--planner", "astar"]);
    assert_eq!(length, cost(&["--planner", "dijkstra"]));
    assert!(cost(&[]).0 < length.0 && length.0 > 2440.0);
    let energy = cost(&["--cost", "energy"]);
    assert!(energy.1 < length.1, "what costs less climbs less: {energy:?} {length:?}");
    assert!(cost(&["--cost", "time"]).0 > 1.0);
    let (status, report, _) =
        run("terrain_plan", &[&options[..], &["--slope", "3", "--goal", "1900,1700"]].concat());
    assert!(status == 2 || report["outcome"] == "unreachable", "{report}");
    let (status, report, _) = run("terrain_plan", &["--campaign", "--runs", "1"]);
    assert_eq!((status, report["outcome"].as_str()), (0, Some("passed")), "{report}");
}
