//! Flat YAML mappings: a scalar or a list of scalars for each key, with the place of each.

use saphyr_parser::{Event, Parser, ScalarStyle, Span};

use super::error::{FormatError, Location};
use super::lexer::shown;

/// Keys of a file.
const MAX_KEYS: usize = 1000;

/// A scalar with its place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scalar {
    pub(super) text: String,
    /// Whether it stood without quotes, so that it may be a number.
    pub(super) plain: bool,
    pub(super) at: Location,
}

/// A key's value.
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

/// The entries of the first document, in order. Anything nested deeper is an error.
pub(super) fn mapping(text: &str, file: &str) -> Result<Vec<(Scalar, Value)>, FormatError> {
    let mut reader = Reader { parser: Parser::new_from_str(text), file };
    let mut entries = Vec::new();
    loop {
        match reader.next()? {
            (Event::MappingStart(..), _) => break,
            (Event::StreamStart | Event::DocumentStart(_), _) => {}
            (event, at) => return Err(reader.unexpected(&event, at, "keys with values")),
        }
    }
    loop {
        let key = match reader.next()? {
            (Event::MappingEnd, _) => return Ok(entries),
            (event, at) => reader.scalar(event, at, "a key")?,
        };
        if entries.iter().any(|(other, _): &(Scalar, Value)| other.text == key.text) {
            return Err(FormatError::new(
                file,
                key.at,
                format!("a second {}", shown(&key.text)),
                "each key once",
            ));
        }
        if entries.len() == MAX_KEYS {
            return Err(FormatError::new(file, key.at, "one more key", format!("at most {MAX_KEYS} keys")));
        }
        let value = reader.value()?;
        entries.push((key, value));
    }
}

struct Reader<'a> {
    parser: Parser<'a, saphyr_parser::StrInput<'a>>,
    file: &'a str,
}

impl<'a> Reader<'a> {
    fn next(&mut self) -> Result<(Event<'a>, Location), FormatError> {
        match self.parser.next_event() {
            Some(Ok((event, span))) => Ok((event, place(span))),
            Some(Err(error)) => {
                let at = Location { line: error.marker().line(), column: error.marker().col() + 1 };
                Err(FormatError::new(self.file, at, format!("broken YAML ({})", error.info()), "YAML"))
            }
            None => {
                Err(FormatError::new(self.file, Location::START, "the end of the file", "keys with values"))
            }
        }
    }

    fn value(&mut self) -> Result<Value, FormatError> {
        let (event, at) = self.next()?;
        if !matches!(event, Event::SequenceStart(..)) {
            return self.scalar(event, at, "a value or a list of values").map(Value::Scalar);
        }
        let mut list = Vec::new();
        loop {
            match self.next()? {
                (Event::SequenceEnd, _) => return Ok(Value::List(list, at)),
                (_, at) if list.len() == MAX_KEYS => {
                    let expected = format!("at most {MAX_KEYS} values");
                    return Err(FormatError::new(self.file, at, "one more value", expected));
                }
                (event, at) => list.push(self.scalar(event, at, "a value")?),
            }
        }
    }

    fn scalar(&self, event: Event<'a>, at: Location, expected: &str) -> Result<Scalar, FormatError> {
        match event {
            Event::Scalar(text, style, ..) => {
                Ok(Scalar { text: text.into_owned(), plain: style == ScalarStyle::Plain, at })
            }
            other => Err(self.unexpected(&other, at, expected)),
        }
    }

    fn unexpected(&self, event: &Event<'_>, at: Location, expected: &str) -> FormatError {
        let found = match event {
            Event::Scalar(text, ..) => shown(text),
            Event::SequenceStart(..) => "a list".into(),
            Event::MappingStart(..) => "keys with values".into(),
            Event::Alias(_) => "an alias".into(),
            Event::SequenceEnd => "the end of a list".into(),
            _ => "the end of the file".into(),
        };
        FormatError::new(self.file, at, found, expected)
    }
}

fn place(span: Span) -> Location {
    Location { line: span.start.line().max(1), column: span.start.col() + 1 }
}
