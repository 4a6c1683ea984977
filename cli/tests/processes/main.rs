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

/// Every way in which a world is read warns of a wall far from all the rest.
#[test]
fn a_stray_wall_is_warned_of_by_whatever_reads_the_world() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let room = "0 0 3000 0\n3000 0 3000 2000\n3000 2000 0 2000\n0 2000 0 0\n1000000 0 1000000 1000\n";
    std::fs::write(folder.join("stray.wld"), format!("{room}position 600 500 20\n")).unwrap();
    // A slope that rises to the right.
    let row = (0..61).map(|height| height.to_string()).collect::<Vec<_>>().join(" ");
    let grid = "ncols 61\nnrows 41\nxllcorner 0\nyllcorner 0\ncellsize 50\n".to_owned();
    std::fs::write(folder.join("stray.asc"), grid + &format!("{row}\n").repeat(41)).unwrap();
    let hills = format!("terrain 3000 2000 100 stray.asc\n{room}position 600 500 20\n");
    std::fs::write(folder.join("stray_hills.wld"), hills).unwrap();
    let campaign = ["localise", "--campaign", "--starts", "1", "--patience", "1", "--world", "stray.wld"];
    for words in [
        &["random-drive", "--time-limit", "1", "--world", "stray.wld"][..],
        &["follow-me", "--time-limit", "1", "--world", "stray.wld"],
        &["terrain-plan", "--world", "stray_hills.wld", "--goal", "2000,1000"],
        &campaign,
    ] {
        let (_, text) = said(roverlab(words).current_dir(folder));
        assert!(text.contains("reach far out of the rest") && text.contains(": 1;"), "{words:?}: {text}");
    }
}
