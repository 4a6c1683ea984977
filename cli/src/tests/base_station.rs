//! The command `base-station` as a whole.

use super::support::{number, run};

#[test]
fn two_cars_share_a_road_and_obey_the_base_station() {
    let words = ["--cars", "2", "--stop-at", "8", "--time-limit", "24", "--noise", "1"];
    let (status, report, _) = &run("base_station", &words);
    assert_eq!(
        (*status, &report["outcome"], &report["reports"]),
        (0, &"shared".into(), &2.into()),
        "{report}"
    );
    assert!(number(report, "stopped_s") < 3.0 && report["went_on"] == true, "{report}");
    assert!(
        report["distances_m"].as_array().unwrap().iter().all(|it| it.as_f64().unwrap() > 3.0),
        "{report}"
    );
}

#[test]
fn roads_that_are_too_small_for_the_cars_are_refused() {
    let (status, _, err) = run("base_station", &["--cars", "9"]);
    assert!(status == 2 && err.contains("--cars"), "{err}");
    let (status, _, err) = run("base_station", &["--course", "none.course"]);
    assert!(status == 2 && err.contains("none.course"), "{err}");
}
