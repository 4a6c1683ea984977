//! The commands `maze-left`, `maze-lidar` and `maze-explore` as wholes.

use super::support::{published, run};
use serde_json::Value;

#[test]
fn the_left_hand_finds_the_goal_when_controlled() {
    for options in [&[][..], &["--micromouse"], &["--micromouse", "--drive", "p"]] {
        let (status, report, err) = run("maze_left", options);
        assert_eq!((status, err.as_str()), (0, ""), "{report}");
        assert_eq!((&report["outcome"], &report["collisions"]), (&"goal".into(), &0.into()), "{report}");
        assert!(report["off_middle_mm"].as_f64().unwrap() < 60.0, "{report}");
    }
    let (status, report, _) = run("maze_left", &["--drive", "open", "--noise", "0"]);
    assert_eq!((status, &report["outcome"]), (0, &"goal".into()), "{report}");
    // As in the book, drive errors lead into a wall.
    let collided = ["1", "2", "3", "4", "5", "6", "7", "8"].map(|seed| {
        let (status, report, _) = run("maze_left", &["--drive", "open", "--noise", "5", "--seed", seed]);
        status == 1 && report["outcome"] == "collided"
    });
    assert!(collided.iter().filter(|&&collided| collided).count() >= 4, "{collided:?}");
}

#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER .ci/run tests"]
fn the_left_hand_touches_no_wall_of_published_mazes() {
    let folder = published("micromouse/kerikun11/data");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.file_name().unwrap().to_str().unwrap().starts_with("16"));
    files.sort();
    assert_eq!(files.len(), 45);
    for (file, noise) in files.iter().flat_map(|file| [(file, "0"), (file, "1")]) {
        let (status, report, _) = run("maze_left", &["--world", file.to_str().unwrap(), "--noise", noise]);
        assert_eq!((status, &report["collisions"]), (0, &0.into()), "{} {noise}: {report}", file.display());
    }
    // In the same mazes, the drive as printed runs into walls.
    let some: Vec<_> = files.iter().step_by(5).collect();
    let collides = |file: &&&std::path::PathBuf| {
        let world = ["--world", file.to_str().unwrap(), "--drive", "open", "--noise", "1"];
        run("maze_left", &world).1["outcome"] == "collided"
    };
    let collided = some.iter().filter(collides).count();
    assert!(collided + 1 >= some.len(), "{collided} of {}", some.len());
}

#[test]
fn worlds_of_eyesim_are_driven() {
    for command in ["maze_left", "maze_lidar", "maze_explore"] {
        let (status, report, err) = run(command, &["--world", "../tests/data/mazes/tiny.maz"]);
        assert_eq!((status, err.as_str()), (0, ""), "{report}");
        assert_eq!((&report["width"], &report["collisions"]), (&4.into(), &0.into()));
    }
    let (status, _, err) = run("maze_left", &["--start", "1,2,3"]);
    assert_eq!(status, 2);
    assert!(err.starts_with("--start: found one; expected none"), "{err}");
    let (status, _, err) = run("maze_lidar", &["--world", "../LICENSE-MIT"]);
    assert_eq!(status, 2, "{err}");
    assert!(err.starts_with("../LICENSE-MIT:"), "{err}");
}

#[test]
fn a_lidar_leads_to_the_goal_and_draws_a_map() {
    let (status, report, err) = run("maze_lidar", &[]);
    assert_eq!((status, err.as_str()), (0, ""), "{report}");
    assert_eq!((&report["outcome"], &report["collisions"]), (&"goal".into(), &0.into()));
    let (_, ideal, _) = run("maze_lidar", &["--noise", "0"]);
    let error = |report: &Value| report["map_error_mm"].as_f64().unwrap();
    assert!(report["map_points"].as_u64().unwrap() > 1000);
    // The map bends with odometry.
    assert!(error(&ideal) < 12.0 && error(&ideal) < error(&report), "{ideal} {report}");
}

#[test]
fn recursion_explores_everything() {
    for options in [&[][..], &["--micromouse"], &["--thorough", "--micromouse"]] {
        let (status, report, err) = run("maze_explore", options);
        assert_eq!((status, err.as_str()), (0, ""), "{report}");
        assert_eq!((&report["outcome"], &report["collisions"]), (&"returned".into(), &0.into()));
        assert_eq!((&report["unknown_walls"], &report["wrong_walls"]), (&0.into(), &0.into()));
        assert_eq!(report["at_goal"], true);
    }
}

#[test]
fn recordings_replay_to_the_same() {
    let file = std::env::temp_dir().join(format!("roverlab-{}-maze.mcap", std::process::id()));
    let name = file.to_str().unwrap();
    for command in ["maze_left", "maze_lidar", "maze_explore"] {
        let world = ["--world", "../tests/data/mazes/tiny.maz", "--seed", "4"];
        let (status, recorded, err) = run(command, &[&world[..], &["--record", name]].concat());
        assert_eq!((status, err.as_str()), (0, ""), "{recorded}");
        let (status, replayed, err) = run(command, &["--replay", name]);
        assert_eq!((status, err.as_str()), (0, ""), "{replayed}");
        for field in ["outcome", "pose", "sim_time_s", "collisions", "path_length_mm"] {
            assert_eq!(recorded[field], replayed[field], "{command}: {field}");
        }
    }
    std::fs::remove_file(file).unwrap();
}

/// A clock that jumps is what ended the path, not an obstacle.
#[test]
fn a_jump_of_the_clock_is_not_an_obstacle() {
    let (status, report, _) = run("maze_explore", &["--fault", "clock=1000@2"]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("failed")), "{report}");
    assert!(report["error"].as_str().unwrap().contains("the clock has advanced by 100"), "{report}");
    let limited = ["--fault", "clock=1000@2", "--time-limit", "20"];
    assert_eq!(run("maze_explore", &limited).1["outcome"], "timed_out");
}
