use std::ffi::OsString;
use std::io::{self, Write};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::error::ErrorKind;

use super::report::Header;
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
    let args = match A::try_parse_from(command_line) {
        Ok(args) => args,
        Err(error) if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) => {
            return written(write!(out, "{}", error.render()), err, 0);
        }
        Err(error) => return complain(err, &Failure::input(in_one_line(&error))),
    };
    let common = args.as_ref();
    let stopwatch = Stopwatch::start();
    match common.check().and_then(|()| work(&args)) {
        Err(failure) => complain(err, &failure),
        Ok(report) => {
            let wall_time = stopwatch.elapsed().as_secs_f64();
            let header = Header { example, seed: common.seed, noise: common.noise, wall_time };
            let text = if common.json { report.json(header) } else { report.summary(header) };
            written(writeln!(out, "{text}"), err, report.status())
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

/// The wall clock, for `wall_time_s` alone: nothing else may depend on it.
struct Stopwatch(Instant);

impl Stopwatch {
    #[allow(clippy::disallowed_methods, reason = "the report tells how long the run took on the wall clock")]
    fn start() -> Self {
        Self(Instant::now())
    }

    fn elapsed(&self) -> Duration {
        self.0.elapsed()
    }
}
