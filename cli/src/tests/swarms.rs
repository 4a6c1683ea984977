//! The commands `random-drive`, `coverage` and `follow-me` as wholes.

use std::fs;

use super::support::{Ended, assert_outcome, folder, number, run, temporary};
use crate::{coverage, follow_me};
use clap::Parser;

fn assert_ended((status, report, err): &Ended, outcome: &str) {
    assert_eq!((*status, report["outcome"].as_str(), err.as_str()), (0, Some(outcome), ""), "{report}");
    assert_eq!(number(report, "collisions"), 0.0);
}

#[test]
fn robots_drive_at_random_without_touching_anything() {
    for (robots, seed) in [("1", "1"), ("1", "2"), ("3", "1"), ("3", "2"), ("6", "3")] {
        let options = ["--robots", robots, "--seed", seed, "--time-limit", "60"];
        let ended = run("random_drive", &options);
        assert_ended(&ended, "driven");
        assert!(
            number(&ended.1, "turns") >= 3.0 && number(&ended.1, "coverage_percent") > 5.0,
            "{}",
            ended.1
        );
        assert_eq!(ended.1["robots"].to_string(), robots);
    }
    let ended = run("random_drive", &["--campaign", "--runs", "4", "--time-limit", "60"]);
    assert_outcome(&ended, "passed");
    let refused = run("random_drive", &["--robots", "3", "--fault", "link@1"]);
    assert!(refused.0 == 2 && refused.2.contains("several robots"), "{}", refused.2);
}

#[test]
fn the_whole_floor_is_covered() {
    let file = temporary("coverage.svg");
    let ended = run("coverage", &["--picture", file.to_str().unwrap()]);
    assert_ended(&ended, "covered");
    let report = &ended.1;
    assert!(number(report, "coverage_percent") >= 98.0 && number(report, "path_ratio") <= 1.5, "{report}");
    assert!(number(report, "random_drive_percent") < number(report, "coverage_percent") - 10.0, "{report}");
    assert!(fs::read_to_string(&file).unwrap().contains("% of the floor"));
    let (status, report, _) = run("coverage", &["--time-limit", "20"]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("timed_out")), "{report}");
}

#[test]
fn the_table_of_covered_rooms() {
    let args = coverage::Args::try_parse_from(["coverage", "--campaign", "--rooms", "3"]).unwrap();
    let row = coverage::row(&args).unwrap();
    let text = coverage::text(&row);
    assert!(row.is_good() && row.random_most < row.least, "{text}");
    assert!(text.contains("lanes        3") && text.contains("good: 98 % at least"), "{text}");
}

#[test]
fn nobody_is_lost() {
    for options in [
        &["--followers", "1"][..],
        &["--followers", "1", "--obstacles", "4"],
        &["--followers", "5"],
        &["--followers", "1", "--pattern", "eight"],
        &["--followers", "1", "--pattern", "zigzag"],
        &["--followers", "1", "--pattern", "stop-and-go"],
        &["--followers", "5", "--mode", "radio", "--obstacles", "3"],
        &["--followers", "20", "--time-limit", "40"],
    ] {
        let ended = run("follow_me", options);
        assert_ended(&ended, "followed");
        assert_eq!(number(&ended.1, "lost"), 0.0);
        assert!(number(&ended.1, "path_length_mm") > 3000.0, "{}", ended.1);
    }
}

/// A follower that took a pillar for the leader is lost, though the leader comes past it in the end.
#[test]
fn who_followed_a_pillar_is_lost() {
    const PILLARS: [[(u32, u32); 4]; 4] = [
        [(3104, 2646), (3035, 2695), (2986, 2625), (3056, 2577)],
        [(1592, 3321), (1513, 3289), (1545, 3210), (1624, 3242)],
        [(3779, 1380), (3665, 1324), (3722, 1210), (3836, 1266)],
        [(1172, 1994), (1054, 1946), (1102, 1828), (1220, 1876)],
    ];
    let hall = [(0, 0), (5000, 0), (5000, 4000), (0, 4000)];
    let side = |corners: &[(u32, u32); 4], k: usize| {
        let ((x, y), (to_x, to_y)) = (corners[k], corners[(k + 1) % 4]);
        format!("{x} {y} {to_x} {to_y}\n")
    };
    let sides = PILLARS.iter().chain([&hall]).flat_map(|corners| (0..4).map(|k| side(corners, k)));
    let lines = format!("floor 5000 4000\n{}", sides.collect::<String>());
    let folder = folder();
    fs::write(folder.join("pillars.wld"), lines).unwrap();
    let scene = folder.join("pillars.sim");
    fs::write(&scene, "world pillars.wld\nLabBot 2406 3034 39\nLabBot 2180 2854 39\n").unwrap();
    let (status, report, err) = run("follow_me", &["--world", scene.to_str().unwrap(), "--seed", "168"]);
    let ending = (status, report["outcome"].as_str(), number(&report, "lost"));
    assert_eq!(ending, (1, Some("lost"), 1.0), "{report} {err}");
}

/// By radio, a leader is heard through walls.
#[test]
fn a_follower_in_another_room_is_lost() {
    let folder = folder();
    fs::write(folder.join("rooms.wld"), "floor 8000 4000\n0 0 8000 0\n0 4000 8000 4000\n4000 0 4000 4000\n")
        .unwrap();
    let scene = folder.join("rooms.sim");
    let script = "world rooms.wld\nLabBot 2200 1800 0\nS4 6200 1800 0\nmarker 3000 3000\nmarker 1500 2500\n";
    fs::write(&scene, script).unwrap();
    let options = ["--mode", "radio", "--world", scene.to_str().unwrap(), "--time-limit", "60"];
    let (status, report, err) = run("follow_me", &options);
    let ending = (status, report["outcome"].as_str(), number(&report, "lost"));
    assert_eq!(ending, (1, Some("lost"), 1.0), "{report} {err}");
}

#[test]
fn letters_in_a_maze_stand_for_robots() {
    let folder = folder();
    fs::write(
        folder.join("swarm.maz"),
        " _ _ _ _ _ _\n|           |\n|           |\n|  a a l    |\n|_ _ _ _ _ _|\n720\n",
    )
    .unwrap();
    let sim = folder.join("swarm.sim");
    fs::write(&sim, "world swarm.maz\nLabBot l 0\nS4 a 0\n").unwrap();
    let (status, report, err) =
        run("follow_me", &["--world", sim.to_str().unwrap(), "--time-limit", "20", "--mode", "chain"]);
    assert!(status == 0 || status == 1, "{report} {err}");
    assert_eq!(number(&report, "followers"), 2.0);
}

#[test]
fn worlds_without_robots_get_them() {
    let world = temporary("bare.wld");
    fs::write(&world, "floor 5000 5000\nposition 2500 1000 0\n0 3000 3000 3000\n").unwrap();
    let world = world.to_str().unwrap();
    let options = ["--world", world, "--followers", "3", "--time-limit", "30"];
    let ended = run("follow_me", &options);
    assert_ended(&ended, "followed");
    assert_eq!(number(&ended.1, "followers"), 3.0);
    let options = ["--world", world, "--robots", "4", "--time-limit", "30"];
    let ended = run("random_drive", &options);
    assert_ended(&ended, "driven");
    assert_eq!(number(&ended.1, "robots"), 4.0);
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = folder();
    let (alone, narrow, pair) =
        (folder.join("alone.wld"), folder.join("narrow.wld"), folder.join("pair.sim"));
    fs::write(&alone, "floor 3000 3000\n").unwrap();
    fs::write(&narrow, "floor 600 600\nposition 300 300 0\n").unwrap();
    fs::write(&pair, "world alone.wld\nLabBot 1000 1000 0\nS4 500 1000 0\n").unwrap();
    for options in [
        &["--fault", "link@1"][..],
        &["--followers", "0"],
        &["--world", alone.to_str().unwrap()],
        &["--world", narrow.to_str().unwrap(), "--followers", "20"],
        &["--world", pair.to_str().unwrap(), "--followers", "2"],
    ] {
        let (status, _, err) = run("follow_me", options);
        assert!(status == 2 && err.lines().count() == 1, "{options:?}: {err}");
    }
}

#[test]
fn the_table_of_a_campaign() {
    let words = ["follow_me", "--campaign", "--runs", "1", "--time-limit", "30"];
    let args = follow_me::Args::try_parse_from(words).unwrap();
    let rows = follow_me::rows(&args).unwrap();
    let text = follow_me::text(&rows);
    assert!(rows.iter().all(follow_me::Row::is_good), "{text}");
    assert!(text.lines().count() >= rows.len() + 2);
}

/// A leader without a free way leads nobody.
#[test]
fn a_leader_without_room_is_blocked() {
    let world = temporary("box.wld");
    let walls = "0 0 900 0\n900 0 900 900\n900 900 0 900\n0 900 0 0";
    std::fs::write(&world, format!("floor 900 900\n{walls}\nposition 450 450 0\n")).unwrap();
    let (status, report, _) = run("follow_me", &["--world", world.to_str().unwrap()]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("blocked")), "{report}");
}
