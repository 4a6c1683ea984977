//! Sequential events of a YAML file, with locations and error messages.

use saphyr_parser::{Event, Parser, Span, StrInput};

use super::error::{FormatError, Location};
use super::lexer::shown;

/// Reads events.
pub(crate) struct YamlEvents<'a> {
    parser: Parser<'a, StrInput<'a>>,
    file: &'a str,
    /// Expected content of the file, for messages.
    content: &'static str,
}

impl<'a> YamlEvents<'a> {
    pub(crate) fn new(text: &'a str, file: &'a str, content: &'static str) -> Self {
        Self { parser: Parser::new_from_str(text), file, content }
    }

    /// Advances to the first key of the file.
    pub(crate) fn enter(&mut self) -> Result<(), FormatError> {
        match self.first()? {
            (Event::MappingStart(..), _) => Ok(()),
            (event, at) => Err(self.unexpected(&event, at, self.content)),
        }
    }

    /// First event of the file's content.
    pub(crate) fn first(&mut self) -> Result<(Event<'a>, Location), FormatError> {
        loop {
            match self.next()? {
                (Event::StreamStart | Event::DocumentStart(_), _) => {}
                found => return Ok(found),
            }
        }
    }

    pub(crate) fn next(&mut self) -> Result<(Event<'a>, Location), FormatError> {
        match self.parser.next_event() {
            Some(Ok((event, span))) => Ok((event, place(span))),
            Some(Err(error)) => {
                let at = Location { line: error.marker().line(), column: error.marker().col() + 1 };
                Err(self.error(at, format!("broken YAML ({})", error.info()), "YAML"))
            }
            None => Err(self.error(Location::START, "the end of the file", self.content)),
        }
    }

    /// A list whose items are read by `item`, with a length limit.
    pub(crate) fn items<T>(
        &mut self,
        (most, what): (usize, &str),
        mut item: impl FnMut(&mut Self, Event<'a>, Location) -> Result<T, FormatError>,
    ) -> Result<Vec<T>, FormatError> {
        let mut items = Vec::new();
        loop {
            match self.next()? {
                (Event::SequenceEnd, _) => return Ok(items),
                (_, at) if items.len() == most => {
                    return Err(self.error(at, format!("one more{what}"), format!("at most {most}{what}s")));
                }
                (event, at) => items.push(item(self, event, at)?),
            }
        }
    }

    pub(crate) fn error(
        &self,
        at: Location,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> FormatError {
        FormatError::new(self.file, at, found, expected)
    }

    pub(crate) fn unexpected(&self, event: &Event<'_>, at: Location, expected: &str) -> FormatError {
        let found = match event {
            Event::Scalar(text, ..) => shown(text),
            Event::SequenceStart(..) => "a list".into(),
            Event::MappingStart(..) => "keys with values".into(),
            Event::Alias(_) => "an alias".into(),
            Event::SequenceEnd => "the end of a list".into(),
            _ => "the end of the file".into(),
        };
        self.error(at, found, expected)
    }
}

fn place(span: Span) -> Location {
    Location { line: span.start.line().max(1), column: span.start.col() + 1 }
}
