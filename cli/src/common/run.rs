use std::ffi::OsString;
use std::io::{self, Write};

use clap::error::{ContextKind, ContextValue, ErrorKind};

use super::command_line::{self, Refusal};
use super::outputs::check_outputs;
use super::report::{Header, rounded};
use super::wall_clock::Stopwatch;
use super::{CommonArgs, Failure, Heeds, PlainArgs, Report, heed};

/// Runs a command: reads the command line, does the work, prints the report or one message. Returns the exit
/// status, which says how it went. 0: the behaviour came to a verdict; 1: it failed; 2: the command line or
/// an input file is wrong.
pub(crate) fn run<A>(
    command: &'static str,
    command_line: impl IntoIterator<Item = OsString>,
    out: &mut dyn Write,
    err: &mut dyn Write,
    work: impl FnOnce(&A) -> Result<Report, Failure>,
) -> u8
where
    A: clap::Parser + AsRef<CommonArgs> + Heeds,
{
    let args = match command_line::parse(command, command_line) {
        Ok(args) => Ok(args),
        Err(Refusal::Parser(error)) => Err(error),
        Err(Refusal::Files(failure)) => return complain(err, &failure),
    };
    run_parsed(args, out, err, |args: &A| {
        let common = args.as_ref();
        let stopwatch = Stopwatch::start();
        common.check()?;
        completed(command, common, stopwatch, work(args)?)
    })
}

/// The report of a command, with what is told of all of them.
fn completed(
    command: &'static str,
    common: &CommonArgs,
    stopwatch: Stopwatch,
    mut report: Report,
) -> Result<Printed, Failure> {
    common.origin.tell_warnings();
    report.add_trouble(common.origin.take_trouble());
    let safety = common.origin.stops().take();
    common.check_supervised(safety.is_some())?;
    if let Some(safety) = safety {
        report = report.field("safety", safety);
    }
    common.check_recorded()?;
    report.timing.insert(0, ("wall_time_s", rounded(stopwatch.seconds())));
    let (seed, timing) = (common.seed, common.timing);
    let noise = (!report.mixed_noise).then_some(common.noise);
    Ok(report.printed(Header { command, seed, noise, timing }, common.json))
}

/// As [`run`], for a command that drives no robot.
pub(crate) fn run_plain<A: clap::Parser + AsRef<PlainArgs> + Heeds>(
    command: &'static str,
    command_line: impl IntoIterator<Item = OsString>,
    out: &mut dyn Write,
    err: &mut dyn Write,
    work: impl FnOnce(&A) -> Result<Report, Failure>,
) -> u8 {
    run_printing(command, command_line, out, err, |args: &A| {
        let stopwatch = Stopwatch::start();
        let mut report = work(args)?;
        report.timing.insert(0, ("wall_time_s", rounded(stopwatch.seconds())));
        let &PlainArgs { seed, json, timing, .. } = args.as_ref();
        Ok(report.printed(Header { command, seed, noise: None, timing }, json))
    })
}

/// The parser of a command's command line, with the name that it has there.
pub(crate) fn parser<A: clap::CommandFactory>(name: &str) -> clap::Command {
    let shown = name.replace('_', "-");
    // What is missing on a command line is told, as all that is wrong with one.
    A::command().bin_name(format!("roverlab {shown}")).name(shown).arg_required_else_help(false)
}

/// What is left to be printed when a program's work is done.
#[derive(Debug)]
pub(crate) struct Printed {
    /// For standard output.
    pub(crate) text: String,
    /// For standard error.
    pub(crate) message: Option<String>,
    /// The exit status.
    pub(crate) status: u8,
}

/// As [`run`], for a program with options and a report of its own.
pub(crate) fn run_printing<A: clap::Parser + Heeds>(
    name: &str,
    command_line: impl IntoIterator<Item = OsString>,
    out: &mut dyn Write,
    err: &mut dyn Write,
    work: impl FnOnce(&A) -> Result<Printed, Failure>,
) -> u8 {
    let matches = match parser::<A>(name).try_get_matches_from(command_line) {
        Ok(matches) => matches,
        Err(error) => return run_parsed(Err::<A, _>(error), out, err, work),
    };
    match check_outputs(&matches).and_then(|()| heed::check(&matches, A::UNHEEDED, |_| true)) {
        Ok(()) => run_parsed(A::from_arg_matches(&matches), out, err, work),
        Err(failure) => complain(err, &failure),
    }
}

/// Does the work of a command line that has been read, or says what is wrong with it.
fn run_parsed<A>(
    args: Result<A, clap::Error>,
    out: &mut dyn Write,
    err: &mut dyn Write,
    work: impl FnOnce(&A) -> Result<Printed, Failure>,
) -> u8 {
    match args {
        Ok(args) => ended(work(&args), out, err),
        Err(error) => refused(&error, out, err),
    }
}

/// Prints what came of a command's work. Returns the exit status.
fn ended(printed: Result<Printed, Failure>, out: &mut dyn Write, err: &mut dyn Write) -> u8 {
    match printed {
        Err(failure) => complain(err, &failure),
        Ok(printed) => {
            if let Some(message) = printed.message {
                // Without standard error there is nobody left to tell; the status still does.
                let _ = writeln!(err, "{message}");
            }
            written(writeln!(out, "{}", printed.text), err, printed.status)
        }
    }
}

/// Says what is wrong with a command line, or shows the help that it asks for. Returns the exit status.
pub(crate) fn refused(error: &clap::Error, out: &mut dyn Write, err: &mut dyn Write) -> u8 {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        return written(write!(out, "{}", error.render()), err, 0);
    }
    complain(err, &Failure::input(in_one_line(error)))
}

/// What is wrong with a command line, in one line: the first paragraph of what the parser says.
fn in_one_line(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let lines = text.lines().map(str::trim).take_while(|line| !line.is_empty());
    let found = lines.collect::<Vec<_>>().join(" ").trim_start_matches("error: ").to_owned();
    let meant = [ContextKind::SuggestedArg, ContextKind::SuggestedSubcommand, ContextKind::SuggestedValue];
    let meant = meant.into_iter().find_map(|kind| suggestion(error.get(kind)?));
    match (meant, error.kind()) {
        (Some(meant), _) => format!("{found}; did you mean {meant}?"),
        (None, ErrorKind::UnknownArgument) => {
            format!("{found}; expected one of the options that --help lists")
        }
        (None, ErrorKind::InvalidSubcommand) => {
            format!("{found}; expected one that `roverlab systems` lists")
        }
        _ => found,
    }
}

/// The likeliest of the words that a parser suggests.
fn suggestion(words: &ContextValue) -> Option<&str> {
    match words {
        ContextValue::String(word) => Some(word),
        ContextValue::Strings(words) => words.last().map(String::as_str),
        _ => None,
    }
}

/// Prints one message. Returns the exit status.
fn complain(err: &mut dyn Write, failure: &Failure) -> u8 {
    // Without standard error there is nobody left to tell; the status still does.
    let _ = writeln!(err, "{failure}");
    failure.status()
}

/// The status, if the report was written. A reader that had enough, as `head`, is no failure.
pub(crate) fn written(result: io::Result<()>, err: &mut dyn Write, status: u8) -> u8 {
    match result {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            complain(err, &Failure::run(format!("standard output cannot be written: {error}")))
        }
        _ => status,
    }
}
