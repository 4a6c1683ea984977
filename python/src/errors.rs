//! Errors of the library as exceptions of Python.

use pyo3::create_exception;
use pyo3::exceptions::{
    PyConnectionError, PyEOFError, PyFileNotFoundError, PyRuntimeError, PyTimeoutError, PyTypeError,
    PyValueError,
};
use pyo3::prelude::*;
use roverlab::ParameterError;
use roverlab::io::{Error, ErrorKind};
use roverlab::nav::grid::PlanError;
use roverlab::vision::ImageError;
use roverlab::world::formats::FormatError;
use roverlab::world::{BitGridError, GridCell};

create_exception!(roverlab, RobotError, PyRuntimeError, "A robot could not do what it was asked to.");
create_exception!(roverlab, UnsupportedError, RobotError, "The robot has no such sensor, motor or function.");
create_exception!(
    roverlab,
    FileFormatError,
    PyValueError,
    "A file or text is not what its format asks for: FILE:LINE:COLUMN: what was found; what was expected."
);
create_exception!(roverlab, NoPathError, PyValueError, "No path leads from the start to the goal.");

/// Any error of a call, on its way to Python.
pub(crate) struct Failure(PyErr);

pub(crate) type Outcome<T> = Result<T, Failure>;

impl Failure {
    /// A wrong value: its name, what was found, what is expected.
    pub(crate) fn value(name: &str, found: impl std::fmt::Display, expected: &str) -> Self {
        Self(PyValueError::new_err(format!("{name} is {found}; expected {expected}")))
    }

    /// A wrong type.
    pub(crate) fn kind(name: &str, found: impl std::fmt::Display, expected: &str) -> Self {
        Self(PyTypeError::new_err(format!("{name} is {found}; expected {expected}")))
    }

    /// A file that does not exist.
    pub(crate) fn no_file(path: &std::path::Path) -> Self {
        Self(PyFileNotFoundError::new_err(format!("{} does not exist; expected a file", path.display())))
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        failure.0
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Self {
        Self(error)
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let message = error.to_string();
        Self(match error.kind() {
            ErrorKind::InvalidInput => PyValueError::new_err(message),
            ErrorKind::Unsupported => UnsupportedError::new_err(message),
            ErrorKind::TimedOut => PyTimeoutError::new_err(message),
            ErrorKind::Disconnected => PyConnectionError::new_err(message),
            ErrorKind::EndOfLog => PyEOFError::new_err(message),
            _ => RobotError::new_err(message),
        })
    }
}

impl From<PlanError> for Failure {
    /// Cells as Python gives them: row and column.
    fn from(error: PlanError) -> Self {
        let shown = |cell: GridCell| format!("({}, {})", cell.row, cell.column);
        match error {
            PlanError::Outside { end, cell, width, height } => {
                let expected = format!("a cell of the grid of {height} rows and {width} columns");
                Self::value(&end.to_string(), shown(cell), &expected)
            }
            PlanError::Blocked { end, cell } => {
                Self::value(&end.to_string(), format!("{}, a blocked cell", shown(cell)), "a free cell")
            }
            PlanError::Unreachable { start, goal } => {
                let message = format!("no path leads from {} to {}", shown(start), shown(goal));
                Self(NoPathError::new_err(message))
            }
            _ => Self(PyValueError::new_err(error.to_string())),
        }
    }
}

impl From<FormatError> for Failure {
    fn from(error: FormatError) -> Self {
        Self(FileFormatError::new_err(error.to_string()))
    }
}

macro_rules! value_errors {
    ($($error:ty),+ $(,)?) => {$(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self(PyValueError::new_err(error.to_string()))
            }
        }
    )+};
}

value_errors!(ParameterError, ImageError, BitGridError);
