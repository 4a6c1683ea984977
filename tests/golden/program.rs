//! Prints the digests of the runs that `tests/golden` keeps, one line each: `cargo run -p roverlab-oracles`.
//! With a scenario's name, prints that run's log: `cargo run -p roverlab-oracles arcs`. For platforms without
//! a test harness.

mod scenarios;

use std::process::ExitCode;

use scenarios::{Scenario, digest, scenarios};

fn main() -> ExitCode {
    let name = std::env::args().nth(1);
    let asked = |scenario: &&Scenario| name.as_ref().is_none_or(|name| name == scenario.name);
    let mut status = if scenarios().any(|scenario| asked(&scenario)) { 0 } else { 2 };
    for scenario in scenarios().filter(asked) {
        if let Some(reason) = scenario.lacks() {
            eprintln!("{}: left out, {reason}", scenario.name);
            continue;
        }
        match scenario.log() {
            Ok(log) if name.is_some() => print!("{log}"),
            Ok(log) => println!("{} {:016x}", scenario.name, digest(&log)),
            Err(error) => {
                eprintln!("{}: {error}", scenario.name);
                status = 1;
            }
        }
    }
    if status == 2 {
        let names: Vec<&str> = scenarios().map(|scenario| scenario.name).collect();
        eprintln!("no such scenario; expected one of {}", names.join(", "));
    }
    ExitCode::from(status)
}
