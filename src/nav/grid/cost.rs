//! Lengths of octile paths as integers, which add up without rounding and so compare the same everywhere.
//!
//! A straight step counts 33,461 and a diagonal one 47,321. Their ratio is a convergent of the continued
//! fraction of the square root of two, accurate to 3 parts in 10^10: paths of different length with less than
//! 33,461 diagonal steps compare as their true lengths do.

use std::f64::consts::SQRT_2;

/// A step along an edge of the grid.
pub(super) const STRAIGHT: u64 = 33_461;
/// A step along a diagonal.
pub(super) const DIAGONAL: u64 = 47_321;

/// The length of the shortest octile path between two cells `dx` columns and `dy` rows apart, in free space.
#[inline]
pub(super) fn octile(dx: u32, dy: u32) -> u64 {
    let (short, long) = (dx.min(dy), dx.max(dy));
    STRAIGHT * u64::from(long - short) + DIAGONAL * u64::from(short)
}

/// Length in cells of a number of steps.
pub(super) fn length(straight: u64, diagonal: u64) -> f64 {
    straight as f64 + diagonal as f64 * SQRT_2
}

/// A length in cells as an integer, rounded down.
#[inline]
pub(super) fn fixed(length: f64) -> u64 {
    (length * STRAIGHT as f64) as u64
}

/// An integer above that of a length, which may be infinite.
#[inline]
pub(super) fn limit(length: f64) -> u64 {
    if length.is_finite() { fixed(length) + 1 } else { u64::MAX }
}
