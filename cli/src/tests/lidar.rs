//! The commands `lidar-scan` and `localise` as wholes.

use std::fs;

use super::support::{Ended, folder, number, run, temporary};
use crate::localise;
use clap::Parser;

fn lidar_scan(options: &[&str]) -> Ended {
    run("lidar_scan", options)
}

fn localise(options: &[&str]) -> Ended {
    run("localise", options)
}

#[test]
fn a_scan_shows_walls_corners_and_cans() {
    let folder = folder();
    let (lcd, svg) = (folder.join("scan_lcd.png"), folder.join("scan.svg"));
    let (lcd, svg) = (lcd.to_str().unwrap(), svg.to_str().unwrap());
    for seed in ["1", "2", "3"] {
        let (status, report, err) = lidar_scan(&["--seed", seed, "--lcd", lcd, "--picture", svg]);
        assert_eq!((status, report["outcome"].as_str(), err.as_str()), (0, Some("scanned"), ""), "{report}");
        assert_eq!(report["objects"].as_array().unwrap().len(), 2, "{report}");
        // Of the six corners, one is hidden, and one shows only one wall.
        assert_eq!(report["corners"].as_array().unwrap().len(), 4, "{report}");
        assert!(
            number(&report, "corner_error_mm") < 25.0 && number(&report, "object_error_mm") < 15.0,
            "{report}"
        );
    }
    let display = image::open(lcd).unwrap().into_rgb8();
    assert_eq!(display.dimensions(), (480, 320));
    assert!(display.pixels().filter(|pixel| pixel.0 == [0, 0, 255]).count() > 5000);
    assert!(fs::read_to_string(svg).unwrap().contains("Walls, corners and objects in a scan"));
    let (status, _, err) = lidar_scan(&["--goal", "1,1"]);
    assert!(status == 2 && err.contains("expected"), "{err}");
}

#[test]
fn the_robot_finds_where_it_is() {
    for seed in ["1", "2", "3"] {
        let (status, report, err) = localise(&["--seed", seed]);
        assert_eq!(
            (status, report["outcome"].as_str(), err.as_str()),
            (0, Some("localised"), ""),
            "{report}"
        );
        assert!(number(&report, "position_error_mm") < 20.0 && number(&report, "heading_error_deg") < 1.0);
        assert_eq!(number(&report, "hypotheses"), 1.0);
    }
}

#[test]
fn what_looks_alike_is_told_as_such() {
    let world = temporary("rectangle.wld");
    fs::write(&world, "0 0 3000 0\n3000 0 3000 2000\n3000 2000 0 2000\n0 2000 0 0\nposition 800 700 30\n")
        .unwrap();
    let (status, report, _) = localise(&["--world", world.to_str().unwrap(), "--patience", "8"]);
    assert_eq!((status, report["outcome"].as_str()), (0, Some("several_hypotheses")), "{report}");
    assert_eq!(number(&report, "hypotheses"), 2.0);
    let places = report["places"].as_array().unwrap();
    // They are point reflections of each other in the middle of the room.
    assert!((number(&places[0], "x_mm") + number(&places[1], "x_mm") - 3000.0).abs() < 20.0, "{report}");
    assert!((number(&places[0], "probability") - 0.5).abs() < 0.2, "{report}");
}

#[test]
fn the_table_of_a_campaign() {
    let args = localise::Args::try_parse_from(["localise", "--campaign", "--starts", "2", "--patience", "6"])
        .unwrap();
    let rows = localise::rows(&args).unwrap();
    let text = localise::text(&rows);
    assert!(text.lines().count() >= rows.len() + 2 && !text.contains("NO"), "{text}");
    assert!(rows.iter().all(localise::Row::is_good));
}

#[test]
fn a_robot_that_fails_ends_the_run() {
    let (status, report, err) = localise(&["--fault", "link@1"]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("failed")), "{report}");
    assert!(err.contains("link"), "{err}");
}

/// A map without heights does not tell what beams see that pass over walls.
#[test]
fn tilted_lidars_are_refused() {
    for command in ["localise", "coverage"] {
        let (status, _, err) = run(command, &["--robot", "LidarBot"]);
        assert!(
            status == 2 && err.contains("tilted by 10.0 degrees; expected a level one"),
            "{command}: {err}"
        );
    }
}

/// Corners and walls of a hall look alike to a lidar that sees a half circle of 1.5 m. What the robot knows
/// by odometry is not given up beside a wall, where noise makes other places along it seem likelier.
#[test]
fn a_half_blind_robot_is_not_sure_of_a_wrong_place() {
    let [world, robot, scene] = ["hall_block.wld", "half_blind.robi", "half_blind.sim"].map(temporary);
    let sides = ["0 0 3501.1 0", "3501.1 0 3501.1 4796.2", "3501.1 4796.2 0 4796.2", "0 4796.2 0 0"];
    let walls = sides.map(|side| format!("{side} 10 300\n")).concat();
    let block = "1747 4144 1807 4144\n1807 4144 1807 4204\n1807 4204 1747 4204\n1747 4204 1747 4144\n";
    fs::write(&world, format!("floor 3501.13 4796.2\n{walls}{block}")).unwrap();
    let body = "drive DIFFERENTIAL_DRIVE\nname Half\ncollider capsule 60 90 0 45 0\nmass 1 0 0 0\n";
    let parts = "wheel 60 1800 540 80\naxis 20 0\nlidar 0 0 40 0 0 0 180 0 90\nlidar_range 1500\n";
    fs::write(&robot, format!("{body}{parts}")).unwrap();
    let lines = [&world, &robot].map(|file| file.display().to_string());
    let start = "Half 2542.3 919.3 -51.8";
    fs::write(&scene, format!("world {}\nrobot {}\n{start}\n", lines[0], lines[1])).unwrap();
    for seed in ["6", "123"] {
        let (_, report, err) = localise(&["--world", scene.to_str().unwrap(), "--seed", seed]);
        let is_right = report["outcome"] != "localised" || number(&report, "position_error_mm") < 100.0;
        assert!(is_right && err.is_empty(), "{seed}: {report} {err}");
    }
}

/// A lidar above a low wall does not see what tells the halves of a hall apart.
#[test]
fn a_lidar_passes_over_low_walls() {
    let world = temporary("low.wld");
    let sides = ["0 0 6000 0", "6000 0 6000 4000", "6000 4000 0 4000", "0 4000 0 0"];
    let sides = sides.map(|line| format!("{line} 20 1000\n")).concat();
    fs::write(&world, format!("floor 6000 4000\n{sides}1500 1000 2500 1000 20 150\n")).unwrap();
    let of = |robot| {
        let options = ["--world", world.to_str().unwrap(), "--start", "1000,2600,40", "--robot", robot];
        let (status, report, err) = localise(&options);
        assert_eq!((status, err.as_str()), (0, ""), "{report}");
        (report["outcome"].as_str().unwrap().to_owned(), number(&report, "hypotheses"))
    };
    assert_eq!(of("Blizzard"), ("several_hypotheses".into(), 2.0));
    assert_eq!(of("S4"), ("localised".into(), 1.0));
}
