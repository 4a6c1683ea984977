//! The program `roverlab` as a process: robots behind the library of RoBIOS, runs that are killed, and the page.

mod killed;
mod robios;
#[cfg(feature = "view")]
mod view;

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
