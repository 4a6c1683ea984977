//! Commands drive the robot behind the library (`--robios`) as they drive the simulated one that rounds as
//! RoBIOS does (`--quantised`): the same calls with the same answers at the same times.
//!
//! The library is the one of this project. Its robot belongs to its process, so each run through it is a
//! process of its own.

use std::path::{Path, PathBuf};
use std::process::Command;

use roverlab::io::log::{Entry, Log};

use super::{roverlab, said};

/// The library, which is built as a dependency of this test.
fn library() -> PathBuf {
    let name = if cfg!(target_os = "macos") { "libeyesim.dylib" } else { "libeyesim.so" };
    let program = std::env::current_exe().unwrap();
    let folders = program.ancestors().skip(1).take(2);
    let found = folders.map(|folder| folder.join(name)).find(|file| file.is_file());
    found.unwrap_or_else(|| panic!("found no {name} beside {}", program.display()))
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

/// Runs a command both ways, in the same world with the same noise.
fn compare(words: &[&str]) {
    let name = words.join("-").replace("--", "");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("robios-{name}"));
    std::fs::create_dir_all(&folder).unwrap();
    let file = |name: &str| folder.join(name).display().to_string();
    let run = |more: &[&str]| {
        let mut command = roverlab(words);
        command.args(["--json", "--seed", "3", "--noise", "1"]).args(more);
        command
    };
    // A run that ends without a verdict has driven nevertheless.
    let drives = |mut command: Command| {
        let (status, said) = said(&mut command);
        assert!(status < 2, "{name}: {said}");
    };
    drives(run(&["--quantised", "--record", &file("direct.mcap")]));
    let direct = Log::read(std::fs::read(folder.join("direct.mcap")).unwrap()).unwrap();
    // The library's world is the recorded one.
    for attachment in &direct.header().attachments {
        if attachment.name.starts_with("scene.") {
            std::fs::write(folder.join(&attachment.name), &attachment.data).unwrap();
        }
    }
    let library = library().display().to_string();
    let mut through = run(&["--robios", &library, "--record", &file("library.mcap")]);
    through
        .env("ROBIOS_WORLD", folder.join("scene.sim"))
        .envs([
            ("ROBIOS_SEED", "3"),
            ("ROBIOS_NOISE", "1"),
            ("ROBIOS_KEYS", "NONE"),
            ("ROBIOS_CALL_COSTS", "free"),
        ])
        .env("ROBIOS_TIME_LIMIT", "100000");
    drives(through);
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
