use std::ffi::OsString;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::error::ErrorKind;

use super::command_line::{self, Refusal};
use super::outputs::check_outputs;
use super::report::Header;
use super::wall_clock::Stopwatch;
use super::{CommonArgs, Failure, Report};

/// The main function of an example: reads the command line, does the work, prints the report or one message, and
/// says by the exit status how it went. 0: the behaviour came to a verdict; 1: it failed; 2: the command line or an
/// input file is wrong.
pub(crate) fn main<A>(example: &'static str, work: impl FnOnce(&A) -> Result<Report, Failure>) -> ExitCode
where
    A: clap::Parser + AsRef<CommonArgs>,
{
    let (out, err) = (&mut io::stdout(), &mut io::stderr());
    ExitCode::from(run(example, std::env::args_os(), out, err, work))
}

/// As [`main`], with the command line and the two outputs given. Returns the exit status.
pub(crate) fn run<A>(
    example: &'static str,
    command_line: impl IntoIterator<Item = OsString>,
    out: &mut dyn Write,
    err: &mut dyn Write,
    work: impl FnOnce(&A) -> Result<Report, Failure>,
) -> u8
where
    A: clap::Parser + AsRef<CommonArgs>,
{
    let args = match command_line::parse(example, command_line) {
        Ok(args) => Ok(args),
        Err(Refusal::Parser(error)) => Err(error),
        Err(Refusal::Files(failure)) => return complain(err, &failure),
    };
    run_parsed(args, out, err, |args: &A| {
        let common = args.as_ref();
        let stopwatch = Stopwatch::start();
        common.check()?;
        let mut report = work(args)?;
        common.origin.tell_warnings();
        report.add_trouble(common.origin.take_trouble());
        let safety = common.origin.stops().take();
        common.check_supervised(safety.is_some())?;
        if let Some(safety) = safety {
            report = report.field("safety", safety);
        }
        common.check_recorded()?;
        let (seed, noise, wall_time) = (common.seed, common.noise, stopwatch.seconds());
        let header = Header { example, seed, noise, wall_time };
        let text = if common.json { report.json(header) } else { report.summary(header) };
        Ok(Printed { text, message: report.message(), status: report.status() })
    })
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
pub(crate) fn run_printing<A: clap::Parser>(
    command_line: impl IntoIterator<Item = OsString>,
    out: &mut dyn Write,
    err: &mut dyn Write,
    work: impl FnOnce(&A) -> Result<Printed, Failure>,
) -> u8 {
    let matches = match A::command().try_get_matches_from(command_line) {
        Ok(matches) => matches,
        Err(error) => return run_parsed(Err::<A, _>(error), out, err, work),
    };
    match check_outputs(&matches) {
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
    let args = match args {
        Ok(args) => args,
        Err(error) if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) => {
            return written(write!(out, "{}", error.render()), err, 0);
        }
        Err(error) => return complain(err, &Failure::input(in_one_line(&error))),
    };
    match work(&args) {
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

/// What is wrong with a command line, in one line: the first paragraph of what the parser says.
fn in_one_line(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let lines = text.lines().map(str::trim).take_while(|line| !line.is_empty());
    let found = lines.collect::<Vec<_>>().join(" ").trim_start_matches("error: ").to_owned();
    match error.kind() {
        ErrorKind::UnknownArgument => format!("{found}; expected one of the options that --help lists"),
        _ => found,
    }
}

/// Prints one message. Returns the exit status.
fn complain(err: &mut dyn Write, failure: &Failure) -> u8 {
    // Without standard error there is nobody left to tell; the status still does.
    let _ = writeln!(err, "{failure}");
    failure.status()
}

/// The status, if the report was written. A reader that had enough, as `head`, is no failure.
fn written(result: io::Result<()>, err: &mut dyn Write, status: u8) -> u8 {
    match result {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            complain(err, &Failure::run(format!("standard output cannot be written: {error}")))
        }
        _ => status,
    }
}
