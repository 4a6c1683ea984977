//! Options unsupported by a run: none is ignored silently.

use super::support::{DATA, said};
use crate::commands::COMMANDS;

/// A misspelt name in a table would reject nothing.
#[test]
fn tables_name_options_of_their_commands() {
    for command in COMMANDS {
        let known = command.options();
        for (when, options) in (command.unheeded)() {
            let conditions = when.split('&').map(|part| part.trim_start_matches('!'));
            let conditions = conditions.map(|part| part.split(['!', '=']).next().unwrap());
            for id in conditions.filter(|&id| id != "always").chain(options.iter().copied()) {
                assert!(known.iter().any(|name| name == id), "{}: no option {id}", command.name);
            }
        }
    }
}

#[test]
fn options_without_a_meaning_are_refused() {
    let (room, maze) = (format!("{DATA}/formats/room.pgm"), format!("{DATA}/mazes"));
    let cases = [
        ("a-to-b --campaign --noise 0", "--noise: has no meaning with --campaign"),
        ("a-to-b --campaign --goal 900,900", "--goal: has no meaning with --campaign"),
        ("a-to-b --runs 5", "--runs: has no meaning without --campaign"),
        ("a-to-b --method arc --scale 2", "--scale: has no meaning where --method is turn or arc or dog"),
        ("bug-compare --quantised", "--quantised: has no meaning here"),
        ("camera --goal 900,900", "--goal: has no meaning here"),
        ("coverage --campaign --picture a.svg", "--picture: has no meaning with --campaign"),
        ("edges --kernel laplace --low 7", "--low: has no meaning unless --kernel is canny or"),
        (&format!("edges --input {room} --noise 0"), "--noise: has no meaning with --input"),
        ("follow-me --campaign --mode chain", "--mode: has no meaning with --campaign"),
        ("follow-me --quantised", "--quantised: found several robots"),
        ("genetic --noise 0", "--noise: has no meaning where --task is spline"),
        (&format!("grid-benchmark --seed 2 --map {room} --scen {room}"), "--seed: has no meaning with --map"),
        ("localise --campaign --realtime", "--realtime: has no meaning with --campaign"),
        (&format!("micromouse --campaign {maze} --fault stuck@1"), "--fault: has no meaning with --campaign"),
        ("micromouse --patience 5", "--patience: has no meaning without --mms-run"),
        ("motion --campaign --still", "--still: has no meaning with --campaign"),
        ("navigate --threads 2", "--threads: has no meaning without --campaign"),
        ("omni --spin 20", "--spin: has no meaning where --task is square"),
        ("safety --goal 900,900", "--goal: has no meaning for a race"),
        ("starman --steps --init uniform", "--init: has no meaning with --steps"),
        ("wall-following --campaign --world a.wld", "--world: has no meaning with --campaign"),
    ];
    for (line, message) in cases {
        let words: Vec<&str> = line.split(' ').collect();
        let (status, out, err) = said(words[0], &words[1..]);
        assert_eq!((status, out.as_str(), err.lines().count()), (2, "", 1), "{line}: {err}");
        assert!(err.contains(message), "{line}: {err}");
    }
}
