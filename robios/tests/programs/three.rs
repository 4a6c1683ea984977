//! Three robots drive about in one room and back up before obstacles and each other (book, section 3.7): with
//! three programs, and with one that asks for the robot's number, in C and in Python.

use std::fs;

use serde_json::Value;

use super::{Folder, compiled, compiler, programs, python, report};

const SCRIPTS: [&str; 4] = ["three", "by_number", "three_python", "by_number_python"];

/// A copy of the programs, those in C compiled.
fn folder(name: &str) -> Folder {
    let folder = Folder::new(name);
    for entry in fs::read_dir(programs().join("three")).unwrap() {
        let file = entry.unwrap().path();
        fs::copy(&file, folder.0.join(file.file_name().unwrap())).unwrap();
    }
    for program in ["left_right", "middle_line", "anywhere", "by_number"] {
        compiled(&folder.0.join(program).with_extension("c"));
    }
    folder
}

/// Runs a script for some seconds.
fn run(folder: &Folder, script: &str, seed: u64, seconds: u32) -> Value {
    let script = folder.0.join(script).with_extension("sim");
    let (seed, limit) = (seed.to_string(), (seconds + 20).to_string());
    let options = ["--seed", &seed, "--noise", "1", "--time-limit", &limit, "--real-limit", "600"];
    report(&[&options[..], &[script.to_str().unwrap(), &seconds.to_string()]].concat())
}

/// All robots have driven and touched nothing.
fn assert_untouched(report: &Value, script: &str, seed: u64, least: f64) {
    assert_eq!(report["outcome"], "finished", "{script}, seed {seed}: {report}");
    for robot in report["robots"].as_array().unwrap() {
        let length = robot["path_length_mm"].as_f64().unwrap();
        assert!(length > least && robot["collisions"] == 0, "{script}, seed {seed}: {robot}");
    }
}

#[test]
fn three_robots_back_up_before_each_other() {
    if !compiler() || !python() {
        return;
    }
    let folder = folder("three");
    for (script, seed) in SCRIPTS.into_iter().zip(1..) {
        let all = run(&folder, script, seed, 60);
        assert_untouched(&all, script, seed, 2500.0);
        // Who they are decides what they do: the first keeps its y, the second its x.
        let place = |robot: usize, axis: &str| all["robots"][robot]["pose"][axis].as_f64().unwrap();
        assert!((place(0, "y_mm") - 700.0).abs() < 300.0, "{script}: {all}");
        assert!((place(1, "x_mm") - 1500.0).abs() < 200.0, "{script}: {all}");
    }
}

mod campaigns {
    use super::*;

    #[test]
    #[ignore = "a campaign: cargo test --release -p robios --test programs three::campaigns -- --ignored"]
    fn a_hundred_times_five_minutes_without_a_contact() {
        let folder = folder("three-campaign");
        let (mut contacts, mut metres) = (0, 0.0);
        for seed in 1..=100 {
            let script = SCRIPTS[seed as usize % SCRIPTS.len()];
            let all = run(&folder, script, seed, 300);
            for robot in all["robots"].as_array().unwrap() {
                contacts += robot["collisions"].as_u64().unwrap();
                metres += robot["path_length_mm"].as_f64().unwrap() / 1000.0;
            }
            assert_untouched(&all, script, seed, 10_000.0);
        }
        println!("100 runs of 5 minutes: {metres:.0} m, {contacts} contacts");
        assert_eq!(contacts, 0);
    }
}
