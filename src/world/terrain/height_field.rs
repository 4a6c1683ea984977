use super::pyramid::{FIRST, Pyramid};
use crate::ParameterError;
use crate::geometry::{Aabb, Point, Vector, Vector3};
use crate::parameter::require;

/// A surface over a rectangle, from elevations at grid points.
///
/// A cell between four samples is two triangles with a common diagonal from its corner with the smallest x
/// and y to that with the largest x and y. Columns run along x and rows along y, from the corner with the
/// smallest x and y.
///
/// ```
/// use roverlab::geometry::{Aabb, Point, Point3, Vector, Vector3};
/// use roverlab::world::HeightField;
///
/// let area = Aabb::new(Point::origin(), Point::new(4.0, 2.0));
/// let ramp = HeightField::from_fn(5, 3, area, |at| 0.1 * at.x)?;
/// assert!((ramp.height(Point::new(1.7, 0.3)).unwrap() - 0.17).abs() < 1e-6);
/// assert!((ramp.gradient(Point::new(1.7, 0.3)).unwrap() - Vector::new(0.1, 0.0)).norm() < 1e-6);
/// assert_eq!(ramp.height(Point::new(5.0, 0.3)), None);
/// let down = ramp.cast_ray(Point3::new(2.0, 1.0, 1.0), -Vector3::z(), 10.0);
/// assert!((down - 0.8).abs() < 1e-6);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct HeightField {
    columns: usize,
    rows: usize,
    area: Aabb,
    /// Distance between samples (m), and its inverse.
    pub(super) pitch: Vector,
    pub(super) per_metre: Vector,
    /// Rows from the lowest.
    heights: Vec<f32>,
    pub(super) pyramid: Pyramid,
}

/// A position in a cell: the cell, and the fractions along x and y.
#[derive(Debug, Clone, Copy)]
struct Spot {
    column: usize,
    row: usize,
    share: Vector,
}

impl HeightField {
    /// Largest number of samples along an axis.
    pub const MAX_SAMPLES: usize = 4097;
    /// Largest absolute value of a coordinate or elevation (m).
    const FARTHEST: f64 = 1e6;

    /// A surface from samples (m), in rows starting at the smallest y. The outer samples are on the border of
    /// `area`.
    ///
    /// Fails for fewer than two or more than 4097 samples along an axis, for a number of heights other than
    /// `columns · rows`, for an area without width or height, and for numbers that are not finite or beyond
    /// 1000 km.
    pub fn new(columns: usize, rows: usize, area: Aabb, heights: Vec<f32>) -> Result<Self, ParameterError> {
        for (name, count) in [("terrain columns", columns), ("terrain rows", rows)] {
            require(name, count as f64, (2..=Self::MAX_SAMPLES).contains(&count), "2 to 4097")?;
        }
        let right = heights.len() == columns * rows;
        require("number of heights", heights.len() as f64, right, "a height for each column and row")?;
        let within = |value: f64| value.abs() <= Self::FARTHEST;
        for corner in [area.min.x, area.min.y, area.max.x, area.max.y] {
            require("terrain corner", corner, within(corner), "within 1000 km of the origin")?;
        }
        let size = area.size();
        for (name, side) in [("terrain width", size.x), ("terrain height", size.y)] {
            require(name, side, side > 0.0, "more than 0")?;
        }
        if let Some(&height) = heights.iter().find(|&&height| !within(f64::from(height))) {
            return Err(ParameterError::new("terrain elevation", f64::from(height), "at most 1000 km"));
        }
        let cells = Vector::new((columns - 1) as f64, (rows - 1) as f64);
        let pyramid = Pyramid::over(columns, rows, &heights);
        let (pitch, per_metre) = (size.component_div(&cells), cells.component_div(&size));
        Ok(Self { columns, rows, area, pitch, per_metre, heights, pyramid })
    }

    /// A surface through a function's values at its samples.
    pub fn from_fn(
        columns: usize,
        rows: usize,
        area: Aabb,
        mut height: impl FnMut(Point) -> f64,
    ) -> Result<Self, ParameterError> {
        let size = area.size();
        let (last_column, last_row) = (columns.saturating_sub(1).max(1), rows.saturating_sub(1).max(1));
        let mut heights = Vec::new();
        for row in 0..rows.min(Self::MAX_SAMPLES) {
            for column in 0..columns.min(Self::MAX_SAMPLES) {
                let share = Vector::new(column as f64 / last_column as f64, row as f64 / last_row as f64);
                heights.push(height(area.min + size.component_mul(&share)) as f32);
            }
        }
        Self::new(columns, rows, area, heights)
    }

    /// Number of samples along x.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of samples along y.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The rectangle that it covers.
    pub fn area(&self) -> Aabb {
        self.area
    }

    /// Distance between samples along x and y (m).
    pub fn pitch(&self) -> Vector {
        self.pitch
    }

    /// Elevation of a sample (m).
    ///
    /// # Panics
    ///
    /// If there is no such column or row.
    #[inline]
    pub fn sample(&self, column: usize, row: usize) -> f64 {
        assert!(column < self.columns, "column {column} of {}", self.columns);
        f64::from(self.heights[row * self.columns + column])
    }

    /// Number of samples per metre along x and y.
    pub(crate) fn per_metre(&self) -> Vector {
        self.per_metre
    }

    /// Level of the smallest block of `1 << level` cells in each direction that contains all cells.
    pub(crate) fn top_level(&self) -> u32 {
        self.pyramid.top()
    }

    /// Lowest and highest elevation of the block of `1 << level` cells in each direction that contains a
    /// cell.
    pub(crate) fn bounds(&self, level: u32, column: usize, row: usize) -> (f64, f64) {
        let bounds = self.pyramid.block(level, column, row);
        (f64::from(bounds.low), f64::from(bounds.high))
    }

    /// Lowest elevation (m).
    pub fn lowest(&self) -> f64 {
        f64::from(self.pyramid.whole().low)
    }

    /// Highest elevation (m).
    pub fn highest(&self) -> f64 {
        f64::from(self.pyramid.whole().high)
    }

    /// Upper bound of the elevation in a rectangle; some place not much farther away reaches it. -∞ beyond
    /// the surface. O(1).
    pub fn upper_bound(&self, area: &Aabb) -> f64 {
        let (low, high) = (area.min.sup(&self.area.min), area.max.inf(&self.area.max));
        if !(low.x <= high.x && low.y <= high.y) {
            return f64::NEG_INFINITY;
        }
        let cell = |point: Point| {
            let place = (point - self.area.min).component_mul(&self.per_metre);
            ((place.x as usize).min(self.columns - 2), (place.y as usize).min(self.rows - 2))
        };
        let ((left, below), (right, above)) = (cell(low), cell(high));
        let size = (right - left).max(above - below).max(1);
        let level = size.ilog2().clamp(FIRST, self.pyramid.top());
        let mut highest = f32::NEG_INFINITY;
        for row in (below >> level)..=(above >> level) {
            for column in (left >> level)..=(right >> level) {
                highest = highest.max(self.pyramid.block(level, column << level, row << level).high);
            }
        }
        f64::from(highest)
    }

    /// Elevation at a point (m); `None` beyond the surface.
    #[inline]
    pub fn height(&self, point: Point) -> Option<f64> {
        self.spot(point).map(|spot| self.height_at(&spot))
    }

    /// Slope along x and y (m/m); `None` beyond the surface. On an edge between two triangles it is the
    /// gradient of one of them.
    #[inline]
    pub fn gradient(&self, point: Point) -> Option<Vector> {
        self.spot(point).map(|spot| self.gradient_at(&spot))
    }

    /// Upward unit normal of the surface; `None` beyond it.
    #[inline]
    pub fn normal(&self, point: Point) -> Option<Vector3> {
        self.gradient(point).map(|rise| Vector3::new(-rise.x, -rise.y, 1.0).normalize())
    }

    /// Elevation and gradient of the triangle at a point.
    #[inline]
    pub fn height_and_gradient(&self, point: Point) -> Option<(f64, Vector)> {
        self.spot(point).map(|spot| (self.height_at(&spot), self.gradient_at(&spot)))
    }

    #[inline]
    fn spot(&self, point: Point) -> Option<Spot> {
        if !self.area.contains(point) {
            return None;
        }
        let place = (point - self.area.min).component_mul(&self.per_metre);
        // The far border belongs to the last cells.
        let (column, row) = ((place.x as usize).min(self.columns - 2), (place.y as usize).min(self.rows - 2));
        let share = Vector::new(place.x - column as f64, place.y - row as f64);
        Some(Spot { column, row, share })
    }

    /// Elevations of a cell's corners: first those with the smallest y, then those with the largest.
    #[inline]
    pub(super) fn corners(&self, column: usize, row: usize) -> [f64; 4] {
        let first = row * self.columns + column;
        let (near, far) = (&self.heights[first..first + 2], &self.heights[first + self.columns..]);
        [f64::from(near[0]), f64::from(near[1]), f64::from(far[0]), f64::from(far[1])]
    }

    #[inline]
    fn height_at(&self, spot: &Spot) -> f64 {
        height_in(&self.corners(spot.column, spot.row), spot.share.x, spot.share.y)
    }

    #[inline]
    fn gradient_at(&self, spot: &Spot) -> Vector {
        let [a, b, c, d] = self.corners(spot.column, spot.row);
        let rise =
            if spot.share.x >= spot.share.y { Vector::new(b - a, d - b) } else { Vector::new(d - c, c - a) };
        rise.component_mul(&self.per_metre)
    }
}

/// Elevation in a cell with these corners, at fractions along x and y.
#[inline]
pub(super) fn height_in(&[a, b, c, d]: &[f64; 4], x: f64, y: f64) -> f64 {
    if x >= y { a + (b - a) * x + (d - b) * y } else { a + (d - c) * x + (c - a) * y }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area(width: f64, height: f64) -> Aabb {
        Aabb::new(Point::new(-1.0, 2.0), Point::new(-1.0 + width, 2.0 + height))
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn a_plane_is_a_plane_everywhere(
            columns in 2..9_usize, rows in 2..9_usize, (width, height) in (0.1..9.0f64, 0.1..9.0f64),
            (rise_x, rise_y, base) in (-2.0..2.0f64, -2.0..2.0f64, -3.0..3.0f64), (x, y) in (0.0..=1.0f64, 0.0..=1.0f64),
        ) {
            let rise = Vector::new(rise_x, rise_y);
            let area = area(width, height);
            let plane = |at: Point| base + rise.dot(&(at - area.min));
            let field = HeightField::from_fn(columns, rows, area, plane).unwrap();
            let point = area.min + Vector::new(width * x, height * y);
            let (found, gradient) = field.height_and_gradient(point).unwrap();
            // A sample is rounded to 24 bits.
            let error = 3e-6 + 1e-6 * (rise_x.abs() + rise_y.abs()) * 18.0;
            prop_assert!((found - plane(point)).abs() < error, "{} {}", found, plane(point));
            let steep = error * (columns as f64 / width + rows as f64 / height);
            prop_assert!((gradient - rise).norm() < 2.0 * steep);
            let normal = field.normal(point).unwrap();
            prop_assert!((normal.norm() - 1.0).abs() < 1e-12 && normal.z > 0.0);
        }

        #[test]
        fn samples_are_on_the_surface_and_neighbours_agree_on_their_edges(
            seed in any::<u64>(), columns in 2..7_usize, rows in 2..7_usize,
        ) {
            let mut stream = crate::random::Stream::new(seed);
            let area = area(3.0, 2.0);
            let field = HeightField::from_fn(columns, rows, area, |_| stream.between(-1.0, 1.0)).unwrap();
            for row in 0..rows {
                for column in 0..columns {
                    let share = Vector::new(column as f64 / (columns - 1) as f64, row as f64 / (rows - 1) as f64);
                    let at = area.min + area.size().component_mul(&share);
                    let at = at.inf(&area.max);
                    prop_assert!((field.height(at).unwrap() - field.sample(column, row)).abs() < 1e-9);
                    // There is no step slightly to either side.
                    for aside in [-1e-9, 1e-9] {
                        let near = Point::new((at.x + aside).clamp(area.min.x, area.max.x), at.y);
                        prop_assert!((field.height(near).unwrap() - field.sample(column, row)).abs() < 1e-7);
                    }
                }
            }
            prop_assert!(field.lowest() <= field.highest());
        }
    }

    #[test]
    fn a_cell_is_cut_from_least_to_greatest() {
        // A ridge along the diagonal; the other diagonal would make it a valley.
        let field = HeightField::new(2, 2, area(1.0, 1.0), vec![1.0, 0.0, 0.0, 1.0]).unwrap();
        assert_eq!(field.height(Point::new(-0.5, 2.5)), Some(1.0));
        assert_eq!(field.height(Point::new(-0.5, 2.0)), Some(0.5));
    }

    #[test]
    fn bounds_hold_for_every_place_of_a_rectangle() {
        let mut stream = crate::random::Stream::new(5);
        let all = area(9.0, 7.0);
        let field = HeightField::from_fn(40, 30, all, |_| stream.between(-1.0, 1.0)).unwrap();
        for _ in 0..300 {
            let mut corner = || Point::new(stream.between(-2.0, 9.0), stream.between(1.0, 10.0));
            let (a, b) = (corner(), corner());
            let part = Aabb::new(a.inf(&b), a.sup(&b));
            let bound = field.upper_bound(&part);
            assert!(bound <= field.highest());
            for _ in 0..20 {
                let at = Point::new(
                    stream.between(part.min.x, part.max.x),
                    stream.between(part.min.y, part.max.y),
                );
                assert!(field.height(at).is_none_or(|height| height <= bound));
            }
        }
        assert_eq!(
            field.upper_bound(&Aabb::new(Point::new(20.0, 3.0), Point::new(21.0, 4.0))),
            f64::NEG_INFINITY
        );
    }

    #[test]
    fn there_is_nothing_beyond() {
        let field = HeightField::new(2, 2, area(1.0, 1.0), vec![0.0; 4]).unwrap();
        for (x, y) in
            [(-1.1, 2.5), (0.1, 2.5), (-0.5, 1.9), (-0.5, 3.1), (f64::NAN, 2.5), (f64::INFINITY, 2.5)]
        {
            assert_eq!(field.height(Point::new(x, y)), None);
        }
        assert_eq!(field.height(Point::new(0.0, 3.0)), Some(0.0));
    }

    #[test]
    fn nonsense_is_refused_by_name() {
        let refused = |columns, rows, area, heights: Vec<f32>| {
            HeightField::new(columns, rows, area, heights).unwrap_err().name().to_owned()
        };
        let unit = area(1.0, 1.0);
        assert_eq!(refused(1, 2, unit, vec![0.0; 2]), "terrain columns");
        assert_eq!(refused(2, 4098, unit, vec![0.0; 8196]), "terrain rows");
        assert_eq!(refused(2, 2, unit, vec![0.0; 3]), "number of heights");
        assert_eq!(refused(2, 2, unit, vec![0.0, 0.0, f32::NAN, 0.0]), "terrain elevation");
        assert_eq!(refused(2, 2, unit, vec![0.0, 0.0, 2e6, 0.0]), "terrain elevation");
        assert_eq!(refused(2, 2, area(0.0, 1.0), vec![0.0; 4]), "terrain width");
        assert_eq!(refused(2, 2, area(f64::NAN, 1.0), vec![0.0; 4]), "terrain corner");
        assert!(HeightField::from_fn(usize::MAX, 0, unit, |_| 0.0).is_err());
    }
}
