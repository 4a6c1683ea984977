//! Options that have no meaning for a run are refused: none is ignored in silence.

use clap::ArgMatches;
use clap::parser::ValueSource;

use super::Failure;

/// When a command does not heed options, and which: their names have underscores.
///
/// `always`; `campaign`: with that option; `!campaign`: without it; `method=turn,arc`: where it has one of
/// these values, given or by default; `method!=turn`: where it has another one; with `&` between what has to
/// hold together.
pub(crate) type Unheeded = (&'static str, &'static [&'static str]);

/// A command line that says what it does not heed.
pub(crate) trait Heeds {
    /// What it does not heed, and when.
    const UNHEEDED: &'static [Unheeded];
}

/// Options about the one robot of one run, which many runs do not heed.
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

/// Fails if an option was given that a command line does not heed. `counts` says which of them count.
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

/// A condition in words.
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

/// An option as it is written.
fn shown(id: &str) -> String {
    id.replace('_', "-")
}
