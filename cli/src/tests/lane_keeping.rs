//! The command `lane-keeping` as a whole.

use std::fs;

use super::support::{assert_outcome, run, temporary, text};

/// Half a minute on an oval, in either traffic.
#[test]
fn a_car_keeps_its_lane_on_a_course_of_a_file() {
    for traffic in ["right", "left"] {
        let file = temporary(&format!("{traffic}.course"));
        let road = "straight 3000\ngap centre 800\narc 1600 180\nzebra\nstraight 3000\ncentre double\narc 1600 180\n";
        fs::write(&file, format!("course 1\ntraffic {traffic}\nlane 400\n{road}")).unwrap();
        let ended =
            run("lane_keeping", &["--course", text(&file), "--minutes", "0.15", "--sensors", "camera"]);
        assert_outcome(&ended, "kept");
        let report = &ended.1;
        assert!(report["distance_m"].as_f64().unwrap() > 15.0, "{report}");
        assert!(report["offset_rms_mm"].as_f64().unwrap() < 25.0, "{report}");
        assert_eq!(
            (report["departures"].as_u64(), report["autonomy_percent"].as_f64()),
            (Some(0), Some(100.0))
        );
        assert_eq!(report["survival_s"], report["sim_time_s"]);
    }
}

#[test]
fn the_books_driver_is_judged_by_the_same_referee() {
    let (_, report, _) = run("lane_keeping", &["--driver", "book", "--minutes", "0.1", "--course", "3"]);
    assert_eq!(report["driver"], "book");
    assert!(report["distance_m"].as_f64().unwrap() > 1.0, "{report}");
}

#[test]
fn what_is_no_course_is_refused_where_it_is_wrong() {
    let file = temporary("narrow.course");
    let text_of = |lane: &str| {
        format!("course 1\nlane {lane}\nstraight 3000\narc 1500 180\nstraight 3000\narc 1500 180\n")
    };
    fs::write(&file, text_of("180")).unwrap();
    let (status, _, err) = run("lane_keeping", &["--course", text(&file)]);
    assert!(status == 2 && err.contains("lanes of 0.18 m; expected 0.35 to 0.45 m"), "{err}");
    // At a scale of 2:1 the lane is 190 mm wide, and the car as well.
    fs::write(&file, text_of("380").replace("lane", "scale 2\nlane")).unwrap();
    let (status, _, err) = run("lane_keeping", &["--course", text(&file)]);
    assert!(status == 2 && err.contains("expected a car that fits in its lane"), "{err}");
    let (status, _, err) = run("lane_keeping", &["--course", "none.course"]);
    assert!(status == 2 && err.contains("none.course"), "{err}");
    let (status, _, err) = run("lane_keeping", &["--light", "-1"]);
    assert!(status == 2 && err.contains("--light"), "{err}");
    let (status, _, err) = run("lane_keeping", &["--campaign", "--course", "3"]);
    assert!(status == 2 && err.contains("--course"), "{err}");
}
