//! Flat YAML mappings: each key has a scalar or a list of scalars; all with locations.

use saphyr_parser::{Event, ScalarStyle};

use super::error::{FormatError, Location};
use super::lexer::shown;
use super::yaml_events::YamlEvents;

/// Largest number of keys in a file.
const MAX_KEYS: usize = 1000;

/// A scalar with its location.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scalar {
    pub(super) text: String,
    /// Whether it was unquoted, and may therefore be a number.
    pub(super) plain: bool,
    pub(super) at: Location,
}

/// Value of a key.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Scalar(Scalar),
    List(Vec<Scalar>, Location),
}

impl Value {
    pub(super) fn at(&self) -> Location {
        match self {
            Value::Scalar(scalar) => scalar.at,
            Value::List(_, at) => *at,
        }
    }
}

/// Entries of the first document, in order. Deeper nesting is an error.
pub(super) fn mapping(text: &str, file: &str) -> Result<Vec<(Scalar, Value)>, FormatError> {
    let mut events = YamlEvents::new(text, file, "keys with values");
    let mut entries = Vec::new();
    events.enter()?;
    loop {
        let key = match events.next()? {
            (Event::MappingEnd, _) => return Ok(entries),
            (event, at) => scalar(&events, event, at, "a key")?,
        };
        if entries.iter().any(|(other, _): &(Scalar, Value)| other.text == key.text) {
            return Err(events.error(key.at, format!("a second {}", shown(&key.text)), "each key once"));
        }
        if entries.len() == MAX_KEYS {
            return Err(events.error(key.at, "one more key", format!("at most {MAX_KEYS} keys")));
        }
        let value = value(&mut events)?;
        entries.push((key, value));
    }
}

fn value(events: &mut YamlEvents<'_>) -> Result<Value, FormatError> {
    let (event, at) = events.next()?;
    if !matches!(event, Event::SequenceStart(..)) {
        return scalar(events, event, at, "a value or a list of values").map(Value::Scalar);
    }
    let list =
        events.items((MAX_KEYS, " value"), |events, event, at| scalar(events, event, at, "a value"))?;
    Ok(Value::List(list, at))
}

fn scalar(
    events: &YamlEvents<'_>,
    event: Event<'_>,
    at: Location,
    expected: &str,
) -> Result<Scalar, FormatError> {
    match event {
        Event::Scalar(text, style, ..) => {
            Ok(Scalar { text: text.into_owned(), plain: style == ScalarStyle::Plain, at })
        }
        other => Err(events.unexpected(&other, at, expected)),
    }
}
