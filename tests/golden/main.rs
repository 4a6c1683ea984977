//! The same seed gives the same log, byte for byte: in debug and release, on every platform, and for robots
//! in threads however these are scheduled. The digests of whole runs of every system stand in `digests.txt`.
//!
//! `REGENERATE=1 cargo test --all-features --test golden` writes that file anew, after a change that is meant
//! to change runs. `cargo run -p roverlab-oracles NAME` prints a run's log, to see where two of them part.

mod scenarios;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::time::Duration;

use roverlab::random::Stream;
use scenarios::simulator::threads;
use scenarios::{digest, scenarios};

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/digests.txt");

const HEADER: &str = "# FNV-1a digests of the logs of scenarios, written by\n\
                      # REGENERATE=1 cargo test --all-features --test golden\n";

/// The digests of a file by their names.
fn parse(text: &str) -> BTreeMap<&str, &str> {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines
        .map(|line| line.split_once(' ').unwrap_or_else(|| panic!("{line}: expected a name and a digest")))
        .collect()
}

/// The lines of a file for the runs as they are on this platform.
fn found() -> String {
    let mut text = HEADER.to_owned();
    for scenario in scenarios().filter(|scenario| scenario.lacks().is_none()) {
        let log = scenario.log().unwrap_or_else(|error| panic!("{}: {error}", scenario.name));
        writeln!(text, "{} {:016x}", scenario.name, digest(&log)).unwrap();
    }
    text
}

/// One line for each name whose digest is not as expected.
fn differences(expected: &str, found: &str) -> Vec<String> {
    let (expected, found) = (parse(expected), parse(found));
    let names: BTreeSet<&str> = expected.keys().chain(found.keys()).copied().collect();
    let digest =
        |of: &BTreeMap<&str, &str>, name| of.get(name).map_or("none".to_owned(), ToString::to_string);
    names
        .into_iter()
        .filter(|name| expected.get(name) != found.get(name))
        .map(|name| format!("{name}: expected {}, found {}", digest(&expected, name), digest(&found, name)))
        .collect()
}

#[test]
fn logs_have_their_golden_digests() {
    let found = found();
    let left_out: Vec<&str> = scenarios().filter(|one| one.lacks().is_some()).map(|one| one.name).collect();
    if std::env::var_os("REGENERATE").is_some_and(|value| value == "1") {
        assert!(left_out.is_empty(), "this build leaves out {left_out:?}; expected --all-features");
        fs::write(FILE, found).unwrap();
        return;
    }
    let expected = fs::read_to_string(FILE).unwrap_or_else(|error| panic!("{FILE}: {error}"));
    let is_run = |line: &&str| !left_out.iter().any(|name| line.starts_with(&format!("{name} ")));
    let expected = expected.lines().filter(is_run).collect::<Vec<_>>().join("\n");
    let differences = differences(&expected, &found);
    assert!(
        differences.is_empty(),
        "logs have changed:\n{}\nIf they were meant to: REGENERATE=1 cargo test --all-features --test golden",
        differences.join("\n")
    );
}

/// Says so where a build leaves scenarios out.
#[test]
#[cfg_attr(
    not(all(feature = "log", feature = "petgraph", feature = "physics", feature = "picture")),
    ignore = "some scenarios need features: cargo test --all-features --test golden"
)]
fn no_scenario_is_left_out() {
    assert!(scenarios().all(|scenario| scenario.lacks().is_none()));
}

#[test]
fn every_scenario_has_a_name_of_its_own() {
    let names: Vec<&str> = scenarios().map(|scenario| scenario.name).collect();
    assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len(), "{names:?}");
}

#[test]
fn a_difference_names_scenario_and_digests() {
    let expected = "# comment\nsame 0000000000000001\nother 0000000000000002\ngone 0000000000000003\n";
    let found = "same 0000000000000001\nother 00000000000000ff\nnew 0000000000000004\n";
    assert_eq!(
        differences(expected, found),
        [
            "gone: expected 0000000000000003, found none",
            "new: expected none, found 0000000000000004",
            "other: expected 0000000000000002, found 00000000000000ff",
        ]
    );
}

/// A way to upset the scheduler: called by each robot's thread before each of its steps.
type Disturbance = fn(usize, u32);

const DISTURBANCES: [(&str, Disturbance); 3] = [
    ("yields", |robot, step| (0..(robot as u32 * 7 + step) % 5).for_each(|_| std::thread::yield_now())),
    ("early robots sleep", |robot, _| std::thread::sleep(Duration::from_micros(400 >> robot))),
    ("naps by chance", |robot, step| {
        let microseconds = Stream::new(u64::from(step)).child("nap", robot as u64).below(300);
        std::thread::sleep(Duration::from_micros(microseconds as u64));
    }),
];

#[test]
fn one_to_eight_threads_give_one_log_however_they_are_scheduled() {
    for robots in 1..=8 {
        let calm = threads(robots, |_, _| {}).unwrap();
        for (name, disturb) in DISTURBANCES {
            let disturbed = threads(robots, disturb).unwrap();
            let parting = calm.lines().zip(disturbed.lines()).find(|(a, b)| a != b);
            assert!(calm == disturbed, "{robots} robots, {name}: the logs part at {parting:?}");
        }
    }
}

#[test]
fn the_number_of_robots_changes_the_log() {
    assert_ne!(threads(7, |_, _| {}).unwrap(), threads(8, |_, _| {}).unwrap());
}
