//! The command `wall-following` as a whole.

use std::f64::consts::TAU;
use std::fs;

use super::support;
use super::support::{Ended, number, temporary};
use crate::wall_following;
use crate::wall_following::{Args, Controller, Row};
use clap::Parser;
use roverlab::geometry::direction;
use serde_json::Value;

fn run(options: &[&str]) -> Ended {
    support::run("wall_following", options)
}

#[test]
fn a_room_is_followed_round_on_both_sides() {
    for side in ["left", "right"] {
        let (status, report, err) = run(&["--laps", "2", "--side", side, "--seed", "3"]);
        assert_eq!((status, report["outcome"].as_str(), err.as_str()), (0, Some("followed"), ""), "{report}");
        assert_eq!((number(&report, "laps"), report["side"].as_str()), (2.0, Some(side)));
        assert!(
            number(&report, "rms_error_mm") <= 10.0 && number(&report, "max_error_mm") <= 40.0,
            "{report}"
        );
        assert!(number(&report, "path_length_mm") > 2.0 * number(&report, "lap_length_mm"), "{report}");
    }
}

#[test]
fn the_table_of_a_campaign() {
    let args = Args::try_parse_from(["wall_following", "--campaign", "--rooms", "12"]).unwrap();
    let rows = wall_following::rows(&args).unwrap();
    let text = wall_following::text(&rows);
    assert!(text.lines().count() >= rows.len() + 2, "{text}");
    let [ours, book] = [Controller::Psd, Controller::Book]
        .map(|controller| rows.iter().find(|row| row.controller == controller).unwrap());
    assert!(ours.is_good() && !book.is_good());
    assert!(rows.iter().map(|row: &Row| row.rooms).eq([12; 4]));
}

#[test]
fn worlds_from_files_are_followed_as_well() {
    let world = temporary("square.wld");
    fs::write(&world, "0 0 2000 0\n2000 0 2000 2000\n2000 2000 0 2000\n0 2000 0 0\nposition 1000 1000 30\n")
        .unwrap();
    let world = world.to_str().unwrap();
    for controller in ["psd", "lidar"] {
        let (status, report, err) = run(&["--world", world, "--controller", controller]);
        assert_eq!((status, report["outcome"].as_str()), (0, Some("followed")), "{report} {err}");
        // Four sides of 1.6 m.
        assert!((number(&report, "lap_length_mm") - 6400.0).abs() < 400.0, "{report}");
    }
    let (status, report, _) = run(&["--world", world, "--time-limit", "3"]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("timed_out")), "{report}");
    let (status, report, err) = run(&["--world", world, "--fault", "link@4"]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("failed")), "{report}");
    assert!(err.contains("link"), "{err}");
}

/// Rooms whose walls are too short to be followed for long: who gets round has followed them, who has no room
/// for that is blocked, and nobody drives until the time is over.
#[test]
fn small_rooms_are_followed_round_or_end_as_blocked() {
    let world = temporary("small.wld");
    let ended = |walls: u32, radius: f64, options: &[&str]| {
        let corner = |wall: u32| {
            let away = direction(f64::from(wall) * TAU / f64::from(walls) + 0.1) * radius;
            format!("{:.1} {:.1}", 1000.0 + away.x, 1000.0 + away.y)
        };
        let room = (0..walls).map(|wall| format!("{} {}", corner(wall), corner(wall + 1)));
        let lines: Vec<String> =
            ["width 2000", "height 2000"].map(String::from).into_iter().chain(room).collect();
        fs::write(&world, lines.join("\n")).unwrap();
        let place = ["--world", world.to_str().unwrap(), "--start", "1000,1000,34"];
        let (_, report, _) = run(&[&place[..], options].concat());
        (report["outcome"].as_str().unwrap_or("refused").to_owned(), report)
    };
    for controller in ["psd", "pid", "lidar"] {
        for (walls, radius) in [(4, 505.0), (5, 506.0), (7, 480.0)] {
            for noise in ["0", "1"] {
                let (outcome, report) =
                    ended(walls, radius, &["--controller", controller, "--noise", noise, "--seed", "740"]);
                assert_eq!(outcome, "followed", "{report}");
                assert!(number(&report, "rms_error_everywhere_mm") < 100.0, "{report}");
                assert!(number(&report, "lap_length_mm") > 800.0, "{report}");
            }
        }
        let (outcome, report) = ended(4, 300.0, &["--controller", controller]);
        assert_eq!(outcome, "blocked", "{report}");
    }
}

#[test]
fn a_wrong_command_line_is_refused() {
    for options in
        [&["--goal", "1,2"][..], &["--laps", "0"], &["--distance", "10"], &["--controller", "fuzzy"]]
    {
        let (status, report, err) = run(options);
        assert!(status == 2 && report == Value::Null, "{options:?}");
        assert!(err.lines().count() == 1, "{err}");
    }
}

#[test]
fn a_picture_shows_the_way() {
    let file = temporary("wall_following.svg");
    assert_eq!(run(&["--picture", file.to_str().unwrap()]).0, 0);
    let svg = fs::read_to_string(&file).unwrap();
    for part in ["Wall following (psd): all the way round", "true path", "largest error"] {
        assert!(svg.contains(part), "{part} is missing");
    }
}
