//! The example `safety`, and robots of other examples under the safety system.

use crate::support::{Ended, run};
use crate::{a_to_b, ackermann, cone_drive, cone_race, distbug, omni, safety, wall_following};
use serde_json::Value;

/// What goes wrong two seconds after the start.
const FAULTS: [&str; 8] =
    ["stuck@2", "lost@2", "nan@2", "jump=400,200,40@2", "late=1@2", "link@2", "hang=2@2", "clock@2"];

const OVAL: [&str; 2] = ["--track", "tests/data/cones/oval.csv"];

/// Whatever goes wrong, and whatever the program does then, the robot stands within the distance that is proved.
#[test]
fn every_robot_stands_after_every_fault() {
    type Drive = fn(&[&str]) -> Ended;
    let programs: [(&str, Drive); 7] = [
        ("a_to_b", |options| run("a_to_b", a_to_b::work, options)),
        ("ackermann", |options| run("ackermann", ackermann::work, options)),
        ("distbug", |options| run("distbug", distbug::work, options)),
        ("omni", |options| run("omni", omni::work, options)),
        ("wall_following", |options| run("wall_following", wall_following::work, options)),
        ("cone_drive", |options| run("cone_drive", cone_drive::work, &[&OVAL, options].concat())),
        ("cone_race", |options| run("cone_race", cone_race::work, &[&OVAL, options].concat())),
    ];
    let mut failures = Vec::new();
    for (name, drive) in programs {
        for fault in FAULTS {
            let (_, report, err) = drive(&["--supervised", "--fault", fault, "--time-limit", "6"]);
            let stop = &report["safety"][0];
            let [way, bound] = ["stop_mm", "bound_mm"].map(|field| stop[field].as_f64().unwrap_or(f64::NAN));
            if !(stop["state"].is_string() && stop["stood"] == true && way <= bound + 1.0) {
                failures.push(format!("{name} {fault}: {stop} {err}"));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn without_a_fault_nothing_stops_them() {
    let (status, report, err) = run("a_to_b", a_to_b::work, &["--supervised"]);
    assert_eq!((status, report["outcome"].as_str(), err.as_str()), (0, Some("reached"), ""), "{report}");
    assert_eq!(report["safety"][0]["state"], Value::Null, "{report}");
}

/// All kinds of stops, one after the other, and each time it is armed and started again.
#[test]
fn a_car_is_stopped_and_set_going_again() {
    for noise in ["0", "1"] {
        let (status, report, err) = run("safety", safety::work, &["--noise", noise]);
        assert_eq!((status, report["outcome"].as_str(), err.as_str()), (0, Some("stood"), ""), "{report}");
        let stops = report["stops"].as_array().unwrap();
        let states = |word: &str| stops.iter().filter(|stop| stop["state"] == word).count();
        assert!(states("EmergencyStop") >= 2 && states("SafeStop") >= 2, "{report}");
        for stop in stops {
            let [way, bound] = ["distance_m", "bound_m"].map(|field| stop[field].as_f64().unwrap());
            assert!(way <= bound, "{stop}");
        }
        let went_on = report["states"].as_array().unwrap().iter().filter(|state| state[1] == "Auto").count();
        assert_eq!(went_on, 7, "at the beginning and after every event: {report}");
    }
}

#[test]
fn it_does_not_leave_its_fence() {
    let (_, report, err) =
        run("safety", safety::work, &["--fence", "25", "--event", "wheel", "--time-limit", "30"]);
    assert_eq!(err, "", "{report}");
    let stop = &report["stops"][0];
    assert!(stop["state"] == "SafeStop" && stop["causes"][0] == "outside the fence", "{report}");
}

#[test]
fn options_without_a_meaning() {
    let (status, _, err) = run("safety", safety::work, &["--supervised"]);
    assert!(status == 2 && err.contains("here the car always is"), "{err}");
}
