//! Lengths of octile paths as integers, which add up without rounding and so compare the same everywhere.
//!
//! A straight step counts 33,461 and a diagonal one 47,321. Their ratio is a convergent of the continued
//! fraction of the square root of two, accurate to 3 parts in 10^10: paths of different length with less than
//! 33,461 diagonal steps compare as their true lengths do.

use std::f64::consts::SQRT_2;

use crate::world::GridCell;

/// Costs of the steps of a [`GridSearch`](super::GridSearch) or a [`DStarLite`](super::DStarLite).
///
/// # For implementers
///
/// Return the same cost for the same step: searches and heuristics rely on the lower bound, the length.
pub trait StepCosts {
    /// The cost of a step from a cell to a neighbour, in cell edges: at least its length, which is 1 or the square
    /// root of 2, and at most 10,000. Other values are clamped to this range; NaN counts as its nearer end. Mark
    /// cells as occupied to rule steps out.
    fn cost(&self, from: GridCell, to: GridCell) -> f64;

    /// Whether every step costs its length.
    #[doc(hidden)]
    const UNIFORM: bool = false;
}

/// Steps cost their length.
///
/// ```
/// use roverlab::nav::grid::{StepCosts, UniformCost};
/// use roverlab::world::GridCell;
/// assert_eq!(UniformCost.cost(GridCell::new(0, 0), GridCell::new(1, 0)), 1.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct UniformCost;

impl StepCosts for UniformCost {
    fn cost(&self, from: GridCell, to: GridCell) -> f64 {
        if from.column != to.column && from.row != to.row { SQRT_2 } else { 1.0 }
    }

    const UNIFORM: bool = true;
}

/// Maximum cost of a step, so that the costs of paths do not overflow.
const DEAREST: u64 = 10_000 * STRAIGHT;

/// The cost of a step as a whole number.
#[inline]
pub(super) fn of_step<C: StepCosts>(
    costs: &C,
    diagonal: bool,
    ends: impl FnOnce() -> (GridCell, GridCell),
) -> u64 {
    let length = if diagonal { DIAGONAL } else { STRAIGHT };
    if C::UNIFORM {
        return length;
    }
    let (from, to) = ends();
    fixed(costs.cost(from, to)).clamp(length, DEAREST)
}

/// A whole number in edges of a cell.
pub(super) fn in_cells(cost: u64) -> f64 {
    cost as f64 / STRAIGHT as f64
}

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
