//! What commands say of runs that ended before there was anything to judge, or in which nothing could happen.

use std::fs;

use super::support::{number, run, temporary, text};

/// A square room with an S4 in the middle, its sides in mm.
fn room(side: u32) -> String {
    let walls = ["0 0 S 0", "S 0 S S", "S S 0 S", "0 S 0 0"].join("\n").replace('S', &side.to_string());
    let world = temporary(&format!("room{side}.wld"));
    fs::write(&world, format!("floor {side} {side}\n{walls}\nposition {0} {0} 0\n", side / 2)).unwrap();
    text(&world).to_owned()
}

#[test]
fn a_run_that_was_cut_short_is_no_success() {
    let cases: [(&str, &[&str]); 6] = [
        ("bug_compare", &["--time-limit", "1"]),
        ("motion", &["--time-limit", "0.05"]),
        ("lane_keeping", &["--minutes", "0.2", "--time-limit", "1"]),
        ("end_to_end", &["--minutes", "0.2", "--time-limit", "1"]),
        ("base_station", &["--cars", "2", "--time-limit", "3"]),
        ("follow_me", &["--time-limit", "5"]),
    ];
    for (command, options) in cases {
        let (status, report, err) = run(command, options);
        assert_eq!((status, &report["outcome"]), (1, &"timed_out".into()), "{command}: {report} {err}");
        assert!(report["went_on"].is_null() && report["mean_gap_mm"].is_null(), "{report}");
    }
}

#[test]
fn robots_without_room_say_so() {
    let cells = [room(300), room(500)];
    let closed = temporary("closed.txt");
    fs::write(&closed, "o---o---o\n| S | G |\no---o---o\n").unwrap();
    let cases: [(&str, &[&str], &str); 5] = [
        ("maze_left", &["--world", text(&closed)], "enclosed"),
        ("random_drive", &["--robot", "Ackermann"], "blocked"),
        ("random_drive", &["--world", &cells[0]], "blocked"),
        ("first_steps", &["--world", &cells[0]], "no_room"),
        ("first_steps", &["--world", &cells[1]], "no_room"),
    ];
    for (command, options, outcome) in cases {
        let (status, report, err) = run(command, options);
        assert_eq!(
            (status, &report["outcome"]),
            (1, &outcome.into()),
            "{command} {options:?}: {report} {err}"
        );
    }
    // Too short a drive to tell.
    let (status, report, _) = run("random_drive", &["--time-limit", "0.01"]);
    assert_eq!((status, &report["outcome"]), (0, &"driven".into()), "{report}");
}

/// A leader that stands at its only marker is not blocked.
#[test]
fn a_leader_may_arrive() {
    let (world, scene) = (temporary("hall.wld"), temporary("hall.sim"));
    fs::write(&world, "floor 6000 6000\n").unwrap();
    let lines = "LabBot 1500 1500 0\nmarker 4500 1500 0 255 0\n";
    fs::write(&scene, format!("world {}\n{lines}", text(&world))).unwrap();
    let (status, report, err) = run("follow_me", &["--world", text(&scene)]);
    assert_eq!((status, &report["outcome"]), (0, &"followed".into()), "{report} {err}");
}

/// A pool of 8 m x 6 m with more walls.
fn pool(name: &str, walls: &str) -> String {
    let sides = ["0 0 8000 0", "8000 0 8000 6000", "8000 6000 0 6000", "0 6000 0 0"];
    let sides = sides.map(|line| format!("{line} 20 3000\n")).concat();
    let world = temporary(&format!("{name}.wld"));
    let water = "water_level 2000\nposition 2000 3000 0\n";
    fs::write(&world, format!("floor 8000 6000\n{sides}{walls}{water}")).unwrap();
    text(&world).to_owned()
}

/// A craft that a wall holds has no way over ground, whatever its thrusters do.
#[test]
fn a_log_measures_no_way_through_a_wall() {
    let divided = pool("divided", "4000 0 4000 6000 20 3000\n");
    let options = ["--world", &divided, "--course", "7000,3000", "--noise", "0", "--time-limit", "60"];
    let (status, report, err) = run("boat", &options);
    assert!(status == 1 && number(&report, "collisions") > 0.0, "{report} {err}");
    let [pose, odometry] = ["pose", "odometry"].map(|which| number(&report[which], "x_mm"));
    assert!(pose < 4000.0 && (pose - odometry).abs() < 30.0, "{report}");
}

#[test]
fn a_boat_that_is_there_has_arrived() {
    let options = ["--world", &pool("there", ""), "--course", "2000,3000", "--noise", "0"];
    let (status, report, err) = run("boat", &options);
    assert_eq!((status, &report["outcome"]), (0, &"arrived".into()), "{report} {err}");
    assert!(report["cross_track_rms_mm"].is_null(), "{report}");
}

#[test]
fn lanes_are_not_planned_over_walls() {
    for (name, wall) in
        [("island", "3000 4000 5000 4000 20 3000\n"), ("slanted", "5000 0 8000 3000 20 3000\n")]
    {
        for command in ["survey", "pool_search"] {
            let (status, _, err) = run(command, &["--world", &pool(name, wall)]);
            assert!(status == 2 && err.contains("found walls or ground amid the water"), "{name}: {err}");
        }
    }
}
