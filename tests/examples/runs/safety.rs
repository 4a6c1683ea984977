//! The example `safety`, and robots of other examples under the safety system.

use crate::support::{Ended, run};
use crate::{
    a_to_b, ackermann, bug_compare, color_tracking, cone_drive, cone_race, coverage, distbug, follow_me,
    localise, maze_drive, micromouse, motion, navigate, omni, random_drive, safety, wall_following,
};
use serde_json::Value;

/// What goes wrong, and what it is seen as: one of these.
const FAULTS: [(&str, &[&str]); 8] = [
    ("stuck", &["sensor"]),
    ("lost", &["sensor"]),
    ("nan", &["sensor"]),
    ("jump=400,200,40", &["sensor"]),
    ("late=1", &["sensor"]),
    ("link", &["link"]),
    ("hang=2", &["watchdog", "clock"]),
    ("clock", &["clock"]),
];

const OVAL: [&str; 2] = ["--track", "tests/data/cones/oval.csv"];

type Drive = fn(&[&str]) -> Ended;

/// The examples in which a robot drives that is supervised, and seconds into their runs at which something goes wrong.
const PROGRAMS: [(&str, [f64; 2], Drive); 18] = [
    ("a_to_b", [2.0, 3.1], |options| run("a_to_b", a_to_b::work, options)),
    ("ackermann", [2.0, 3.1], |options| run("ackermann", ackermann::work, options)),
    ("color_tracking", [2.0, 3.1], |options| run("color_tracking", color_tracking::work, options)),
    ("cone_drive", [2.0, 3.1], |options| run("cone_drive", cone_drive::work, &[&OVAL, options].concat())),
    ("cone_race", [2.0, 3.1], |options| run("cone_race", cone_race::work, &[&OVAL, options].concat())),
    ("coverage", [2.0, 3.1], |options| run("coverage", coverage::work, options)),
    ("distbug", [2.0, 3.1], |options| run("distbug", distbug::work, options)),
    // It has ended before the third second.
    ("localise", [1.0, 2.0], |options| run("localise", localise::work, options)),
    ("maze_explore", [2.0, 3.1], |options| run("maze_explore", maze_drive::explore, options)),
    ("maze_left", [2.0, 3.1], |options| run("maze_left", maze_drive::left, options)),
    ("maze_lidar", [2.0, 3.1], |options| run("maze_lidar", maze_drive::lidar, options)),
    ("micromouse", [2.0, 2.6], |options| {
        run("micromouse", micromouse::work, &[&["--explore"], options].concat())
    }),
    ("motion", [2.0, 3.1], |options| run("motion", motion::work, options)),
    ("navigate", [2.0, 3.1], |options| run("navigate", navigate::work, options)),
    ("omni", [2.0, 3.1], |options| run("omni", omni::work, options)),
    ("random_drive", [2.0, 3.1], |options| run("random_drive", random_drive::work, options)),
    ("second car", [2.0, 3.1], |options| {
        run("cone_race", cone_race::work, &[&OVAL, &["--other"][..], options].concat())
    }),
    ("wall_following", [2.0, 3.1], |options| run("wall_following", wall_following::work, options)),
];

/// Whether a stop is not what it has to be: seen, for one of some causes, and within its bound.
fn wrong(stop: &Value, causes: &[&str]) -> bool {
    let [way, bound] = ["stop_mm", "bound_mm"].map(|field| stop[field].as_f64().unwrap_or(f64::NAN));
    let seen = stop["causes"]
        .as_array()
        .is_some_and(|seen| seen.iter().any(|seen| seen.as_str().is_some_and(|seen| causes.contains(&seen))));
    !(stop["state"].is_string() && seen && stop["stood"] == true && way <= bound + 1.0)
}

/// Whatever goes wrong, and whatever the program does then, the robot stands within the distance that is proved.
#[test]
fn every_robot_stands_after_every_fault() {
    let mut failures = Vec::new();
    for (name, times, drive) in PROGRAMS {
        for time in times {
            for (fault, causes) in FAULTS {
                // It stands then: odometry that sticks says what is so.
                if name == "motion" && fault == "stuck" {
                    continue;
                }
                let fault = format!("{fault}@{time}");
                let (_, report, err) = drive(&["--supervised", "--fault", &fault, "--time-limit", "6"]);
                if wrong(&report["safety"][0], causes) {
                    failures.push(format!("{name} {fault}: {} {err}", report["safety"]));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Nobody watches the robots of these examples, so they say so.
#[test]
fn examples_without_a_supervised_robot_say_so() {
    let programs: [(&str, Drive); 4] = [
        // Many robots, each in a world of its own.
        ("bug_compare", |options| run("bug_compare", bug_compare::work, options)),
        // Stepped as a troop, all in one thread.
        ("follow_me", |options| run("follow_me", follow_me::work, options)),
        ("random_drive", |options| {
            run("random_drive", random_drive::work, &[&["--robots", "3"], options].concat())
        }),
        // Many runs, on all cores.
        ("a_to_b", |options| {
            run("a_to_b", a_to_b::work, &[&["--campaign", "--runs", "1"], options].concat())
        }),
    ];
    for (name, drive) in programs {
        let (status, _, err) = drive(&["--supervised", "--time-limit", "2"]);
        assert!(status == 2 && err.contains("--supervised: found no robot"), "{name}: {status} {err}");
    }
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

/// Who is out of reach or hangs stops by itself, and the example tells how far it went.
#[test]
fn a_car_that_nobody_talks_to_stops() {
    for (fault, causes) in [("link@3", &["link"][..]), ("hang=20@3", &["watchdog", "clock"])] {
        let (_, report, _) =
            run("safety", safety::work, &[&OVAL, &["--fault", fault, "--time-limit", "27"][..]].concat());
        let stop = &report["stops"][0];
        let [way, bound] = ["distance_m", "bound_m"].map(|field| stop[field].as_f64().unwrap());
        assert!(
            way <= bound && bound < 12.0 && stop["speed_m_s"].as_f64().unwrap() > 1.0,
            "{fault}: {report}"
        );
        let seen = stop["causes"].as_array().unwrap();
        assert!(causes.iter().any(|cause| seen.iter().any(|seen| seen == cause)), "{fault}: {report}");
        assert_eq!(report["collisions"], 0, "{fault}: {report}");
    }
}

/// Time passes for both when the first one waits.
#[test]
fn both_cars_of_a_race_are_supervised() {
    let (status, report, err) =
        run("cone_race", cone_race::work, &[&OVAL, &["--other", "--supervised", "--laps", "1"][..]].concat());
    assert_eq!((status, err.as_str()), (0, ""), "{report}");
    for stop in report["safety"].as_array().unwrap() {
        assert!(stop["state"].is_null() && stop["bound_mm"].as_f64().unwrap() < 1e4, "{report}");
    }
    assert_eq!(report["safety"].as_array().unwrap().len(), 2);
}

/// What the speed is measured wrong by, a stop goes further, and its bound says so.
#[test]
fn stops_are_within_their_bounds_whatever_the_noise() {
    for noise in ["3", "5"] {
        let options = ["--noise", noise, "--event", "radio", "--event", "hang", "--time-limit", "40"];
        let (_, report, err) = run("safety", safety::work, &options);
        assert_eq!((report["outcome"].as_str(), err.as_str()), (Some("stood"), ""), "{report}");
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
