use std::fmt;

use crate::ParameterError;
use crate::parameter::debug_as_sentence;

/// The result of asking a robot for something.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a robot could not do what it was asked, in the manner of [`std::io::Error`]: a kind to branch on, a sentence
/// for people, and the error underneath, if there is one.
///
/// ```
/// use roverlab::io::{Error, ErrorKind};
/// let error = Error::unsupported("lidar");
/// assert_eq!(error.kind(), ErrorKind::Unsupported);
/// assert_eq!(error.to_string(), "the robot has no lidar");
/// ```
pub struct Error {
    kind: ErrorKind,
    message: String,
    source: Option<Box<dyn std::error::Error + Send + Sync>>,
}

debug_as_sentence!(Error);

/// What kind of thing went wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The robot has no such sensor, actuator or function.
    Unsupported,
    /// The link to the robot or to a device is gone.
    Disconnected,
    /// The answer did not come in time.
    TimedOut,
    /// An argument is out of its range or not a number.
    InvalidInput,
    /// A recording has no more data.
    EndOfLog,
    /// A replayed program did something other than what was recorded.
    Diverged,
    /// Anything else.
    Other,
}

impl Error {
    /// An error of a kind, with a sentence that says what happened.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), source: None }
    }

    /// The robot lacks a device.
    pub fn unsupported(device: impl fmt::Display) -> Self {
        Self::new(ErrorKind::Unsupported, format!("the robot has no {device}"))
    }

    /// An argument is wrong: its name, what was given and what is accepted.
    pub fn invalid_input(name: &str, found: impl fmt::Display, expected: &str) -> Self {
        Self::new(ErrorKind::InvalidInput, format!("{name} is {found}; expected {expected}"))
    }

    /// The same error with the one that caused it.
    #[must_use]
    pub fn with_source(self, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self { source: Some(source.into()), ..self }
    }

    /// Another error as one of a robot's program.
    pub(crate) fn caused_by(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::new(ErrorKind::Other, error.to_string()).with_source(error)
    }

    /// What kind of error this is.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }
}

impl From<ParameterError> for Error {
    fn from(error: ParameterError) -> Self {
        Self::new(ErrorKind::InvalidInput, error.to_string()).with_source(error)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.source.as_ref().map(|source| source.as_ref() as _)
    }
}
