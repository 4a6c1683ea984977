use std::fmt;

use crate::parameter::debug_as_sentence;

/// A location in a text file. Lines and columns count from 1, columns in characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Location {
    /// The line.
    pub line: usize,
    /// The column.
    pub column: usize,
}

impl Location {
    /// The first character of a file.
    pub const START: Location = Location { line: 1, column: 1 };
}

/// Why a file could not be read: location, found and expected text.
///
/// A missing file is reported at the line that names it.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}:{column}: found {found}; expected {expected}")]
pub struct FormatError {
    /// File name as given to the reader.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Text found there.
    pub found: String,
    /// Text expected there.
    pub expected: String,
}

debug_as_sentence!(FormatError);

impl FormatError {
    /// An error from its parts.
    pub fn new(file: &str, at: Location, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self {
            file: file.into(),
            line: at.line,
            column: at.column,
            found: found.into(),
            expected: expected.into(),
        }
    }

    /// Its location.
    pub fn location(&self) -> Location {
        Location { line: self.line, column: self.column }
    }
}

/// A problem in a file that its reader could work around.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Warning {
    /// File name as given to the reader.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The problem and the reader's workaround.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}: {}", self.file, self.line, self.column, self.message)
    }
}

/// Content of a file, with warnings.
#[derive(Debug, Clone, PartialEq)]
pub struct Parsed<T> {
    /// Content of the file.
    pub value: T,
    /// Warnings in the order of their occurrence; at most [`Parsed::MAX_WARNINGS`].
    pub warnings: Vec<Warning>,
}

impl<T> Parsed<T> {
    /// Largest number of warnings; the limit keeps a broken file from filling the memory.
    pub const MAX_WARNINGS: usize = 1000;

    /// Another value with the same warnings.
    pub fn map<U>(self, change: impl FnOnce(T) -> U) -> Parsed<U> {
        Parsed { value: change(self.value), warnings: self.warnings }
    }
}

/// Collects the warnings about a file and the files that it names.
#[derive(Debug)]
pub(super) struct Notes<'f> {
    pub(super) file: &'f str,
    list: Vec<Warning>,
}

impl<'f> Notes<'f> {
    pub(super) fn new(file: &'f str) -> Self {
        Self { file, list: Vec::new() }
    }

    pub(super) fn warn(&mut self, at: Location, message: impl Into<String>) {
        let (file, message) = (self.file.to_string(), message.into());
        self.extend([Warning { file, line: at.line, column: at.column, message }]);
    }

    /// Converts an error to a warning that ends with the workaround.
    pub(super) fn get_over(&mut self, error: FormatError, instead: &str) {
        let FormatError { file, line, column, found, expected } = error;
        let message = format!("found {found}; expected {expected}; {instead}");
        self.extend([Warning { file, line, column, message }]);
    }

    pub(super) fn extend(&mut self, others: impl IntoIterator<Item = Warning>) {
        let room = Parsed::<()>::MAX_WARNINGS - self.list.len();
        self.list.extend(others.into_iter().take(room));
    }

    pub(super) fn finish<T>(self, value: T) -> Parsed<T> {
        Parsed { value, warnings: self.list }
    }
}
