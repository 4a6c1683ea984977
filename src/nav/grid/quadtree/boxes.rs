//! Intersection of straight lines and boxes (book, section 10.5, Figure 10.10), in integers and so without
//! rounding.

use super::tree::{Leaf, Quadtree};

/// Whether touching a box counts as meeting it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edges {
    /// Boxes exclude their edges: lines may touch them, run along them, and pass through corners.
    Open,
    /// Boxes include their edges: lines may not even touch them.
    Closed,
}

/// Whether the segment from `a` to `b` meets a box between two corners, all given as (x, y) in any unit.
///
/// It does not if all four corners lie on the same side of the line, or if the projections of segment and box
/// on one of the axes are disjoint. `edges` decides about touching. Exact for coordinates up to 2^61.
///
/// ```
/// use roverlab::nav::grid::{Edges, segment_meets_box};
/// let (lower, upper) = ((2, 2), (4, 4));
/// assert!(segment_meets_box((0, 0), (6, 6), lower, upper, Edges::Open), "through the middle");
/// assert!(!segment_meets_box((0, 4), (4, 0), lower, upper, Edges::Open), "it touches a corner");
/// assert!(segment_meets_box((0, 4), (4, 0), lower, upper, Edges::Closed));
/// ```
pub fn segment_meets_box(
    a: (i64, i64),
    b: (i64, i64),
    lower: (i64, i64),
    upper: (i64, i64),
    edges: Edges,
) -> bool {
    let apart = |low: i64, high: i64, from: i64, to: i64| match edges {
        Edges::Open => high <= from || low >= to,
        Edges::Closed => high < from || low > to,
    };
    if apart(a.0.min(b.0), a.0.max(b.0), lower.0, upper.0)
        || apart(a.1.min(b.1), a.1.max(b.1), lower.1, upper.1)
    {
        return false;
    }
    // A point in both projections is in the box.
    if a == b {
        return true;
    }
    let (dx, dy) = (i128::from(b.0) - i128::from(a.0), i128::from(b.1) - i128::from(a.1));
    let side = |x: i64, y: i64| {
        dy.saturating_mul(i128::from(x) - i128::from(a.0))
            - dx.saturating_mul(i128::from(y) - i128::from(a.1))
    };
    let sides =
        [side(lower.0, lower.1), side(upper.0, lower.1), side(lower.0, upper.1), side(upper.0, upper.1)];
    let one_side = match edges {
        Edges::Open => sides.iter().all(|&s| s >= 0) || sides.iter().all(|&s| s <= 0),
        Edges::Closed => sides.iter().all(|&s| s > 0) || sides.iter().all(|&s| s < 0),
    };
    !one_side
}

impl Quadtree {
    /// Whether the segment between two points, in half cells, meets a blocked leaf. Descends only into
    /// squares that it meets.
    pub(super) fn is_met(&self, a: (i64, i64), b: (i64, i64), edges: Edges) -> bool {
        self.levels() > 0 && self.is_met_within(self.levels() - 1, 0, 0, a, b, edges)
    }

    fn is_met_within(
        &self,
        level: usize,
        x: usize,
        y: usize,
        a: (i64, i64),
        b: (i64, i64),
        edges: Edges,
    ) -> bool {
        let leaf = Leaf { column: x << level, row: y << level, size: 1 << level };
        if leaf.column >= self.width() || leaf.row >= self.height() || self.is_clear(level, x, y) {
            return false;
        }
        let (lower, upper) = leaf.half_cells();
        if !segment_meets_box(a, b, lower, upper, edges) {
            return false;
        }
        let quarters = || [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| (2 * x + dx, 2 * y + dy));
        self.is_solid(level, x, y)
            || quarters().into_iter().any(|(x, y)| self.is_met_within(level - 1, x, y, a, b, edges))
    }
}

impl Leaf {
    /// Corners in half cells.
    pub(super) fn half_cells(&self) -> ((i64, i64), (i64, i64)) {
        let (x, y, size) = (2 * self.column as i64, 2 * self.row as i64, 2 * self.size as i64);
        ((x, y), (x + size, y + size))
    }

    /// Centre in half cells.
    pub(super) fn half_centre(&self) -> (i64, i64) {
        ((2 * self.column + self.size) as i64, (2 * self.row + self.size) as i64)
    }
}
