//! The command `merge`.

use std::ffi::OsString;
use std::path::PathBuf;

use crate::common::{Failure, Header, Heeds, Unheeded, is_setting};

/// The command line of `merge`.
#[derive(Debug, clap::Parser)]
#[command(
    about = "Makes the report of a campaign that ran in parts",
    after_help = "\
A part is what a campaign does with `--part K/N --out FILE`, on any machine: every N-th run, from the K-th on. The parts of one
campaign have the same options, and the report of all of them is that of the campaign in one go, to the byte.

  roverlab ramp --campaign --part 1/2 --out one.jsonl
  roverlab ramp --campaign --part 2/2 --out two.jsonl
  roverlab merge --json one.jsonl two.jsonl

Options that name input files are read again, relative to the current folder. Options for what is written besides the report,
such as --save DIR of distbug, come last, behind --."
)]
pub(crate) struct Args {
    /// The files of all parts, in any order.
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,

    /// Print exactly one JSON object on standard output, and nothing else there.
    #[arg(long)]
    pub(crate) json: bool,

    /// Report the duration too, which differs from run to run.
    #[arg(long)]
    pub(crate) timing: bool,

    /// Further options of the campaign's command that affect no result.
    #[arg(value_name = "OPTION", last = true)]
    pub(crate) options: Vec<OsString>,
}

impl Heeds for Args {
    const UNHEEDED: &'static [Unheeded] = &[];
}

/// The words of the campaign's command line, beginning with its command, with the files of its parts.
pub(crate) fn work(args: &Args) -> Result<Vec<OsString>, Failure> {
    let first = &args.files[0];
    let header = Header::read(first)?;
    // A file may come from anywhere: it must not cause other files to be written.
    let name = |option: &str| Some(option.strip_prefix("--")?.split('=').next()?.to_owned());
    let harmless = |option: &&String| name(option).is_some_and(|name| !name.is_empty() && is_setting(&name));
    if let Some(option) = header.options.iter().find(|option| !harmless(option)) {
        return Err(Failure::input(format!(
            "{}: line 1: found the option {option:?}; expected options that affect results",
            first.display()
        )));
    }
    let mut words: Vec<OsString> = vec![header.command.replace('_', "-").into()];
    words.extend(header.options.into_iter().map(OsString::from));
    words.extend(args.files.iter().map(|file| {
        let mut option = OsString::from("--collected=");
        option.push(file);
        option
    }));
    words.extend(args.json.then(|| "--json".into()));
    words.extend(args.timing.then(|| "--timing".into()));
    words.extend(args.options.iter().cloned());
    Ok(words)
}
