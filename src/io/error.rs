use std::fmt;

use crate::ParameterError;
use crate::parameter::debug_as_sentence;

/// Result of a call to a robot.
pub type Result<T> = std::result::Result<T, Error>;

/// Error of a call to a robot, in the manner of [`std::io::Error`]: a kind for programs, a message for
/// people, and the source error, if any.
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

/// Kind of an [`Error`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The robot has no such sensor, actuator or function.
    Unsupported,
    /// The link to the robot or to a device is lost.
    Disconnected,
    /// The answer came too late.
    TimedOut,
    /// An argument is out of range or NaN.
    InvalidInput,
    /// A recording has no more data.
    EndOfLog,
    /// A replayed program deviated from its recording.
    Diverged,
    /// Anything else.
    Other,
}

impl Error {
    /// Creates an error from its kind and message.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), source: None }
    }

    /// The error of a missing device.
    pub fn unsupported(device: impl fmt::Display) -> Self {
        Self::new(ErrorKind::Unsupported, format!("the robot has no {device}"))
    }

    /// The error of a wrong argument: its name, the value found and the values accepted.
    pub fn invalid_input(name: &str, found: impl fmt::Display, expected: &str) -> Self {
        Self::new(ErrorKind::InvalidInput, format!("{name} is {found}; expected {expected}"))
    }

    /// Adds the source error.
    #[must_use]
    pub fn with_source(self, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self { source: Some(source.into()), ..self }
    }

    /// Wraps another error.
    pub(crate) fn caused_by(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::new(ErrorKind::Other, error.to_string()).with_source(error)
    }

    /// Kind of the error.
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
