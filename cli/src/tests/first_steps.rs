//! The tasks of chapter 2 as a whole.

use super::support::{assert_outcome, number, run};

#[test]
fn a_robot_returns_from_a_wall_and_from_a_circle() {
    for (task, way, most) in [("wall", "gap_mm", 320.0), ("circle", "max_deviation_mm", 30.0)] {
        for seed in ["1", "2", "3"] {
            let ended = run("first_steps", &["--task", task, "--seed", seed]);
            assert_outcome(&ended, "returned");
            let report = &ended.1;
            assert!(number(report, "position_error_mm") < 20.0, "{report}");
            assert!(number(report, "heading_error_deg") < 2.0 && number(report, way) < most, "{report}");
        }
    }
}

#[test]
fn a_count_goes_round_any_ring_without_a_duplicate() {
    for (robots, loss) in [("2", "20"), ("7", "20"), ("5", "0")] {
        let ended = run("ping", &["--robots", robots, "--loss", loss, "--messages", "150"]);
        assert_outcome(&ended, "passed_on");
        assert_eq!((&ended.1["messages"], &ended.1["duplicated"]), (&150.into(), &0.into()), "{}", ended.1);
    }
}

#[test]
fn campaigns_are_the_same_in_one_thread_and_in_two() {
    for (command, runs) in [("first_steps", "2"), ("ping", "3")] {
        let of = |threads| run(command, &["--campaign", "--runs", runs, "--threads", threads]);
        let (one, two) = (of("1"), of("2"));
        assert_outcome(&one, "passed");
        assert_eq!(one.1, two.1);
    }
}

#[test]
fn what_makes_no_sense_is_refused() {
    for (command, options, expected) in [
        ("first_steps", &["--goal", "1,1"][..], "--goal"),
        ("first_steps", &["--robot", "Ackermann"], "Ackermann"),
        ("first_steps", &["--campaign", "--task", "wall"], "--task"),
        ("ping", &["--robots", "11"], "2..=10"),
        ("ping", &["--loss", "90"], "0 to 50"),
        ("ping", &["--fault", "link@2"], "--fault"),
    ] {
        let (status, _, err) = run(command, options);
        assert!(status == 2 && err.contains(expected), "{command} {options:?}: {err}");
    }
}
