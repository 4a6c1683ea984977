use super::shape::OrientedBox;
use crate::geometry::{Aabb, Point, Vector};

/// Largest distance of cells from the origin (m). Things beyond are tested by every query.
const FARTHEST: f64 = 1e7;

/// Width of a tile in cells.
const TILE: u32 = 8;

/// Width of a block in cells.
const BLOCK: usize = 8;

/// A rectangle of cells, inclusive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Cells {
    pub(super) x0: i32,
    pub(super) y0: i32,
    pub(super) x1: i32,
    pub(super) y1: i32,
}

impl Cells {
    #[inline]
    pub(super) fn count(&self) -> usize {
        (self.x1 - self.x0 + 1) as usize * (self.y1 - self.y0 + 1) as usize
    }

    /// Whether this cell is the first common one of two overlapping rectangles, where the pair is visited.
    #[inline]
    pub(super) fn meets_first_at(&self, other: &Cells, x: i32, y: i32) -> bool {
        x == self.x0.max(other.x0) && y == self.y0.max(other.y0)
    }
}

/// Arrangement of a grid's cells.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lattice {
    origin: Point,
    /// Cell size (m), and its inverse.
    pitch: f64,
    per_metre: f64,
    columns: i32,
    rows: i32,
    /// Margin of outlines for cell lookups, larger than any rounding error (m).
    margin: f64,
}

impl Lattice {
    /// Square cells over some bounds: about the requested number, and at most three times as many.
    pub(super) fn covering(bounds: Aabb, cells: usize) -> Self {
        let limit = Point::new(FARTHEST, FARTHEST);
        let (min, max) = (bounds.min.sup(&-limit).inf(&limit), bounds.max.sup(&-limit).inf(&limit));
        let size = max - min;
        let wanted = cells.max(1) as f64;
        let pitch = (size.x * size.y / wanted).sqrt().max(size.x / wanted).max(size.y / wanted).max(1e-3);
        let magnitude = min.coords.amax().max(max.coords.amax());
        let margin = 1e-9 * pitch + 1e-12 * magnitude;
        let per_metre = 1.0 / pitch;
        let count = |extent: f64| ((extent + 2.0 * margin) * per_metre) as i32 + 1;
        Self {
            origin: min - Vector::new(margin, margin),
            pitch,
            per_metre,
            columns: count(size.x),
            rows: count(size.y),
            margin,
        }
    }

    /// Number of places in memory for cells.
    pub(super) fn count(&self) -> usize {
        (self.tiles_in_a_row() * TILE * TILE) as usize * (self.rows as u32).div_ceil(TILE) as usize
    }

    /// Place of a cell in memory: tile by tile, so that what is near in the world is near in memory too.
    #[inline]
    pub(super) fn index(&self, x: i32, y: i32) -> usize {
        let (x, y) = (x as u32, y as u32);
        let tile = (y / TILE) as usize * self.tiles_in_a_row() as usize + (x / TILE) as usize;
        tile * (TILE * TILE) as usize + ((y % TILE) * TILE + x % TILE) as usize
    }

    #[inline]
    fn tiles_in_a_row(&self) -> u32 {
        (self.columns as u32).div_ceil(TILE)
    }

    /// Cells under a box, and whether the whole box is on cells; `None` if there are none.
    #[inline]
    pub(super) fn under(&self, bounds: &Aabb) -> Option<(Cells, bool)> {
        let x0 = (bounds.min.x - self.margin - self.origin.x) * self.per_metre;
        let y0 = (bounds.min.y - self.margin - self.origin.y) * self.per_metre;
        let x1 = (bounds.max.x + self.margin - self.origin.x) * self.per_metre;
        let y1 = (bounds.max.y + self.margin - self.origin.y) * self.per_metre;
        let (columns, rows) = (f64::from(self.columns), f64::from(self.rows));
        if !(x0 < columns && y0 < rows && x1 >= 0.0 && y1 >= 0.0) {
            return None;
        }
        let whole = x0 >= 0.0 && y0 >= 0.0 && x1 < columns && y1 < rows;
        let cells = Cells {
            x0: (x0 as i32).max(0),
            y0: (y0 as i32).max(0),
            x1: (x1 as i32).min(self.columns - 1),
            y1: (y1 as i32).min(self.rows - 1),
        };
        Some((cells, whole))
    }

    /// Visits blocks of cells within reach of a point, with their bounding boxes and distances.
    pub(super) fn for_each_block_near(
        &self,
        point: Point,
        reach: f64,
        mut visit: impl FnMut(Cells, Aabb, f64),
    ) {
        let window = Aabb { min: point, max: point }.inflated(reach);
        let Some((cells, _)) = self.under(&window) else { return };
        for y0 in (cells.y0..=cells.y1).step_by(BLOCK) {
            for x0 in (cells.x0..=cells.x1).step_by(BLOCK) {
                let (x1, y1) = ((x0 + BLOCK as i32 - 1).min(cells.x1), (y0 + BLOCK as i32 - 1).min(cells.y1));
                let corner =
                    |x: i32, y: i32| self.origin + Vector::new(f64::from(x), f64::from(y)) * self.pitch;
                let bounds = Aabb { min: corner(x0, y0), max: corner(x1 + 1, y1 + 1) }.inflated(self.margin);
                let near = distance(&bounds, point);
                if near <= reach {
                    visit(Cells { x0, y0, x1, y1 }, bounds, near);
                }
            }
        }
    }

    /// Visits the cells that a box may overlap, row by row, until `visit` returns false.
    pub(super) fn for_each_under(&self, shape: &OrientedBox, mut visit: impl FnMut(usize) -> bool) -> bool {
        let reach = shape.reach();
        let bounds = Aabb { min: shape.centre - reach, max: shape.centre + reach };
        let Some((cells, _)) = self.under(&bounds) else { return true };
        let (a, half) = (shape.axis, shape.half);
        // Extent of the box across its centre line, along y and x.
        let (across_y, across_x) = (a.x.abs() * half.y, a.y.abs() * half.y);
        for y in cells.y0..=cells.y1 {
            let low = self.origin.y + f64::from(y) * self.pitch - self.margin;
            let high = low + self.pitch + 2.0 * self.margin;
            let (from, to) = if a.y.abs() * half.x > self.margin {
                let p = (low - across_y - shape.centre.y) / a.y;
                let q = (high + across_y - shape.centre.y) / a.y;
                (p.min(q).max(-half.x), p.max(q).min(half.x))
            } else {
                (-half.x, half.x)
            };
            let (p, q) = (shape.centre.x + a.x * from, shape.centre.x + a.x * to);
            let row = Aabb {
                min: Point::new(p.min(q) - across_x, low),
                max: Point::new(p.max(q) + across_x, low + 0.5 * self.pitch),
            };
            let Some((part, _)) = self.under(&row) else { continue };
            for x in part.x0..=part.x1 {
                if !visit(self.index(x, y)) {
                    return false;
                }
            }
        }
        true
    }

    /// Visits the cells along a ray in order, up to `limit` metres. `visit` returns the limit from then on.
    #[inline]
    pub(super) fn walk(
        &self,
        origin: Point,
        direction: Vector,
        limit: f64,
        mut visit: impl FnMut(usize) -> f64,
    ) {
        let x = Axis::new(origin.x - self.origin.x, direction.x, self.pitch, self.columns);
        let y = Axis::new(origin.y - self.origin.y, direction.y, self.pitch, self.rows);
        let enter = x.enter.max(y.enter).max(0.0);
        let leave = x.leave.min(y.leave).min(limit);
        // Written so that a NaN range ends the traversal.
        if !(enter <= leave && enter.is_finite()) {
            return;
        }
        let (mut cx, mut cy) = (x.cell(enter, self.per_metre), y.cell(enter, self.per_metre));
        let (mut next_x, mut next_y) = (x.border_after(cx), y.border_after(cy));
        loop {
            let limit = visit(self.index(cx, cy)).min(leave);
            if next_x < next_y {
                if next_x > limit {
                    return;
                }
                cx += x.step;
                next_x += x.stride;
                if cx < 0 || cx >= self.columns {
                    return;
                }
            } else {
                if next_y > limit {
                    return;
                }
                cy += y.step;
                next_y += y.stride;
                if cy < 0 || cy >= self.rows {
                    return;
                }
            }
        }
    }
}

/// Motion of a ray along one axis of a lattice. Distances are along the ray.
struct Axis {
    /// The origin's coordinate relative to the lattice's border, and its change per metre.
    origin: f64,
    slope: f64,
    /// Distances at which the ray enters and leaves the cells.
    enter: f64,
    leave: f64,
    /// Offset to the next cell, and the distance to it.
    step: i32,
    stride: f64,
    pitch: f64,
    cells: i32,
}

impl Axis {
    #[inline]
    fn new(origin: f64, slope: f64, pitch: f64, cells: i32) -> Self {
        let extent = f64::from(cells) * pitch;
        let inverse = 1.0 / slope;
        let (enter, leave, step, stride) = if slope > 0.0 {
            (-origin * inverse, (extent - origin) * inverse, 1, pitch * inverse)
        } else if slope < 0.0 {
            ((extent - origin) * inverse, -origin * inverse, -1, -pitch * inverse)
        } else if (0.0..=extent).contains(&origin) {
            (0.0, f64::INFINITY, 0, f64::INFINITY)
        } else {
            (f64::INFINITY, 0.0, 0, f64::INFINITY)
        };
        Self { origin, slope, enter, leave, step, stride, pitch, cells }
    }

    /// Cell of the ray at a distance.
    #[inline]
    fn cell(&self, distance: f64, per_metre: f64) -> i32 {
        (((self.origin + self.slope * distance) * per_metre) as i32).clamp(0, self.cells - 1)
    }

    /// Distance at which the ray leaves a cell along this axis.
    #[inline]
    fn border_after(&self, cell: i32) -> f64 {
        if self.step == 0 {
            return f64::INFINITY;
        }
        let border = f64::from(if self.step > 0 { cell + 1 } else { cell }) * self.pitch;
        (border - self.origin) / self.slope
    }
}

/// Distance from a box to a point; 0 inside.
fn distance(bounds: &Aabb, point: Point) -> f64 {
    let nearest = point.sup(&bounds.min).inf(&bounds.max);
    (nearest - point).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn every_cell_has_a_place_of_its_own(columns in 1..40_i32, rows in 1..40_i32) {
            let bounds = Aabb::new(Point::origin(), Point::new(f64::from(columns), f64::from(rows)));
            let lattice = Lattice::covering(bounds, (columns * rows) as usize);
            let cells = (0..lattice.rows).flat_map(|y| (0..lattice.columns).map(move |x| (x, y)));
            let mut places: Vec<usize> = cells.map(|(x, y)| lattice.index(x, y)).collect();
            let count = places.len();
            places.sort_unstable();
            places.dedup();
            prop_assert!(places.len() == count && places.iter().all(|&place| place < lattice.count()));
        }
    }
}
