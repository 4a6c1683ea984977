//! The commands of `roverlab` and their dispatch. A command in this list can be run, appears in `roverlab
//! systems`, and its recordings can be checked.

use std::ffi::OsString;
use std::io::{self, Write};
#[cfg(feature = "native")]
use std::path::PathBuf;
use std::process::ExitCode;

use clap::CommandFactory;
use serde_json::{Value, json};

#[cfg(feature = "native")]
use crate::common::set_own_program;
use crate::common::{
    Failure, Onlooker, onlooker, parser, refused, run, run_again, run_plain, run_printing, written,
};
#[cfg(test)]
use crate::common::{Heeds, Unheeded};
use crate::maze_drive::{explore as maze_explore, left as maze_left, lidar as maze_lidar};
#[cfg(feature = "view")]
use crate::view;
use crate::{
    a_to_b, ackermann, base_station, boat, bug_compare, camera, color_tracking, cone_drive, cone_race,
    coverage, distbug, dive, edges, end_to_end, first_steps, follow_me, genetic, grid_benchmark,
    lane_keeping, lidar_scan, localise, merge, micromouse, motion, navigate, omni, parking, ping,
    pool_search, pool_wall, quadtree, ramp, random_drive, replay, safety, signs, summit, survey,
    terrain_plan, traffic, wall_following,
};
#[cfg(feature = "native")]
use crate::{grade, starman};

/// Runs a command with its command line and its two output streams. Returns the exit status.
type Run = fn(Vec<OsString>, &mut dyn Write, &mut dyn Write) -> u8;

/// A command.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Command {
    /// Name in reports and recordings, with underscores; the command line uses hyphens.
    pub(crate) name: &'static str,
    /// Runs it. The first argument is its name.
    pub(crate) run: Run,
    parser: fn() -> clap::Command,
    /// Options it does not support, and under which conditions.
    #[cfg(test)]
    pub(crate) unheeded: fn() -> &'static [Unheeded],
}

/// The command-line parser of a command's work function.
fn parser_of<A: CommandFactory, R>(name: &str, _: impl Fn(&A) -> Result<R, Failure>) -> clap::Command {
    parser::<A>(name)
}

/// The unsupported options of a command's work function.
#[cfg(test)]
fn unheeded_by<A: Heeds, R>(_: impl Fn(&A) -> Result<R, Failure>) -> &'static [Unheeded] {
    A::UNHEEDED
}

/// Table of commands from the names of their modules and their work functions.
macro_rules! commands {
    ($($(#[$when:meta])? $name:ident by $run:path),* $(,)?) => {
        /// All commands, ordered by name.
        pub(crate) const COMMANDS: &[Command] = &[$($(#[$when])? Command {
            name: stringify!($name),
            run: |words, out, err| $run(stringify!($name), words, out, err, $name::work),
            parser: || parser_of(stringify!($name), $name::work),
            #[cfg(test)]
            unheeded: || unheeded_by($name::work),
        }),*];
    };
}

commands!(
    a_to_b by run,
    ackermann by run,
    base_station by run,
    boat by run,
    bug_compare by run,
    camera by run,
    color_tracking by run,
    cone_drive by run,
    cone_race by run,
    coverage by run,
    distbug by run,
    dive by run,
    edges by run,
    end_to_end by run,
    first_steps by run,
    follow_me by run,
    genetic by run,
    #[cfg(feature = "native")]
    grade by run_plain,
    grid_benchmark by run_plain,
    lane_keeping by run,
    lidar_scan by run,
    localise by run,
    maze_explore by run,
    maze_left by run,
    maze_lidar by run,
    merge by run_merged,
    micromouse by run,
    motion by run,
    navigate by run,
    omni by run,
    parking by run,
    ping by run,
    pool_search by run,
    pool_wall by run,
    quadtree by run_plain,
    ramp by run,
    random_drive by run,
    replay by run_printing,
    safety by run,
    signs by run_plain,
    #[cfg(feature = "native")]
    starman by run,
    summit by run,
    survey by run,
    terrain_plan by run_plain,
    traffic by run,
    #[cfg(feature = "view")]
    view by run_printing,
    wall_following by run,
);

impl Command {
    /// Names of its options, with underscores.
    #[cfg(test)]
    pub(crate) fn options(&self) -> Vec<String> {
        (self.parser)().get_arguments().map(|argument| argument.get_id().to_string()).collect()
    }

    /// Whether its campaigns run in parts.
    pub(crate) fn has_parts(&self) -> bool {
        (self.parser)().get_arguments().any(|argument| argument.get_id() == "part")
    }

    /// Whether it drives robots, so that its runs can be recorded.
    pub(crate) fn drives(&self) -> bool {
        (self.parser)().get_arguments().any(|argument| argument.get_id() == "record")
    }
}

/// Runs the campaign whose parts the command `merge` names, on their results.
fn run_merged(
    name: &str,
    words: Vec<OsString>,
    out: &mut dyn Write,
    err: &mut dyn Write,
    work: fn(&merge::Args) -> Result<Vec<OsString>, Failure>,
) -> u8 {
    let campaign = |args: &merge::Args| {
        let words = work(args)?;
        let command = words[0].to_str().and_then(named).filter(|command| command.has_parts());
        command.map(|command| (command, words)).ok_or_else(|| {
            Failure::input(format!(
                "{}: line 1: found no campaign that runs in parts; expected the results of one",
                args.files[0].display()
            ))
        })
    };
    match run_again(name, words, out, err, campaign) {
        Ok((command, words)) => (command.run)(words, out, err),
        Err(status) => status,
    }
}

/// The command with a name, with hyphens or underscores.
pub(crate) fn named(name: &str) -> Option<&'static Command> {
    let name = name.replace('-', "_");
    COMMANDS.iter().find(|command| command.name == name)
}

/// Main function of the program.
#[must_use]
pub fn main() -> ExitCode {
    ExitCode::from(main_of(std::env::args_os().collect()))
}

/// The same within another program, in which `program` starts it. The first word is the program's name.
/// Returns the exit status.
#[cfg(feature = "native")]
#[must_use]
pub fn main_at(program: PathBuf, words: Vec<OsString>) -> u8 {
    set_own_program(program);
    main_of(words)
}

/// Runs a command line.
fn main_of(words: Vec<OsString>) -> u8 {
    #[cfg(feature = "native")]
    let for_another = starman::work_for_another(&words);
    #[cfg(not(feature = "native"))]
    let for_another = None;
    for_another
        .or_else(|| micromouse::mms::drive_for_another(&words))
        .unwrap_or_else(|| dispatch(words, &mut io::stdout(), &mut io::stderr()))
}

/// Result of a command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ended {
    /// Exit status: 0 success, 1 failure, 2 wrong input.
    pub status: u8,
    /// Standard output.
    pub output: String,
    /// Standard error.
    pub errors: String,
}

/// Runs a command line without the program's name, optionally with an onlooker.
pub fn run_words(words: impl IntoIterator<Item = OsString>, onlooker: Option<Box<dyn Onlooker>>) -> Ended {
    let words = std::iter::once(OsString::from("roverlab")).chain(words).collect();
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = onlooker::with(onlooker, || dispatch(words, &mut out, &mut err));
    let [output, errors] = [out, err].map(|text| String::from_utf8_lossy(&text).into_owned());
    Ended { status, output, errors }
}

/// The commands that drive robots and their options, as JSON: a list of `{name, about, options}`. An option
/// has `name`, `help`, `kind` (`switch`, `choice`, `number` or `text`), `default`, `choices` and `value`, the
/// name of its value.
pub fn options() -> String {
    let commands = COMMANDS.iter().filter(|command| command.drives()).map(|command| {
        let parser = (command.parser)();
        let options: Vec<_> = parser.get_arguments().filter_map(option).collect();
        let about = parser.get_about().map(ToString::to_string);
        json!({ "name": parser.get_name(), "about": about, "options": options })
    });
    Value::from(commands.collect::<Vec<_>>()).to_string()
}

/// An option as JSON.
fn option(argument: &clap::Arg) -> Option<Value> {
    let name = argument.get_long().filter(|name| *name != "help" && !argument.is_hide_set())?;
    let choices: Vec<_> =
        argument.get_possible_values().iter().map(|choice| choice.get_name().to_owned()).collect();
    let default = argument.get_default_values().first().map(|value| value.to_string_lossy().into_owned());
    let takes = argument.get_action().takes_values();
    let is_number = default.as_ref().is_some_and(|value| value.parse::<f64>().is_ok());
    let kind = match (takes, choices.is_empty(), is_number) {
        (false, ..) => "switch",
        (true, false, _) => "choice",
        (true, true, true) => "number",
        _ => "text",
    };
    let value = argument.get_value_names().and_then(|names| names.first()).map(ToString::to_string);
    let help = argument.get_help().map(ToString::to_string);
    Some(json!({
        "name": name, "help": help, "kind": kind, "default": default, "choices": choices, "value": value,
    }))
}

/// Runs the command of a command line, or lists the commands. Returns the exit status.
pub(crate) fn dispatch(mut words: Vec<OsString>, out: &mut dyn Write, err: &mut dyn Write) -> u8 {
    if let Some(command) = words.get(1).and_then(|word| named(word.to_str()?)) {
        words.remove(0);
        return (command.run)(words, out, err);
    }
    match program().try_get_matches_from(words) {
        Ok(_) => written(write!(out, "{}", systems()), err, 0),
        Err(error) => refused(&error, out, err),
    }
}

/// The parser of the whole program, for help and for suggestions on mistyped names.
fn program() -> clap::Command {
    clap::Command::new("roverlab")
        .about("Every system of the library roverlab as a command")
        .version(env!("CARGO_PKG_VERSION"))
        .subcommand_required(true)
        .subcommand(clap::Command::new("systems").about("Lists every system, with a line each"))
        .subcommands(COMMANDS.iter().map(|command| (command.parser)()))
}

/// All commands, one per line.
fn systems() -> String {
    let line = |command: &Command| {
        let parser = (command.parser)();
        format!("{:<15} {}\n", parser.get_name(), parser.get_about().unwrap_or_default())
    };
    COMMANDS.iter().map(line).collect()
}
