//! The commands `a-to-b`, `ackermann` and `omni` as wholes.

use std::fs;

use super::support::{Ended, folder, number, run, temporary};
use crate::a_to_b;
use clap::Parser;

fn a_to_b(options: &[&str]) -> Ended {
    run("a_to_b", options)
}

fn assert_reached((status, report, err): &Ended, most_mm: f64) {
    assert_eq!((*status, report["outcome"].as_str(), err.as_str()), (0, Some("reached"), ""), "{report}");
    assert!(number(report, "position_error_mm") <= most_mm, "{report}");
}

#[test]
fn every_method_arrives_without_noise() {
    for method in ["turn", "arc", "dog", "spline"] {
        for goal in ["2450,1650,0", "500,1300", "1800,2400,90", "1000,990,-90"] {
            let ended = a_to_b(&["--method", method, "--goal", goal, "--noise", "0"]);
            assert_reached(&ended, 6.0);
            if goal.matches(',').count() == 2 {
                assert!(number(&ended.1, "heading_error_deg") <= 0.3, "{method}: {}", ended.1);
            }
        }
    }
    // A goal within the lookahead; and one whose last turn ends with both wheels between two encoder ticks.
    for (method, goal) in [("spline", "-9.4,-48.5,102.1"), ("arc", "-490.7,-89.2,-151.2")] {
        let place = ["--start", "0,0,0", "--goal", goal, "--noise", "0"];
        let ended = a_to_b(&[&place[..], &["--method", method, "--follower", "pure-pursuit"]].concat());
        assert_reached(&ended, 6.0);
    }
    let pursuit = a_to_b(&["--follower", "pure-pursuit", "--noise", "0", "--ideal-encoders"]);
    assert_reached(&pursuit, 1.0);
    assert!(number(&pursuit.1, "heading_error_deg") <= 0.1);
}

#[test]
fn the_table_of_a_campaign() {
    let args = a_to_b::Args::try_parse_from(["a_to_b", "--campaign", "--runs", "40"]).unwrap();
    let rows = a_to_b::rows(&args).unwrap();
    insta::assert_snapshot!("a_to_b_forty_runs", a_to_b::text(&rows));
    assert!(rows.iter().all(a_to_b::Row::is_good));
}

#[test]
fn waypoints_are_passed_and_a_moving_goal_is_caught() {
    let chain = ["--via", "1500,2000", "--via", "2000,1000", "--goal", "3000,2500,90", "--noise", "0"];
    for follower in ["cross-track", "pure-pursuit"] {
        let ended = a_to_b(&[&chain[..], &["--follower", follower]].concat());
        assert_reached(&ended, 6.0);
        assert!(number(&ended.1, "heading_error_deg") <= 0.3, "{}", ended.1);
        assert!(number(&ended.1, "path_length_mm") > 4000.0, "{}", ended.1);
    }
    for method in ["turn", "arc", "dog", "spline"] {
        let (status, report, err) = a_to_b(&["--method", method, "--moving", "80,-6"]);
        assert_eq!((status, report["outcome"].as_str()), (0, Some("caught")), "{method}: {report} {err}");
        assert!(number(&report, "position_error_mm") < 150.0, "{method}: {report}");
    }
    for refused in [
        &["--via", "1500,2000", "--method", "arc"][..],
        &["--moving", "80", "--via", "1,1"],
        &["--moving", "fast"],
        &["--via", "1000,1000"],
    ] {
        let (status, _, err) = a_to_b(refused);
        assert!(status == 2 && err.lines().count() == 1, "{refused:?}: {err}");
    }
}

#[test]
fn a_pole_in_the_world_corrects_odometry() {
    let ended = a_to_b(&["--landmark", "--noise", "1", "--seed", "5"]);
    assert_reached(&ended, 20.0);
    assert!(number(&ended.1, "landmark_scans") > 100.0, "{}", ended.1);
    let folder = folder();
    let world = folder.join("no_pole.wld");
    fs::write(&world, "floor 3000 3000\nposition 500 500 0\n").unwrap();
    let (status, _, err) = a_to_b(&["--landmark", "--world", world.to_str().unwrap(), "--goal", "1000,1000"]);
    assert!(status == 2 && err.contains("found no pole"), "{err}");
}

#[test]
fn a_wall_in_the_way_is_a_collision() {
    let world = temporary("wall.wld");
    fs::write(&world, "floor 3000 3000\nposition 500 1500 0\n1500 0 1500 3000\n").unwrap();
    let (status, report, _) = a_to_b(&["--world", world.to_str().unwrap(), "--goal", "2500,1500"]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("collided")), "{report}");
    assert!(number(&report, "sim_time_s") < 30.0, "{report}");
}

#[test]
fn a_robot_that_fails_ends_the_run() {
    let (status, report, err) = a_to_b(&["--fault", "link@2"]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("failed")), "{report}");
    assert!(err.contains("link"), "{err}");
    let (status, report, _) = a_to_b(&["--time-limit", "2"]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("timed_out")), "{report}");
}

/// What a run until its limit says holds for the whole of it.
#[test]
fn a_clock_that_jumps_to_the_limit_does_not_end_a_run_in_peace() {
    for command in ["random_drive", "motion", "lane_keeping", "localise"] {
        let (status, report, err) = run(command, &["--fault", "clock=1000@0.5"]);
        assert_eq!((status, report["outcome"].as_str()), (1, Some("failed")), "{command}: {report}");
        assert!(err.contains("the robot's clock ended the run"), "{command}: {err}");
    }
}

#[test]
fn cars_keep_to_their_turning_circle() {
    for method in ["turn", "arc", "dog", "spline"] {
        for goal in ["3200,2700,90", "3000,2000", "1500,2000", "1500,1700,180", "500,1500"] {
            let options = ["--method", method, "--goal", goal, "--noise", "0"];
            let ended = run("ackermann", &options);
            assert_reached(&ended, 10.0);
            if goal.matches(',').count() == 2 {
                assert!(number(&ended.1, "heading_error_deg") <= 1.5, "{options:?}: {}", ended.1);
            }
        }
    }
}

#[test]
fn moving_goals_are_caught_by_every_method() {
    for (method, velocity) in
        [("turn", "100,10"), ("arc", "100,10"), ("dog", "100,10"), ("spline", "100,10"), ("dog", "200")]
    {
        let ended = a_to_b(&["--method", method, "--moving", velocity, "--noise", "0"]);
        assert_eq!(ended.1["outcome"].as_str(), Some("caught"), "{method} {velocity}: {}", ended.1);
    }
}

#[test]
fn cars_that_arrive_askew_come_again() {
    for goal in ["354,-1968,6", "93.6,409.5,178", "-472.7,468.2,-173.7"] {
        let ended = run("ackermann", &["--start", "0,0,0", "--goal", goal, "--noise", "0"]);
        assert_reached(&ended, 15.0);
        assert!(number(&ended.1, "heading_error_deg") <= 2.0, "{goal}: {}", ended.1);
    }
}

#[test]
fn omni_drives_in_a_square_and_straight_while_it_spins() {
    let square = run("omni", &["--noise", "0"]);
    assert_reached(&square, 2.0);
    assert!(number(&square.1, "max_heading_error_deg") < 0.1 && number(&square.1, "max_deviation_mm") < 6.0);
    let spin = run("omni", &["--task", "spin", "--noise", "0", "--goal", "2000,900"]);
    assert_reached(&spin, 2.0);
    assert!(number(&spin.1, "turned_deg") > 300.0 && number(&spin.1, "max_deviation_mm") < 8.0, "{}", spin.1);
    assert_reached(&run("omni", &["--seed", "2"]), 100.0);
}

#[test]
fn robots_with_another_drive_are_refused() {
    let file = temporary("car.robi");
    fs::write(&file, roverlab::world::formats::robi::print(&roverlab::world::RobotSpec::car())).unwrap();
    let car = file.to_str().unwrap();
    for ended in [
        a_to_b(&["--robot", car]),
        run("omni", &["--robot", car]),
        run("omni", &["--goal", "1,1"]),
        run("ackermann", &["--goal", "1,2,3,4"]),
    ] {
        assert!(ended.0 == 2 && ended.2.contains("expected") && ended.2.lines().count() == 1, "{}", ended.2);
    }
    assert_reached(&run("ackermann", &["--robot", car, "--noise", "0"]), 10.0);
}

#[test]
fn pictures_show_plan_and_path() {
    let folder = folder();
    let file = folder.join("a_to_b.svg");
    let name = file.to_str().unwrap();
    assert_eq!(a_to_b(&["--picture", name]).0, 0);
    let svg = fs::read_to_string(&file).unwrap();
    for part in ["From A to B by spline: goal reached", "true path", "odometry", "95 % ellipse"] {
        assert!(svg.contains(part), "{part} is missing");
    }
    let file = folder.join("omni.svg");
    assert_eq!(run("omni", &["--picture", file.to_str().unwrap()]).0, 0);
    assert!(fs::read_to_string(&file).unwrap().contains("a square without turning"));
}
