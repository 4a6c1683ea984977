//! The runner: command line, programs, their processes, their shared world, and the report.

mod children;
mod compiler;
mod host;
mod install;
mod options;
mod panels;
mod picture;
mod place;
mod programs;
mod stopwatch;

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use clap::Parser;

use crate::verdict::{self, Summary, Verdict};
use options::{Command, Options};
pub use place::Place;
use roverlab::files::TemporaryFolder;
use roverlab_view::serve::{Beside, Opening};
use stopwatch::Stopwatch;

/// Exit status for a wrong command line or input file.
const WRONG: u8 = 2;

/// The program `robios`: runs the command line of this process.
pub fn main() -> ExitCode {
    ExitCode::from(main_of(std::env::args_os().collect()))
}

/// The same within another program, from a place of its own. Returns the exit status.
pub fn main_at(place: Place, words: Vec<OsString>) -> u8 {
    place::set(place);
    main_of(words)
}

/// Parses a command line, of which the first word is the program's name, runs the programs and prints the
/// report. Exit status 0: every program ended properly; 1: one did not, or touched something; 2: the command
/// line or a file is wrong.
fn main_of(words: Vec<OsString>) -> u8 {
    let mut warnings = Vec::new();
    let wants_json = words.iter().any(|word| word == "--json");
    let options = match Options::try_parse_from(words) {
        Ok(options) => options,
        Err(error) if !error.use_stderr() => {
            let _ = write!(std::io::stdout(), "{}", error.render());
            return 0;
        }
        // What cannot be parsed still says whether JSON is wanted.
        Err(error) => return refuse(wants_json, &in_one_line(&error), &[]),
    };
    let done = match options.command() {
        Command::Install(folder) => install::install(&folder).map(|()| None),
        Command::Compile(source, program) => programs::compile_to(&source, &program).map(|()| None),
        Command::Run => run(&options, &mut warnings).map(Some),
    };
    match done {
        Ok(None) => 0,
        Ok(Some(summary)) => {
            let text = if options.json { summary.json() } else { summary.words() };
            // A reader that has closed the pipe is not a failure.
            let _ = writeln!(std::io::stdout(), "{text}");
            summary.status()
        }
        Err(message) => refuse(options.json, &message, &warnings),
    }
}

/// Reports what could not start, with --json as an object too.
fn refuse(json: bool, message: &str, warnings: &[String]) -> u8 {
    if json {
        // A reader that has closed the pipe is told by the status.
        let _ = writeln!(std::io::stdout(), "{}", verdict::refusal(message, warnings));
    }
    // Without standard error nobody can be informed; the status remains.
    let _ = writeln!(std::io::stderr(), "{message}");
    WRONG
}

/// The error of a command line in one line.
fn in_one_line(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let lines = text.lines().map(str::trim).take_while(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join(" ").trim_start_matches("error: ").to_owned()
}

/// Adds warnings to the report and to standard error, each once.
fn warn(warnings: &mut Vec<String>, more: impl IntoIterator<Item = String>) {
    for warning in more {
        if !warnings.contains(&warning) {
            let _ = writeln!(std::io::stderr(), "{warning}");
            warnings.push(warning);
        }
    }
}

/// Runs the programs, and collects warnings about the files.
fn run(options: &Options, warnings: &mut Vec<String>) -> Result<Summary, String> {
    let stopwatch = Stopwatch::start();
    let plan = options.plan()?;
    let (scene, odd) = plan.scene()?;
    warn(warnings, odd);
    if options.cpu_time > 0.0 {
        warn(
            warnings,
            ["--cpu-time: what a program computes is charged, so runs are not reproducible".into()],
        );
    }
    let folder = TemporaryFolder::new("robios-").map_err(|error| error.to_string())?;
    let programs = programs::of(options, &scene, &folder)?;
    warn(warnings, programs.iter().filter_map(|program| program.warning.clone()));
    let page = options.view.map(|port| page(options, port)).transpose()?;
    let watched =
        page.is_some() || options.picture.is_some() || options.record.is_some() || options.trail.is_some();
    let own_world = programs.len() == 1 && !watched;
    let verdicts = if own_world {
        children::run_alone(&programs[0], &plan, &scene, options, &folder)
    } else {
        host::run_together(&programs, &plan, &scene, options, &folder, page.as_ref())
    };
    if let (Some(page), Err(message)) = (&page, &verdicts) {
        page.ended(WRONG, "", message);
    }
    let mut verdicts = verdicts?;
    verdict::name_deadlocks(&mut verdicts);
    warn(warnings, verdicts.iter().flat_map(Verdict::warnings));
    let (warnings, wall_time) = (std::mem::take(warnings), options.timing.then(|| stopwatch.seconds()));
    let summary = Summary { verdicts, warnings, seed: plan.seed, noise: plan.noise, wall_time };
    if let Some(page) = page {
        page.ended(summary.status(), &summary.words(), "");
    }
    Ok(summary)
}

/// The page beside the programs. Prints its address.
fn page(options: &Options, port: u16) -> Result<Beside, String> {
    let command = format!("robios {}", options.program.display());
    let page = Beside::open(&Opening { port, command })
        .map_err(|error| format!("--view={port}: {error}; expected a free port, or none"))?;
    // In one piece, for programs that read it. Without standard error nobody can be informed.
    let _ = std::io::stderr().write_all(format!("view: {}\n", page.address()).as_bytes());
    Ok(page)
}
