use std::convert::Infallible;

use crate::ParameterError;
use crate::parameter::debug_as_sentence;

/// Invalid image or parameter.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The image has no pixels.
    #[error("the image is {width} x {height} pixels; expected at least one pixel")]
    Empty {
        /// Number of columns.
        width: usize,
        /// Number of rows.
        height: usize,
    },
    /// The stride is shorter than a row.
    #[error("the stride is {stride} bytes; expected at least the {row} bytes of a row")]
    Stride {
        /// Bytes from one row to the next.
        stride: usize,
        /// Bytes in a row.
        row: usize,
    },
    /// The slice is too short for the image.
    #[error("the image has {found} bytes; expected at least {expected}")]
    Truncated {
        /// Length of the slice (bytes).
        found: usize,
        /// Bytes required by size and stride.
        expected: usize,
    },
    /// Two images, or an image and a table, differ in size.
    #[error("the {what} is {} x {}; expected {} x {}", found.0, found.1, expected.0, expected.1)]
    Size {
        /// Which one differs.
        what: &'static str,
        /// Its columns and rows.
        found: (usize, usize),
        /// Expected columns and rows.
        expected: (usize, usize),
    },
    /// The region exceeds its image.
    #[error("the region ends at ({}, {}); expected within {} x {} pixels", end.0, end.1, size.0, size.1)]
    Region {
        /// Column and row one past its last pixel.
        end: (usize, usize),
        /// Columns and rows of the image.
        size: (usize, usize),
    },
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

debug_as_sentence!(ImageError);

/// Allows views where an image is accepted: converting a view never fails.
impl From<Infallible> for ImageError {
    fn from(never: Infallible) -> Self {
        match never {}
    }
}
