//! The command `safety`, and robots of other commands under the safety system.

use super::support::{Ended, run};
use serde_json::Value;

/// An injected fault.
struct Wrong {
    fault: &'static str,
    /// Possible causes reported for it.
    causes: &'static [&'static str],
    /// Time until it can be noticed (s), for a wheel speed (m/s), as documented for `Supervised`.
    noticed: fn(f64) -> f64,
}

/// Control period (s).
const PERIOD: f64 = 0.02;

/// Frozen odometry is noticed after four looks, and once 10 mm are missing, including part of the last
/// look's.
fn frozen(speed: f64) -> f64 {
    f64::max(4.0 * PERIOD, 0.01 / speed.max(0.01) + PERIOD)
}

const FAULTS: [Wrong; 8] = [
    Wrong { fault: "stuck", causes: &["sensor"], noticed: frozen },
    Wrong { fault: "lost", causes: &["sensor"], noticed: |_| 0.0 },
    Wrong { fault: "nan", causes: &["sensor"], noticed: |_| 0.0 },
    Wrong { fault: "jump=400,200,40", causes: &["sensor"], noticed: |_| 0.0 },
    // Late readings look like frozen ones, unless they jump.
    Wrong { fault: "late=1", causes: &["sensor"], noticed: frozen },
    Wrong { fault: "link", causes: &["link"], noticed: |_| 0.0 },
    // The fault is over by then; the robot's own watchdog has stopped it meanwhile, and odometry has gone on.
    Wrong { fault: "hang=2", causes: &["watchdog", "clock", "sensor"], noticed: |_| 2.0 },
    Wrong { fault: "clock", causes: &["clock"], noticed: |_| PERIOD },
];

const OVAL: [&str; 2] = ["--track", "../tests/data/cones/oval.csv"];

type Drive = fn(&[&str]) -> Ended;

/// The commands with a supervised robot, and times of faults in their runs (s).
const PROGRAMS: [(&str, [f64; 2], Drive); 19] = [
    ("a_to_b", [2.0, 3.1], |options| run("a_to_b", options)),
    ("ackermann", [2.0, 3.1], |options| run("ackermann", options)),
    ("color_tracking", [2.0, 3.1], |options| run("color_tracking", options)),
    ("cone_drive", [2.0, 3.1], |options| run("cone_drive", &[&OVAL, options].concat())),
    ("cone_race", [2.0, 3.1], |options| run("cone_race", &[&OVAL, options].concat())),
    ("coverage", [2.0, 3.1], |options| run("coverage", options)),
    ("distbug", [2.0, 3.1], |options| run("distbug", options)),
    ("first_steps", [2.0, 3.1], |options| run("first_steps", options)),
    // It ends before the third second.
    ("localise", [1.0, 2.0], |options| run("localise", options)),
    ("maze_explore", [2.0, 3.1], |options| run("maze_explore", options)),
    ("maze_left", [2.0, 3.1], |options| run("maze_left", options)),
    ("maze_lidar", [2.0, 3.1], |options| run("maze_lidar", options)),
    ("micromouse", [2.0, 2.6], |options| run("micromouse", &[&["--explore"], options].concat())),
    ("motion", [2.0, 3.1], |options| run("motion", options)),
    ("navigate", [2.0, 3.1], |options| run("navigate", options)),
    ("omni", [2.0, 3.1], |options| run("omni", options)),
    ("random_drive", [2.0, 3.1], |options| run("random_drive", options)),
    ("second car", [2.0, 3.1], |options| run("cone_race", &[&OVAL, &["--other"][..], options].concat())),
    ("wall_following", [2.0, 3.1], |options| run("wall_following", options)),
];

/// Whether a stop violates the requirements: a correct cause, a reaction one control period after the fault
/// can be noticed, and distances within the bounds, both from the start of the stop and from the fault.
fn wrong(stop: &Value, fault: &Wrong) -> bool {
    let number = |field: &str| stop[field].as_f64().unwrap_or(f64::NAN);
    let seen = stop["causes"].as_array().is_some_and(|seen| {
        seen.iter().any(|seen| seen.as_str().is_some_and(|seen| fault.causes.contains(&seen)))
    });
    let fastest = number("fastest_mm_s");
    let noticed = (fault.noticed)(0.001 * number("rolling_mm_s"));
    let prompt = number("time_s") - number("fault_s") <= noticed + PERIOD + 1e-6;
    let within = number("stop_mm") <= number("bound_mm") + 1.0;
    // The robot continues until the fault is noticed and answered; its distance is measured from the look
    // before the fault. During a hanging call the robot stops by itself, also from the look before.
    let unnoticed = if fault.fault.starts_with("hang") { 0.0 } else { noticed + PERIOD };
    let in_all = number("since_fault_mm") <= fastest * (unnoticed + PERIOD) + number("bound_mm") + 1.0;
    !(stop["state"] == "SafeStop" && seen && stop["stood"] == true && prompt && within && in_all)
}

/// Violations by the stops of a program after every fault at a time.
fn failures(name: &str, time: f64, drive: Drive) -> Vec<String> {
    let limit = (time + 3.0).to_string();
    let mut failures = Vec::new();
    for fault in &FAULTS {
        // It stands at that time, so stuck odometry is correct.
        if name == "motion" && fault.fault == "stuck" {
            continue;
        }
        let text = format!("{}@{time}", fault.fault);
        let (_, report, err) = drive(&["--supervised", "--fault", &text, "--time-limit", &limit]);
        if wrong(&report["safety"][0], fault) {
            failures.push(format!("{name} {text}: {} {err}", report["safety"]));
        }
    }
    failures
}

/// Whatever fails, and whatever the program does then, the robot stops within the proved distance.
#[test]
fn every_robot_stands_after_every_fault() {
    let mut found = Vec::new();
    for (name, times, drive) in PROGRAMS {
        for time in times {
            found.extend(failures(name, time, drive));
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// At maximum speed, on the racing line of its second lap.
#[test]
fn a_car_that_races_stands_after_every_fault() {
    let found = failures("cone_race", 29.0, |options| {
        run("cone_race", &[&OVAL, &["--laps", "2"][..], options].concat())
    });
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// At maximum speed, through an explored maze.
#[test]
fn a_mouse_that_races_stands_after_every_fault() {
    let (_, report, err) = run("micromouse", &["--supervised"]);
    assert!(report["outcome"] == "raced" && report["safety"][0]["state"].is_null(), "{report} {err}");
    let [explored, raced] = ["exploration_s", "fast_run_s"].map(|field| report[field].as_f64().unwrap());
    let time = ((explored + 0.4 * raced) * 100.0).round() / 100.0;
    let found = failures("micromouse", time, |options| run("micromouse", options));
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// No program is silent while it drives, or has sensors that seem faulty.
#[test]
fn without_a_fault_nothing_stops_any_program() {
    for (name, _, drive) in PROGRAMS {
        let (_, report, err) = drive(&["--supervised", "--time-limit", "20"]);
        for stop in report["safety"].as_array().unwrap() {
            // Once its world has ended, nobody answers.
            let ended = stop["time_s"].as_f64().is_some_and(|time| time >= 20.0);
            assert!(stop["state"].is_null() || ended, "{name}: {stop} {err}");
        }
    }
}

/// The wait for a robot is measured in its world's time: a fast car that brakes by itself takes some, during
/// failing waits.
#[test]
fn a_fast_car_without_a_link_is_seen_to_stand() {
    let (folder, files) = super::cones::events("supervised");
    for time in ["3.3", "3.9"] {
        let fault = format!("link@{time}");
        let options = ["--track", &files[0], "--supervised", "--fault", &fault];
        let (_, report, _) = run("cone_race", &options);
        let stop = &report["safety"][0];
        assert!(stop["fastest_mm_s"].as_f64().unwrap() > 15_000.0, "{report}");
        assert!(!wrong(stop, &FAULTS[5]), "{report}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// These commands have no supervised robots and say so: a safety system lets time pass for its robot, but
/// here several robots share one thread, or the runs are too many for anyone to ask how each one stopped.
#[test]
fn commands_without_a_supervised_robot_say_so() {
    let programs: [(&str, Drive); 4] = [
        // Many robots, each in its own world.
        ("bug_compare", |options| run("bug_compare", options)),
        // Stepped as a fleet in one thread.
        ("follow_me", |options| run("follow_me", options)),
        ("random_drive", |options| run("random_drive", &[&["--robots", "3"], options].concat())),
        // Many runs on all cores.
        ("a_to_b", |options| run("a_to_b", &[&["--campaign", "--runs", "1"], options].concat())),
    ];
    for (name, drive) in programs {
        let (status, _, err) = drive(&["--supervised", "--time-limit", "2"]);
        assert!(status == 2 && err.contains("--supervised: "), "{name}: {status} {err}");
    }
}

#[test]
fn without_a_fault_nothing_stops_them() {
    let (status, report, err) = run("a_to_b", &["--supervised"]);
    assert_eq!((status, report["outcome"].as_str(), err.as_str()), (0, Some("reached"), ""), "{report}");
    assert_eq!(report["safety"][0]["state"], Value::Null, "{report}");
}

/// Time within which an event must be answered (ms): a period after the heartbeat was missing for 0.5 s, or
/// the program for 0.4 s from its next step of 50 ms; or a period.
fn allowed(event: &Value) -> f64 {
    match event.as_str() {
        Some("radio") => 520.0,
        Some("hang") => 470.0,
        _ => 20.0,
    }
}

/// All kinds of stops in turn, with rearming and restarting in between.
#[test]
fn a_car_is_stopped_and_set_going_again() {
    for noise in ["0", "1"] {
        let (status, report, err) = run("safety", &["--noise", noise]);
        assert_eq!((status, report["outcome"].as_str(), err.as_str()), (0, Some("stood"), ""), "{report}");
        let stops = report["stops"].as_array().unwrap();
        let takeovers = report["takeovers"].as_array().unwrap();
        let events: Vec<&str> = takeovers.iter().map(|answer| answer["event"].as_str().unwrap()).collect();
        assert_eq!(events, ["pedal", "wheel"], "{report}");
        for answer in takeovers.iter().chain(stops).filter(|answer| answer["event"].is_string()) {
            assert!(answer["reaction_ms"].as_f64().unwrap() <= allowed(&answer["event"]), "{answer}");
        }
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

/// A car that is out of reach or hangs stops by itself, and the command reports its distance.
#[test]
fn a_car_that_nobody_talks_to_stops() {
    for (fault, causes) in [("link@3", &["link"][..]), ("hang=20@3", &["watchdog", "clock"])] {
        let (_, report, _) = run("safety", &[&OVAL, &["--fault", fault, "--time-limit", "27"][..]].concat());
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

/// When the first one waits, time passes for both.
#[test]
fn both_cars_of_a_race_are_supervised() {
    let (status, report, err) =
        run("cone_race", &[&OVAL, &["--other", "--supervised", "--laps", "1"][..]].concat());
    assert_eq!((status, err.as_str()), (0, ""), "{report}");
    for stop in report["safety"].as_array().unwrap() {
        assert!(stop["state"].is_null() && stop["bound_mm"].as_f64().unwrap() < 1e4, "{report}");
    }
    assert_eq!(report["safety"].as_array().unwrap().len(), 2);
}

/// A speed measurement error lengthens a stop, and its bound accounts for it.
#[test]
fn stops_are_within_their_bounds_whatever_the_noise() {
    for noise in ["3", "5"] {
        let options = ["--noise", noise, "--event", "radio", "--event", "hang", "--time-limit", "40"];
        let (_, report, err) = run("safety", &options);
        assert_eq!((report["outcome"].as_str(), err.as_str()), (Some("stood"), ""), "{report}");
    }
}

/// The driver gets control, and nothing else is reported as a stop.
#[test]
fn the_driver_is_answered() {
    let (status, report, err) = run("safety", &["--event", "wheel", "--event", "pedal"]);
    assert_eq!((status, report["outcome"].as_str(), err.as_str()), (0, Some("stood"), ""), "{report}");
    assert_eq!(report["stops"].as_array().map(Vec::len), Some(0), "{report}");
    let takeovers = report["takeovers"].as_array().unwrap();
    assert_eq!(takeovers.len(), 2, "{report}");
    for (answer, event) in takeovers.iter().zip(["wheel", "pedal"]) {
        assert!(answer["event"] == event && answer["state"] == "Manual", "{report}");
        assert!(
            answer["causes"][0] == "driver" && answer["reaction_ms"].as_f64().unwrap() <= 20.0,
            "{report}"
        );
    }
}

/// Nobody confirms a sensor that is still late, so the car keeps standing; a sensor that was late is
/// confirmed.
#[test]
fn a_sensor_that_stays_late_keeps_the_car_standing() {
    for (fault, seed) in
        [("late:lidar=1@6", "1"), ("late:lidar=1@6", "4"), ("late=1@6", "1"), ("late=1@6", "2")]
    {
        let options = ["--fault", fault, "--event", "button", "--time-limit", "20", "--seed", seed];
        let (_, report, _) = run("safety", &options);
        // It brakes without knowing the lane, so a cone may be in its way: only the distance is guaranteed.
        assert_ne!(report["outcome"], "stood", "{report}");
        let stop = &report["stops"][0];
        let [driven, bound] = ["distance_m", "bound_m"].map(|field| stop[field].as_f64().unwrap());
        assert!(driven <= bound, "{report}");
        let states: Vec<&str> =
            report["states"].as_array().unwrap().iter().map(|state| state[1].as_str().unwrap()).collect();
        assert_eq!(states, ["Manual", "Armed", "Auto", "SafeStop"], "{report}");
    }
    let options = ["--fault", "late:lidar=1@6-7", "--event", "button", "--time-limit", "40"];
    let (_, report, _) = run("safety", &options);
    assert_eq!(report["outcome"], "stood", "{report}");
}

#[test]
fn it_does_not_leave_its_fence() {
    let (_, report, err) = run("safety", &["--fence", "25", "--event", "wheel", "--time-limit", "30"]);
    assert_eq!(err, "", "{report}");
    let stop = &report["stops"][0];
    assert!(stop["state"] == "SafeStop" && stop["causes"][0] == "outside the fence", "{report}");
}

#[test]
fn options_without_a_meaning() {
    let (status, _, err) = run("safety", &["--supervised"]);
    assert!(status == 2 && err.contains("here the car always is"), "{err}");
}

#[test]
fn a_car_that_stays_out_of_reach_is_no_time_limit() {
    let (status, report, err) =
        run("safety", &[&OVAL, &["--fault", "link@1", "--time-limit", "30"][..]].concat());
    assert_eq!((status, report["outcome"].as_str()), (1, Some("failed")), "{report}");
    assert!(report["error"].as_str().unwrap().starts_with("the car is out of reach: "), "{report}");
    assert!(err.contains("link"), "{err}");
}
