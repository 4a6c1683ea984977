//! Options without meaning for a run are rejected: none is ignored silently.

use clap::ArgMatches;
use clap::parser::ValueSource;

use super::Failure;

/// A condition, and the options not supported under it; their names have underscores.
///
/// Conditions are `always`; `campaign`: with that option; `!campaign`: without it; `method=turn,arc`: with
/// one of these values, given or by default; `method!=turn`: with another value; `&` joins conditions that
/// must hold together.
pub(crate) type Unheeded = (&'static str, &'static [&'static str]);

/// A command line that declares its unsupported options.
pub(crate) trait Heeds {
    /// The unsupported options, and under which conditions.
    const UNHEEDED: &'static [Unheeded];
}

/// Options of the single robot of a single run, unsupported by many runs.
pub(crate) const OF_ONE_RUN: &[&str] = &[
    "world",
    "robot",
    "start",
    "goal",
    "picture",
    "animation",
    "robios",
    "quantised",
    "realtime",
    "fault",
    "supervised",
];

/// Options of a campaign, unsupported by single runs.
pub(crate) const OF_A_CAMPAIGN: &[&str] = &["runs", "threads", "part", "out", "collected"];

/// Fails if an unsupported option was given. `counts` selects the options to check.
pub(super) fn check(
    matches: &ArgMatches,
    unheeded: &[Unheeded],
    counts: impl Fn(&str) -> bool,
) -> Result<(), Failure> {
    let given = |id: &str| matches.value_source(id) == Some(ValueSource::CommandLine) && counts(id);
    for (when, options) in
        unheeded.iter().filter(|(when, _)| when.split('&').all(|part| holds(matches, part)))
    {
        if let Some(option) = options.iter().find(|id| given(id)) {
            let (option, reason) = (shown(option), reason(when));
            return Err(Failure::input(format!(
                "--{option}: has no meaning {reason}; expected a command line without it"
            )));
        }
    }
    Ok(())
}

/// Whether one part of a condition holds.
fn holds(matches: &ArgMatches, part: &str) -> bool {
    let is_given = |id: &str| matches.value_source(id) == Some(ValueSource::CommandLine);
    let has = |id: &str, values: &str| {
        let mut found = matches.get_raw(id).into_iter().flatten();
        found.any(|value| values.split(',').any(|wanted| value == wanted))
    };
    match (part.split_once("!="), part.split_once('='), part.strip_prefix('!')) {
        (Some((id, values)), ..) => !has(id, values),
        (None, Some((id, values)), _) => has(id, values),
        (None, None, Some(id)) => !is_given(id),
        (None, None, None) => part == "always" || is_given(part),
    }
}

/// Text of a condition.
fn reason(when: &str) -> String {
    let words = |part: &str| match (part.split_once("!="), part.split_once('='), part.strip_prefix('!')) {
        (Some((id, values)), ..) => format!("unless --{} is {}", shown(id), any_of(values)),
        (None, Some((id, values)), _) => format!("where --{} is {}", shown(id), any_of(values)),
        (None, None, Some(id)) => format!("without --{}", shown(id)),
        (None, None, None) if part == "always" => "here".to_owned(),
        (None, None, None) => format!("with --{}", shown(part)),
    };
    when.split('&').map(words).collect::<Vec<_>>().join(" and ")
}

fn any_of(values: &str) -> String {
    values.replace(',', " or ")
}

/// An option as written on the command line.
fn shown(id: &str) -> String {
    id.replace('_', "-")
}
