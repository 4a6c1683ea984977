use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::parser::ValueSource;
use clap::{ArgAction, ArgMatches, Command};
use roverlab::io::log::Log;
use roverlab::world::RobotSpec;

use super::files::{recorded_name, recording_bytes};
use super::origin::Facts;
use super::outputs::{OUTPUTS, check_outputs};
use super::{CommonArgs, Failure, Heeds, OF_PARTS, PlainArgs, Unheeded, heed, parser, stage};

/// Options that do not affect a run.
const NOT_RECORDED: [&str; 19] = [
    "record",
    "force",
    "fsync",
    "replay",
    "picture",
    "animation",
    "output",
    "lcd",
    "json",
    "timing",
    "realtime",
    "robios",
    "view",
    "no_wait",
    // How a run is computed, and where intermediate results are stored.
    "threads",
    "processes",
    "worker_command",
    "worker_piece",
    "checkpoint",
];

/// Options for the robot's conditions, which a replay takes from the recording.
const MET: [&str; 4] = ["seed", "noise", "quantised", "fault"];

/// Options with names of input files.
const FILES: [&str; 9] = ["world", "robot", "maze", "track", "line", "course", "figure", "weights", "drive"];

/// Options without a single driving robot to record: many runs at once, or none.
const UNRECORDED: [&str; 6] = ["campaign", "plan", "input", "compare", "steps", "train"];

/// Folders that a campaign writes to.
const FOLDERS: [&str; 1] = ["save"];

/// Reason to reject a command line.
pub(crate) enum Refusal {
    /// The parser's error, or its help.
    Parser(clap::Error),
    /// The recording to replay is invalid, or its files do not match.
    Files(Failure),
}

/// Parses a command line. With `--replay`, the recording's options are included.
pub(crate) fn parse<A>(name: &str, command_line: impl IntoIterator<Item = OsString>) -> Result<A, Refusal>
where
    A: clap::Parser + AsRef<CommonArgs> + Heeds,
{
    let mut command = parser::<A>(name);
    let words = command_line.into_iter().collect();
    let (mut matches, facts) = matches(name, &mut command, A::UNHEEDED, words)?;
    let args =
        A::from_arg_matches_mut(&mut matches).map_err(|error| Refusal::Parser(error.format(&mut command)))?;
    args.as_ref().origin.set(facts);
    Ok(args)
}

/// Parses the command line of a command that drives no robot.
pub(crate) fn parse_plain<A>(name: &str, words: impl IntoIterator<Item = OsString>) -> Result<A, Refusal>
where
    A: clap::Parser + AsRef<PlainArgs> + Heeds,
{
    let mut command = parser::<A>(name);
    let mut matches = command.try_get_matches_from_mut(words).map_err(Refusal::Parser)?;
    check_outputs(&matches).map_err(Refusal::Files)?;
    heed::check(&matches, A::UNHEEDED, |_| true).map_err(Refusal::Files)?;
    check_part(&matches).map_err(Refusal::Files)?;
    let facts = Facts {
        program: name.into(),
        settings: settings(&command, &matches),
        inputs: inputs(&matches),
        ..Facts::default()
    };
    let args =
        A::from_arg_matches_mut(&mut matches).map_err(|error| Refusal::Parser(error.format(&mut command)))?;
    args.as_ref().origin.set(facts);
    Ok(args)
}

/// Parsed command line and facts about the run.
fn matches(
    name: &str,
    command: &mut Command,
    unheeded: &[Unheeded],
    mut words: Vec<OsString>,
) -> Result<(ArgMatches, Facts), Refusal> {
    let log = replayed(&words).filter(|_| stage::RECORDS).map(|file| recording(name, command, &file));
    let log = log.transpose().map_err(Refusal::Files)?;
    let given = words.split_off(1.min(words.len()));
    if let Some(log) = &log {
        let recorded = log.header().options.iter().filter(|option| !repeats(option, &given));
        words.extend(recorded.map(OsString::from));
    }
    words.extend(given.iter().cloned());
    let matches = command.try_get_matches_from_mut(words).map_err(Refusal::Parser)?;
    check_recorded(&matches).map_err(Refusal::Files)?;
    check_outputs(&matches).map_err(Refusal::Files)?;
    // Options recorded by an older program were accepted then.
    let is_recorded = |id: &str| log.is_some() && !repeats(&format!("--{}", id.replace('_', "-")), &given);
    heed::check(&matches, unheeded, |id| !is_recorded(id)).map_err(Refusal::Files)?;
    let options = options(command, &matches);
    if let Some(log) = &log {
        check_met(command, &options, &log.header().options).map_err(Refusal::Files)?;
    }
    check_part(&matches).map_err(Refusal::Files)?;
    let (settings, inputs) = (settings(command, &matches), inputs(&matches));
    Ok((matches, Facts { program: name.into(), options, settings, inputs, log }))
}

/// Whether an option decides about a campaign's results, rather than about what is made of them and how.
pub(crate) fn is_setting(name: &str) -> bool {
    let id = name.replace('-', "_");
    ![&NOT_RECORDED[..], &OUTPUTS[..], OF_PARTS, &FOLDERS[..]].concat().contains(&id.as_str())
}

/// Fails if a part of a campaign is to write what only the whole can.
fn check_part(matches: &ArgMatches) -> Result<(), Failure> {
    let given = |id: &&&str| {
        matches.try_contains_id(id).is_ok_and(|known| known)
            && matches.value_source(id) == Some(ValueSource::CommandLine)
    };
    let outputs = OUTPUTS.iter().chain(&FOLDERS).filter(|id| **id != "out");
    match (given(&&"part"), outputs.copied().find(|id| given(&id))) {
        (true, Some(output)) => Err(Failure::input(format!(
            "--{output}: has no meaning with --part; expected it after the files of `roverlab merge`, behind --"
        ))),
        _ => Ok(()),
    }
}

/// The given options that decide about a campaign's results, in the command's order.
fn settings(command: &Command, matches: &ArgMatches) -> Vec<String> {
    given_options(command, matches, is_setting, |_, value| value)
}

/// The given input files.
fn inputs(matches: &ArgMatches) -> Vec<(String, PathBuf)> {
    let file = |id: &&str| {
        let value = matches.try_get_raw(id).ok().flatten()?.next()?.to_owned();
        let file = matches.value_source(id) == Some(ValueSource::CommandLine) && Path::new(&value).is_file();
        file.then(|| ((*id).to_owned(), PathBuf::from(value)))
    };
    FILES.iter().filter_map(file).collect()
}

/// Fails if a recording or a page is requested for a run that cannot be recorded.
fn check_recorded(matches: &ArgMatches) -> Result<(), Failure> {
    let given = |name: &&&str| {
        matches.try_contains_id(name).is_ok_and(|known| known)
            && matches.value_source(name) == Some(ValueSource::CommandLine)
    };
    let unrecorded = UNRECORDED.iter().find(given);
    match (["record", "replay", "view"].iter().find(given), unrecorded) {
        (Some(option), Some(other)) => Err(Failure::input(format!(
            "--{option}: found no robot that drives with --{other}; expected a run that can be recorded"
        ))),
        _ => Ok(()),
    }
}

/// Fails if a replay's conditions differ from the recorded ones.
fn check_met(command: &Command, options: &[String], recorded: &[String]) -> Result<(), Failure> {
    let default = |name: &str| {
        let arg = command.get_arguments().find(|arg| arg.get_long() == Some(name))?;
        arg.get_default_values().first()?.to_str()
    };
    let was_recorded = |option: &str| {
        let (name, value) = (name_of(option), value_of(option));
        let mut known = recorded.iter().filter(|other| name_of(other) == name).peekable();
        match known.peek() {
            Some(_) => known.any(|other| is_same(value_of(other), value)),
            None => is_same(default(name), value),
        }
    };
    let changed = |option: &&String| MET.contains(&name_of(option)) && !was_recorded(option);
    options.iter().find(changed).map_or(Ok(()), |option| {
        Err(Failure::input(format!(
            "found {option} and --replay; expected none, what the robot meets is in the recording"
        )))
    })
}

/// Whether two values of an option are equal, as text or as numbers.
fn is_same(one: Option<&str>, other: Option<&str>) -> bool {
    let number = |text: Option<&str>| text?.parse::<f64>().ok();
    one == other || number(one).is_some_and(|one| Some(one) == number(other))
}

/// The file of `--replay`.
fn replayed(words: &[OsString]) -> Option<OsString> {
    let words = || words.iter().skip(1).take_while(|word| *word != "--");
    let joined = words().find_map(|word| word.to_str()?.strip_prefix("--replay=").map(OsString::from));
    joined.or_else(|| words().skip_while(|word| *word != "--replay").nth(1).cloned())
}

fn recording(wanted: &str, command: &Command, file: &OsString) -> Result<Log, Failure> {
    let name = Path::new(file).display();
    let refused = |error: &dyn std::fmt::Display| Failure::input(format!("--replay {name}: {error}"));
    let bytes = recording_bytes(Path::new(file)).map_err(|error| refused(&error))?;
    let log = Log::read(bytes).map_err(|error| refused(&error))?;
    let program = &log.header().program;
    if program != wanted {
        let (program, wanted) = (program.replace('_', "-"), wanted.replace('_', "-"));
        return Err(refused(&format!(
            "found a recording of the program `{program}`; expected one of `{wanted}`"
        )));
    }
    // A recording may come from anywhere: it must not cause files to be written, nor other files to be read.
    match log.header().options.iter().find(|option| !affects_run(command, option)) {
        Some(option) => Err(refused(&format!(
            "found the option {option} in the recording; expected options that affect the run"
        ))),
        None => Ok(log),
    }
}

/// Whether an option is stored in recordings.
fn affects_run(command: &Command, option: &str) -> bool {
    let name = name_of(option);
    let known = command.get_arguments().any(|arg| arg.get_long() == Some(name));
    let is_own = |value: &str| value == recorded_name(name, Path::new(value)) || is_built_in(name, value);
    known
        && !NOT_RECORDED.contains(&name.replace('-', "_").as_str())
        && (!FILES.contains(&name) || value_of(option).is_some_and(is_own))
}

/// Whether an option's value is the name of something built in, and no file.
fn is_built_in(option: &str, value: &str) -> bool {
    match option {
        "robot" => RobotSpec::predefined(value).is_some() && !Path::new(value).exists(),
        // The ways to drive of `maze-left` have names, weights of networks are files.
        "figure" | "drive" => Path::new(value).extension().is_none(),
        _ => false,
    }
}

/// Whether a recorded option is given again.
fn repeats(option: &str, given: &[OsString]) -> bool {
    given.iter().filter_map(|word| word.to_str()).any(|word| name_of(word) == name_of(option))
}

/// The name in `--name=value` or `--name`.
fn name_of(option: &str) -> &str {
    option.split('=').next().unwrap_or(option).trim_start_matches("--")
}

/// The value in `--name=value`.
fn value_of(option: &str) -> Option<&str> {
    option.split_once('=').map(|(_, value)| value)
}

/// The given options that affect a run, in the command's order, with the names that files have in recordings.
fn options(command: &Command, matches: &ArgMatches) -> Vec<String> {
    given_options(
        command,
        matches,
        |id| !NOT_RECORDED.contains(&id),
        |id, value| {
            let is_file = FILES.contains(&id) && !is_built_in(id, &value);
            if is_file { recorded_name(id, Path::new(&value)) } else { value }
        },
    )
}

/// The given options of a kind, in the command's order, as single words.
fn given_options(
    command: &Command,
    matches: &ArgMatches,
    counts: impl Fn(&str) -> bool,
    written: impl Fn(&str, String) -> String,
) -> Vec<String> {
    let mut options = Vec::new();
    for arg in command.get_arguments() {
        let id = arg.get_id().as_str();
        if matches.value_source(id) != Some(ValueSource::CommandLine) || !counts(id) {
            continue;
        }
        let name = arg.get_long().map(|long| format!("--{long}"));
        if matches!(arg.get_action(), ArgAction::SetTrue | ArgAction::SetFalse) {
            options.extend(name);
            continue;
        }
        let values = matches.get_raw(id).into_iter().flatten();
        let values = values.map(|value| written(id, value.to_string_lossy().into_owned()));
        options.extend(values.map(|value| match &name {
            Some(name) => format!("{name}={value}"),
            None => value,
        }));
    }
    options
}
