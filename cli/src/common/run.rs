use std::ffi::OsString;
use std::io::{self, Write};

use clap::error::{ContextKind, ContextValue, ErrorKind};

use super::command_line::{self, Refusal};
use super::outputs::check_outputs;
use super::report::{Header, rounded};
use super::wall_clock::Stopwatch;
use super::{CommonArgs, Failure, Heeds, PlainArgs, Report, heed, onlooker};

/// Runs a command: parses the command line, does the work, prints the report or one message. Returns the exit
/// status: 0 for a verdict, 1 for a failure, 2 for a wrong command line or input file.
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
        let whole = || completed(command, common, stopwatch, work(args).or_else(Failure::into_report)?);
        #[cfg(feature = "view")]
        let whole = || super::view::beside(common, whole);
        whole()
    })
}

/// The report of a command, completed by the common facts.
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
    let header = || Header { command, seed, noise, timing };
    let printed = report.printed(header(), common.json);
    onlooker::reported(printed.status, || report.summary(header()));
    Ok(printed)
}

/// Like [`run`], for a command that drives no robot.
pub(crate) fn run_plain<A: clap::Parser + AsRef<PlainArgs> + Heeds>(
    command: &'static str,
    command_line: impl IntoIterator<Item = OsString>,
    out: &mut dyn Write,
    err: &mut dyn Write,
    work: impl FnOnce(&A) -> Result<Report, Failure>,
) -> u8 {
    let args = match command_line::parse_plain(command, command_line) {
        Ok(args) => Ok(args),
        Err(Refusal::Parser(error)) => Err(error),
        Err(Refusal::Files(failure)) => return complain(err, &failure),
    };
    run_parsed(args, out, err, |args: &A| {
        let stopwatch = Stopwatch::start();
        let mut report = work(args).or_else(Failure::into_report)?;
        args.as_ref().origin.tell_warnings();
        report.timing.insert(0, ("wall_time_s", rounded(stopwatch.seconds())));
        let PlainArgs { seed, json, timing, .. } = *args.as_ref();
        Ok(report.printed(Header { command, seed, noise: None, timing }, json))
    })
}

/// The parser of a command's command line, under its name.
pub(crate) fn parser<A: clap::CommandFactory>(name: &str) -> clap::Command {
    let shown = name.replace('_', "-");
    // Missing arguments are reported like all other errors.
    A::command().bin_name(format!("roverlab {shown}")).name(shown).arg_required_else_help(false)
}

/// Output at the end of a program's work.
#[derive(Debug)]
pub(crate) struct Printed {
    /// Standard output.
    pub(crate) text: String,
    /// Standard error.
    pub(crate) message: Option<String>,
    /// The exit status.
    pub(crate) status: u8,
}

/// Like [`run`], for a program with its own options and report.
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

/// What a command found to run in its place, or its exit status if it found nothing.
pub(crate) fn run_again<A: clap::Parser, R>(
    name: &str,
    command_line: impl IntoIterator<Item = OsString>,
    out: &mut dyn Write,
    err: &mut dyn Write,
    work: impl FnOnce(&A) -> Result<R, Failure>,
) -> Result<R, u8> {
    let args = parser::<A>(name)
        .try_get_matches_from(command_line)
        .and_then(|matches| A::from_arg_matches(&matches))
        .map_err(|error| refused(&error, out, err))?;
    work(&args).map_err(|failure| complain(err, &failure))
}

/// Does the work of a parsed command line, or reports its error.
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

/// Prints the result of a command's work. Returns the exit status.
fn ended(printed: Result<Printed, Failure>, out: &mut dyn Write, err: &mut dyn Write) -> u8 {
    match printed {
        Err(failure) => complain(err, &failure),
        Ok(printed) => {
            if let Some(message) = printed.message {
                // Without standard error nobody can be informed; the status remains.
                let _ = writeln!(err, "{message}");
            }
            written(writeln!(out, "{}", printed.text), err, printed.status)
        }
    }
}

/// Prints the error of a command line, or the requested help. Returns the exit status.
pub(crate) fn refused(error: &clap::Error, out: &mut dyn Write, err: &mut dyn Write) -> u8 {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        return written(write!(out, "{}", error.render()), err, 0);
    }
    complain(err, &Failure::input(in_one_line(error)))
}

/// The error of a command line on one line: the first paragraph of the parser's message.
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

/// The likeliest of the parser's suggestions.
fn suggestion(words: &ContextValue) -> Option<&str> {
    match words {
        ContextValue::String(word) => Some(word),
        ContextValue::Strings(words) => words.last().map(String::as_str),
        _ => None,
    }
}

/// Prints one message. Returns the exit status.
fn complain(err: &mut dyn Write, failure: &Failure) -> u8 {
    // Without standard error nobody can be informed; the status remains.
    let _ = writeln!(err, "{failure}");
    failure.status()
}

/// The status, if the report was written. A closed pipe, as with `head`, is not a failure.
pub(crate) fn written(result: io::Result<()>, err: &mut dyn Write, status: u8) -> u8 {
    match result {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            complain(err, &Failure::run(format!("standard output cannot be written: {error}")))
        }
        _ => status,
    }
}
