use std::convert::Infallible;

use crate::ParameterError;
use crate::parameter::debug_as_sentence;

/// What is wrong with an image or a parameter.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// An image without pixels.
    #[error("the image is {width} x {height} pixels; expected at least one pixel")]
    Empty {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Rows that overlap.
    #[error("the stride is {stride} bytes; expected at least the {row} bytes of a row")]
    Stride {
        /// Bytes from one row to the next.
        stride: usize,
        /// Bytes in a row.
        row: usize,
    },
    /// Too few bytes for the image.
    #[error("the image has {found} bytes; expected at least {expected}")]
    Truncated {
        /// Bytes there.
        found: usize,
        /// Bytes that size and stride ask for.
        expected: usize,
    },
    /// Two images, or an image and a table, that do not fit together.
    #[error("the {what} is {} x {}; expected {} x {}", found.0, found.1, expected.0, expected.1)]
    Size {
        /// Which.
        what: &'static str,
        /// Its columns and rows.
        found: (usize, usize),
        /// Those that it should have.
        expected: (usize, usize),
    },
    /// A region that leaves its image.
    #[error("the region ends at ({}, {}); expected within {} x {} pixels", end.0, end.1, size.0, size.1)]
    Region {
        /// Column and row behind its last pixel.
        end: (usize, usize),
        /// Columns and rows of the image.
        size: (usize, usize),
    },
    /// A parameter out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

debug_as_sentence!(ImageError);

/// What takes an image takes a view of one too, which always is one.
impl From<Infallible> for ImageError {
    fn from(never: Infallible) -> Self {
        match never {}
    }
}
