use std::error::Error;
use std::fmt::{self, Display};

use roverlab::picture::SaveError;

use super::Report;

/// Reason why a command ends without its usual report.
#[derive(Debug)]
pub(crate) struct Failure {
    status: u8,
    message: String,
    /// The report of a part of the work, if only that was to be done.
    done: Option<Box<Report>>,
}

impl Failure {
    /// Exit status of a failed run.
    pub(crate) const RUN: u8 = 1;
    /// Exit status of a wrong command line or input file.
    pub(crate) const INPUT: u8 = 2;

    /// The command line or an input file is wrong: what was found, and what was expected.
    pub(crate) fn input(message: impl Display) -> Self {
        Self { status: Self::INPUT, message: message.to_string(), done: None }
    }

    /// An error during the run.
    pub(crate) fn run(message: impl Display) -> Self {
        Self { status: Self::RUN, message: message.to_string(), done: None }
    }

    /// The work ends here, as it was to be done in part.
    pub(crate) fn done(part: Report) -> Self {
        Self { status: 0, message: "a part of the work is done".into(), done: Some(Box::new(part)) }
    }

    /// The report on a part of the work. Fails for other reasons.
    pub(crate) fn into_report(self) -> Result<Report, Self> {
        match self.done {
            Some(report) => Ok(*report),
            None => Err(self),
        }
    }

    /// Its exit status.
    pub(crate) fn status(&self) -> u8 {
        self.status
    }
}

impl Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl From<roverlab::io::Error> for Failure {
    /// The error and its sources, on one line.
    fn from(error: roverlab::io::Error) -> Self {
        let causes = std::iter::successors(error.source(), |error| (*error).source());
        let causes = causes.map(ToString::to_string);
        Self::run(causes.fold(error.to_string(), |text, cause| {
            // A wrapped error repeats its source.
            if text.ends_with(&cause) { text } else { format!("{text}: {cause}") }
        }))
    }
}

impl From<roverlab::ParameterError> for Failure {
    fn from(error: roverlab::ParameterError) -> Self {
        Self::input(error)
    }
}

#[cfg(feature = "ros2")]
impl From<roverlab::io::log::LogError> for Failure {
    fn from(error: roverlab::io::log::LogError) -> Self {
        Self::input(error)
    }
}

impl From<SaveError> for Failure {
    fn from(error: SaveError) -> Self {
        match error {
            SaveError::Extension { .. } | SaveError::NoPng { .. } => Self::input(error),
            _ => Self::run(error),
        }
    }
}
