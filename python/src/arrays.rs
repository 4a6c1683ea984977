//! Arrays of numpy from and to values of the library.

use std::fmt;

use numpy::ndarray::Dimension;
use numpy::{
    BorrowError, Element, PyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyOverflowError;
use pyo3::prelude::*;
use roverlab::geometry::Pose;

use crate::errors::{Failure, Outcome};

/// A pose of x, y and heading.
pub(crate) fn pose([x, y, heading]: [f64; 3]) -> Pose {
    Pose::new(x, y, heading)
}

/// x, y and heading of a pose.
pub(crate) fn triple(pose: Pose) -> (f64, f64, f64) {
    (pose.x, pose.y, pose.heading)
}

/// A two-dimensional array that owns the values, row by row.
pub(crate) fn matrix<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    shape: [usize; 2],
) -> Outcome<Bound<'_, PyArray2<T>>> {
    Ok(PyArray1::from_vec(py, values).reshape(shape)?)
}

/// An argument as an array; `expected` says what it should be.
pub(crate) fn array<'a, 'py, T: Element, D: Dimension>(
    name: &str,
    object: &'a Bound<'py, PyAny>,
    expected: &str,
) -> Outcome<&'a Bound<'py, PyArray<T, D>>> {
    object.cast::<PyArray<T, D>>().map_err(|_| match object.cast::<PyUntypedArray>() {
        Ok(array) => {
            let found = format!("an array of {} of shape {}", array.dtype(), shown(array.shape()));
            Failure::kind(name, found, expected)
        }
        Err(_) => Failure::kind(name, object.get_type(), expected),
    })
}

/// An argument as an array to read.
pub(crate) fn readable<'py, T: Element, D: Dimension>(
    name: &str,
    object: &Bound<'py, PyAny>,
    expected: &str,
) -> Outcome<PyReadonlyArray<'py, T, D>> {
    let array = array::<T, D>(name, object, expected)?.try_readonly();
    array.map_err(|error| Failure::value(name, state(&error), "an array that nothing writes to"))
}

/// The error for an array of another shape.
pub(crate) fn wrong_shape(name: &str, found: &[usize], expected: &str) -> Failure {
    Failure::value(name, format!("an array of shape {}", shown(found)), &format!("shape {expected}"))
}

/// A shape as Python writes it.
pub(crate) fn shown(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        shape => format!("({})", shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// Writes values into `out`, or into a new array.
pub(crate) fn filled<'py>(
    py: Python<'py>,
    values: &[f64],
    out: Option<&Bound<'py, PyAny>>,
) -> Outcome<Bound<'py, PyArray1<f64>>> {
    let Some(out) = out else { return Ok(PyArray1::from_slice(py, values)) };
    let out = array::<f64, numpy::Ix1>("out", out, "an array of float64 of one dimension")?;
    let array = out.try_readwrite();
    let mut array = array.map_err(|error| Failure::value("out", state(&error), "a writable array"))?;
    if array.len() != values.len() {
        return Err(wrong_shape("out", array.shape(), &shown(&[values.len()])));
    }
    array.as_array_mut().iter_mut().zip(values).for_each(|(cell, value)| *cell = *value);
    Ok(out.clone())
}

/// A whole number that should not be negative. Its name is known where it is used.
pub(crate) struct Natural(Result<u64, String>);

impl Natural {
    /// Default of indices.
    pub(crate) const ZERO: Self = Self(Ok(0));
    /// Default of seeds and counts.
    pub(crate) const ONE: Self = Self(Ok(1));

    /// Any other default.
    pub(crate) const fn of(number: u64) -> Self {
        Self(Ok(number))
    }

    /// The number; fails if it is negative or too large.
    pub(crate) fn named(self, name: &str) -> Outcome<u64> {
        self.0.map_err(|found| Failure::value(name, found, "a whole number from 0 to 2**64 - 1"))
    }

    /// The number, if it is one.
    pub(crate) fn number(&self) -> Option<u64> {
        self.0.as_ref().ok().copied()
    }

    /// The number as an index.
    pub(crate) fn index(self, name: &str) -> Outcome<usize> {
        self.named(name).map(|number| number as usize)
    }

    /// The number of a motor or a servo, or a shade.
    pub(crate) fn byte(self, name: &str) -> Outcome<u8> {
        self.number()
            .and_then(|number| number.try_into().ok())
            .ok_or_else(|| Failure::value(name, self, "a whole number from 0 to 255"))
    }

    /// The number of pixels along a side.
    pub(crate) fn pixels(self, name: &str) -> Outcome<u32> {
        self.number()
            .and_then(|number| number.try_into().ok())
            .ok_or_else(|| Failure::value(name, self, "a whole number from 0 to 2**32 - 1"))
    }
}

impl fmt::Display for Natural {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Ok(number) => number.fmt(f),
            Err(found) => found.fmt(f),
        }
    }
}

impl FromPyObject<'_, '_> for Natural {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        match object.extract::<u64>() {
            Err(error) if error.is_instance_of::<PyOverflowError>(object.py()) => {
                Ok(Self(Err(object.str()?.to_string())))
            }
            number => Ok(Self(Ok(number?))),
        }
    }
}

/// Why an array cannot be used now.
pub(crate) fn state(error: &BorrowError) -> &'static str {
    match error {
        BorrowError::NotWriteable => "read-only",
        _ => "in use, or in memory that another argument uses",
    }
}
