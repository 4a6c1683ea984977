//! The command `traffic` as a whole.

use std::fs;

use serde_json::Value;

use super::support::{assert_outcome, number, run, temporary, text};

/// Row of an element in a report.
fn row<'r>(report: &'r Value, element: &str) -> &'r Value {
    let rows = report["elements"].as_array().unwrap();
    rows.iter().find(|row| row["element"] == element).unwrap()
}

/// A lap of an oval with a stop line, a crosswalk and boxes.
#[test]
fn a_car_masters_what_is_on_a_course_of_a_file() {
    let file = temporary("traffic.course");
    let road = "straight 4000\nstop-line\nstraight 4000\narc 1600 180\nstraight 2000\nzebra\nstraight 6000\narc 1600 180\n";
    fs::write(&file, format!("course 1\nlane 420\nstart-line\n{road}")).unwrap();
    let ended = run("traffic", &["--course", text(&file), "--laps", "1", "--noise", "1"]);
    assert_outcome(&ended, "finished");
    let report = &ended.1;
    assert_eq!(row(report, "stop line")["right"], 1, "{report}");
    assert_eq!(row(report, "crosswalk with pedestrian")["right"], 1, "{report}");
    assert_eq!(report["collisions"], 0, "{report}");
    assert!(number(report, "points") >= 0.7 * number(report, "points_possible"), "{report}");
}

/// The referee counts zones that a car enters or drives through too fast.
#[test]
fn a_car_slows_down_before_a_speed_zone() {
    let file = temporary("speed-zone.course");
    fs::write(&file, include_str!("../../../tests/data/courses/speed-zone.course")).unwrap();
    let ended = run("traffic", &["--course", text(&file), "--laps", "1", "--noise", "1"]);
    assert_outcome(&ended, "finished");
    assert_eq!(number(&ended.1, "speedings"), 0.0, "{}", ended.1);
    assert_eq!(number(&ended.1, "points"), number(&ended.1, "points_possible"), "{}", ended.1);
}

/// From the right, the box comes in the far lane, and in left-hand traffic in the near one.
#[test]
fn a_car_lets_crossing_traffic_through_at_a_give_way_line() {
    let file = temporary("give-way.course");
    let road = "straight 3600\ncrossing 85 both 1000 give-way\nstraight 3100\n";
    let back = "arc 1550 180\nstraight 6700\narc 1550 180\n";
    for side in ["right", "left"] {
        fs::write(&file, format!("course 1\ntraffic {side}\nlane 410\nstart-line\n{road}{back}")).unwrap();
        let ended = run("traffic", &["--course", text(&file), "--laps", "1", "--noise", "1"]);
        assert_outcome(&ended, "finished");
        assert_eq!(row(&ended.1, "cross traffic")["right"], 1, "{side}: {}", ended.1);
        assert_eq!(ended.1["collisions"], 0, "{side}: {}", ended.1);
    }
}

/// On its crosswalk, the two lines of the road's middle and a stripe are as wide as a pedestrian.
#[test]
fn a_car_leaves_a_crosswalk_when_the_pedestrian_is_gone() {
    let ended = run("traffic", &["--course", "5", "--laps", "1", "--noise", "1"]);
    assert_outcome(&ended, "finished");
    assert_eq!(row(&ended.1, "crosswalk with pedestrian")["right"], 1, "{}", ended.1);
}

#[test]
fn what_is_no_scene_for_traffic_is_refused_by_name() {
    let file = temporary("small.course");
    fs::write(&file, "course 1\nscale 0.5\nstraight 6000\narc 1500 180\nstraight 6000\narc 1500 180\n")
        .unwrap();
    let (status, _, err) = run("traffic", &["--course", text(&file)]);
    assert!(status == 2 && err.contains("found a scale of 0.5; expected 1"), "{err}");
    let (status, _, err) = run("traffic", &["--laps", "0"]);
    assert!(status == 2 && err.contains("--laps"), "{err}");
    let (status, _, err) = run("traffic", &["--campaign", "--course", "3"]);
    assert!(status == 2 && err.contains("--course"), "{err}");
}
