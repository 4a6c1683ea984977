//! The program `roverlab` as a process: its warnings, robots behind the library of RoBIOS, runs that are
//! killed, campaigns in parts, workers of evolution, and the page.

#[cfg(feature = "native")]
mod grade;
mod killed;
mod parts;
mod robios;
#[cfg(feature = "native")]
mod tasks;
#[cfg(feature = "view")]
mod view;
#[cfg(feature = "native")]
mod workers;

use std::path::Path;
use std::process::Command;

/// The program with some words on its command line.
fn roverlab(words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_roverlab"));
    command.args(words);
    command
}

/// Runs it to its end. Returns its status, and what it said.
fn said(command: &mut Command) -> (i32, String) {
    let output = command.output().unwrap();
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).concat();
    (output.status.code().unwrap_or(-1), text)
}

/// A robot whose 3D model is missing drives, with a warning.
#[test]
fn a_missing_model_is_warned_of() {
    let robot = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/formats/cart.robi");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let bare = folder.join("bare.robi");
    std::fs::write(&bare, std::fs::read_to_string(robot).unwrap().replace("cart.obj", "nowhere.obj"))
        .unwrap();
    let (status, text) = said(roverlab(&["a_to_b", "--robot", bare.to_str().unwrap()]).current_dir(folder));
    assert!(status == 0 && text.contains("bare.robi:3:") && text.contains("nowhere.obj"), "{text}");
}
