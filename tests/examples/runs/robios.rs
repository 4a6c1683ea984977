//! The examples drive the robot behind the library (`--robios`) as they drive the simulated one that rounds as RoBIOS
//! does (`--quantised`): the same calls with the same answers at the same times.
//!
//! The library is the one of this project, `libeyesim`, if it has been built (`cargo build -p robios`, or the tests of the
//! whole workspace); without it these tests say so and pass. Its robot belongs to its process, so each run through it is a
//! process of its own: this test starts itself again.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{
    a_to_b, common, coverage, distbug, lidar_scan, micromouse, navigate, random_drive, wall_following,
};
use roverlab::io::log::{Entry, Log};

const JOB: &str = "EXAMPLES_JOB";

/// Runs an example. Returns its status, and what it said.
fn example(words: &[String]) -> (u8, String) {
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let line: Vec<OsString> = words.iter().map(OsString::from).collect();
    let (out_, err_): (&mut dyn std::io::Write, &mut dyn std::io::Write) = (&mut out, &mut err);
    let status = match words[0].as_str() {
        "a_to_b" => common::run("a_to_b", line, out_, err_, a_to_b::work),
        "coverage" => common::run("coverage", line, out_, err_, coverage::work),
        "distbug" => common::run("distbug", line, out_, err_, distbug::work),
        "lidar_scan" => common::run("lidar_scan", line, out_, err_, lidar_scan::work),
        "micromouse" => common::run("micromouse", line, out_, err_, micromouse::work),
        "navigate" => common::run("navigate", line, out_, err_, navigate::work),
        "random_drive" => common::run("random_drive", line, out_, err_, random_drive::work),
        _ => common::run("wall_following", line, out_, err_, wall_following::work),
    };
    (status, String::from_utf8(out).unwrap() + &String::from_utf8(err).unwrap())
}

/// What the tests below run in a process of its own.
#[test]
#[ignore = "run by the tests below, in processes of their own"]
fn child() {
    let Ok(job) = std::env::var(JOB) else { return };
    let words: Vec<String> = job.lines().map(str::to_owned).collect();
    let (status, said) = example(&words);
    println!("{said}");
    // A run that ends without a verdict has driven nevertheless.
    assert!(status < 2, "{said}");
}

/// The library, if it has been built with this test or before.
fn library() -> Option<PathBuf> {
    let name = if cfg!(target_os = "macos") { "libeyesim.dylib" } else { "libeyesim.so" };
    let program = std::env::current_exe().unwrap();
    let folders = program.ancestors().skip(1).take(2);
    let found = folders.map(|folder| folder.join(name)).find(|file| file.is_file());
    if found.is_none() {
        eprintln!("skipped: {name} has not been built");
    }
    found
}

fn calls(log: &Log) -> Vec<String> {
    let entries = log.entries(0).filter(|entry| !entry.truth);
    let lines = entries.map(|Entry { time, method, arguments, result, .. }| {
        // What an error says differs: the library has a code for it.
        let answer = result.unwrap_or_else(|_| "error".into());
        format!("{time} {method}({arguments}) {answer}")
    });
    lines.collect()
}

/// Runs an example both ways, in the same world with the same noise.
fn compare(words: &[&str]) {
    let Some(library) = library() else { return };
    let name = words.join("-").replace("--", "");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("examples-{name}"));
    std::fs::create_dir_all(&folder).unwrap();
    let file = |name: &str| folder.join(name).display().to_string();
    let with = |more: &[&str]| -> Vec<String> {
        words
            .iter()
            .chain(&["--json", "--seed", "3", "--noise", "1"])
            .chain(more)
            .map(|&word| word.to_owned())
            .collect()
    };
    let (status, said) = example(&with(&["--quantised", "--record", &file("direct.mcap")]));
    assert!(status < 2, "{name}: {said}");
    let direct = Log::read(std::fs::read(folder.join("direct.mcap")).unwrap()).unwrap();
    // The library's world is the recorded one.
    for attachment in &direct.header().attachments {
        if attachment.name.starts_with("scene.") {
            std::fs::write(folder.join(&attachment.name), &attachment.data).unwrap();
        }
    }
    let through = with(&["--robios", &library.display().to_string(), "--record", &file("library.mcap")]);
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "runs::robios::child", "--ignored", "--nocapture"])
        .env(JOB, through.join("\n"))
        .env("ROBIOS_WORLD", folder.join("scene.sim"))
        .envs([("ROBIOS_SEED", "3"), ("ROBIOS_NOISE", "1"), ("ROBIOS_KEYS", "NONE")])
        .env("ROBIOS_TIME_LIMIT", "100000")
        .output()
        .unwrap();
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stdout));
    let library = Log::read(std::fs::read(folder.join("library.mcap")).unwrap()).unwrap();
    let (mut direct, mut library) = (calls(&direct), calls(&library));
    // The time limit is the simulator's; the library's program goes on.
    if direct.last().is_some_and(|call| call.ends_with(" error")) {
        direct.pop();
        library.truncate(direct.len());
    }
    assert!(direct.len() > 20, "{name}: {} calls", direct.len());
    for (number, (found, expected)) in library.iter().zip(&direct).enumerate() {
        assert_eq!(found, expected, "{name}, call {} of {}", number + 1, direct.len());
    }
    assert_eq!(library.len(), direct.len(), "{name}");
}

#[test]
fn driving_to_a_point() {
    compare(&["a_to_b", "--method", "turn"]);
    compare(&["a_to_b", "--method", "arc"]);
    compare(&["a_to_b", "--method", "dog"]);
}

#[test]
fn driving_without_a_goal() {
    compare(&["random_drive", "--time-limit", "40"]);
    compare(&["coverage", "--time-limit", "60"]);
    compare(&["wall_following", "--time-limit", "60"]);
    compare(&["lidar_scan", "--time-limit", "20"]);
}

#[test]
fn finding_a_way() {
    compare(&["distbug"]);
    compare(&["navigate"]);
    compare(&["micromouse", "--time-limit", "120"]);
}
