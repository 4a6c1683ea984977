//! Rays against the surface: an exact traversal of cells that skips blocks completely below or above the ray.

use super::HeightField;
use super::height_field::height_in;
use super::pyramid::FIRST;
use crate::geometry::{Point3, Vector3};

impl HeightField {
    /// Distance to a ray's first intersection with the surface, from either side (m); infinite if there is
    /// none within `max_range`.
    ///
    /// `direction` is a unit vector. A ray that starts on the surface has distance 0. Near the surface, the
    /// traversal visits each cell; elsewhere it visits blocks, so its cost grows with the logarithm of the
    /// field's size.
    pub fn cast_ray(&self, origin: Point3, direction: Vector3, max_range: f64) -> f64 {
        let Some(mut walk) = Walk::onto(self, origin, direction, max_range) else { return f64::INFINITY };
        walk.first_hit(self)
    }
}

/// Traversal of cells by a ray. Positions are in cells from the corner with the smallest x and y; distances
/// along the ray are in metres.
struct Walk {
    x: Axis,
    y: Axis,
    /// Height of the origin, and its change per metre.
    z: f64,
    rise: f64,
    /// Present and final distance.
    at: f64,
    end: f64,
    column: usize,
    row: usize,
}

/// Motion of a ray along one axis.
struct Axis {
    start: f64,
    speed: f64,
    inverse: f64,
    cells: usize,
}

impl Axis {
    fn new(start: f64, speed: f64, cells: usize) -> Self {
        Self { start, speed, inverse: 1.0 / speed, cells }
    }

    /// Interval in which the ray is over cells.
    fn span(&self) -> (f64, f64) {
        let far = self.cells as f64;
        if self.speed == 0.0 {
            return if (0.0..=far).contains(&self.start) {
                (f64::NEG_INFINITY, f64::INFINITY)
            } else {
                (f64::INFINITY, f64::NEG_INFINITY)
            };
        }
        let (a, b) = (-self.start * self.inverse, (far - self.start) * self.inverse);
        (a.min(b), a.max(b))
    }

    #[inline]
    fn place(&self, distance: f64) -> f64 {
        self.start + self.speed * distance
    }

    /// Cell at a distance, at least `from` and below `to`.
    #[inline]
    fn cell(&self, distance: f64, from: usize, to: usize) -> usize {
        (self.place(distance) as usize).clamp(from, to - 1)
    }

    /// Distance at which the ray leaves the cells `from..to`.
    #[inline]
    fn leaves(&self, from: usize, to: usize) -> f64 {
        if self.speed == 0.0 {
            return f64::INFINITY;
        }
        let border = if self.speed > 0.0 { to } else { from };
        (border as f64 - self.start) * self.inverse
    }

    /// The next cell; `None` beyond the last one.
    #[inline]
    fn beyond(&self, from: usize, to: usize) -> Option<usize> {
        if self.speed > 0.0 { (to < self.cells).then_some(to) } else { from.checked_sub(1) }
    }
}

impl Walk {
    /// The traversal at the ray's first position over cells; `None` if there is none.
    fn onto(field: &HeightField, origin: Point3, direction: Vector3, max_range: f64) -> Option<Self> {
        let start = (origin.xy() - field.area().min).component_mul(&field.per_metre);
        let speed = direction.xy().component_mul(&field.per_metre);
        let x = Axis::new(start.x, speed.x, field.columns() - 1);
        let y = Axis::new(start.y, speed.y, field.rows() - 1);
        let ((x_in, x_out), (y_in, y_out)) = (x.span(), y.span());
        let (at, end) = (x_in.max(y_in).max(0.0), x_out.min(y_out).min(max_range));
        let numbers = origin.coords.iter().chain(&direction).all(|part| part.is_finite());
        // Written so that a NaN range ends here.
        if !(numbers && at <= end && at <= max_range && at.is_finite()) {
            return None;
        }
        let (column, row) = (x.cell(at, 0, x.cells), y.cell(at, 0, y.cells));
        Some(Self { x, y, z: origin.z, rise: direction.z, at, end, column, row })
    }

    fn height(&self, distance: f64) -> f64 {
        self.z + self.rise * distance
    }

    fn first_hit(&mut self, field: &HeightField) -> f64 {
        let pyramid = &field.pyramid;
        // Positive while the ray is above the surface, negative while it is below.
        let mut side = self.clearance(field, self.at);
        if side == 0.0 {
            return self.at;
        }
        let top = pyramid.top();
        let mut level = top;
        loop {
            let size = 1_usize << level;
            let (from_x, from_y) = (self.column & !(size - 1), self.row & !(size - 1));
            let (to_x, to_y) = ((from_x + size).min(self.x.cells), (from_y + size).min(self.y.cells));
            let (leaves_x, leaves_y) = (self.x.leaves(from_x, to_x), self.y.leaves(from_y, to_y));
            let until = leaves_x.min(leaves_y).min(self.end);
            if level > 0 {
                let (a, b) = (self.height(self.at), self.height(until));
                let bounds = pyramid.block(level, self.column, self.row);
                let passes = if side > 0.0 {
                    a.min(b) > f64::from(bounds.high)
                } else {
                    a.max(b) < f64::from(bounds.low)
                };
                if !passes {
                    level = if level == FIRST { 0 } else { level - 1 };
                    continue;
                }
            } else if let Some(hit) = self.hit_in_cell(field, until, &mut side) {
                return hit;
            }
            if until >= self.end {
                return f64::INFINITY;
            }
            let (column, row) = (self.column, self.row);
            let next = if leaves_x <= leaves_y {
                self.x.beyond(from_x, to_x).map(|column| (column, self.y.cell(until, from_y, to_y)))
            } else {
                self.y.beyond(from_y, to_y).map(|row| (self.x.cell(until, from_x, to_x), row))
            };
            let Some(next) = next else { return f64::INFINITY };
            (self.column, self.row) = next;
            self.at = self.at.max(until);
            // Larger blocks need a test only at their start.
            while level < top {
                let above = if level == 0 { FIRST } else { level + 1 };
                if column >> above == self.column >> above && row >> above == self.row >> above {
                    break;
                }
                level = above;
            }
        }
    }

    /// Height of the ray above the surface at a distance, in its present cell (m).
    #[inline]
    fn clearance(&self, field: &HeightField, distance: f64) -> f64 {
        let corners = field.corners(self.column, self.row);
        self.clearance_over(&corners, distance)
    }

    #[inline]
    fn clearance_over(&self, corners: &[f64; 4], distance: f64) -> f64 {
        let x = self.x.place(distance) - self.column as f64;
        let y = self.y.place(distance) - self.row as f64;
        self.height(distance) - height_in(corners, x, y)
    }

    /// Intersection of the ray with the surface between here and `until`, in its present cell. The clearance
    /// is linear in the distance on each side of the cell's diagonal.
    #[inline]
    fn hit_in_cell(&self, field: &HeightField, until: f64, side: &mut f64) -> Option<f64> {
        let corners = field.corners(self.column, self.row);
        let (low, high) = bounds(&corners);
        let (a, b) = (self.height(self.at), self.height(until));
        if (*side > 0.0 && a.min(b) > high) || (*side < 0.0 && a.max(b) < low) {
            return None;
        }
        let mut from = (self.at, self.clearance_over(&corners, self.at));
        let ahead = (self.x.start - self.column as f64) - (self.y.start - self.row as f64);
        let diagonal = ahead / (self.y.speed - self.x.speed);
        let middle = (from.0 < diagonal && diagonal < until).then_some(diagonal);
        for distance in middle.into_iter().chain([until]) {
            let clearance = self.clearance_over(&corners, distance);
            if clearance == 0.0 || (clearance > 0.0) != (*side > 0.0) {
                return Some(crossing(from, (distance, clearance), *side));
            }
            from = (distance, clearance);
        }
        *side = from.1;
        None
    }
}

/// Zero of a clearance that is linear between two distances and starts on the given side.
#[inline]
fn crossing((from, before): (f64, f64), (to, after): (f64, f64), side: f64) -> f64 {
    // Rounding may have changed its sign on the edge between two cells.
    if (before > 0.0) != (side > 0.0) || before == after {
        return from;
    }
    from + (to - from) * (before / (before - after)).clamp(0.0, 1.0)
}

#[inline]
fn bounds(&[a, b, c, d]: &[f64; 4]) -> (f64, f64) {
    let lesser = |a: f64, b: f64| if a < b { a } else { b };
    let greater = |a: f64, b: f64| if a > b { a } else { b };
    (lesser(lesser(a, b), lesser(c, d)), greater(greater(a, b), greater(c, d)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Aabb, Point};
    use crate::random::Stream;
    use proptest::prelude::*;

    fn hills(seed: u64, columns: usize, rows: usize) -> HeightField {
        let mut stream = Stream::new(seed);
        let area = Aabb::new(Point::new(-1.0, 0.5), Point::new(3.0, 3.0));
        HeightField::from_fn(columns, rows, area, |_| stream.between(-0.5, 0.5)).unwrap()
    }

    /// Nearest intersection with all triangles, by their planes.
    fn brute(field: &HeightField, origin: Point3, direction: Vector3, reach: f64) -> f64 {
        let (area, pitch) = (field.area(), field.pitch());
        let corner = |column: usize, row: usize| {
            let at = area.min + pitch.component_mul(&nalgebra::Vector2::new(column as f64, row as f64));
            Point3::new(at.x, at.y, field.sample(column, row))
        };
        let mut nearest = f64::INFINITY;
        for row in 0..field.rows() - 1 {
            for column in 0..field.columns() - 1 {
                let [a, b, c, d] = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| corner(column + x, row + y));
                for [a, b, c] in [[a, b, d], [a, d, c]] {
                    let (u, v) = (b - a, c - a);
                    let p = direction.cross(&v);
                    let det = u.dot(&p);
                    let to = origin - a;
                    let (s, q) = (to.dot(&p) / det, to.cross(&u));
                    let (r, t) = (direction.dot(&q) / det, v.dot(&q) / det);
                    if s >= -1e-12 && r >= -1e-12 && s + r <= 1.0 + 1e-12 && t >= 0.0 && t < nearest {
                        nearest = t;
                    }
                }
            }
        }
        if nearest <= reach { nearest } else { f64::INFINITY }
    }

    fn unit(x: f64, y: f64, z: f64) -> Vector3 {
        Vector3::new(x, y, z).try_normalize(1e-3).unwrap_or(Vector3::x())
    }

    proptest! {
        #![proptest_config(crate::testing::cases(512))]
        #[test]
        fn a_ray_ends_at_the_nearest_triangle(
            seed in any::<u64>(), columns in 2..40_usize, rows in 2..40_usize,
            (x, y, z) in (-2.0..4.0f64, -0.5..4.0f64, -1.5..1.5f64),
            (dx, dy, dz) in (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64), flat in 0..4, reach in 0.0..8.0f64,
        ) {
            let field = hills(seed, columns, rows);
            // Equally often general, level, along an axis, and vertical.
            let direction = match flat { 0 => unit(dx, dy, dz), 1 => unit(dx, dy, 0.0), 2 => unit(dx, 0.0, dz), _ => unit(0.0, 0.0, dz) };
            let origin = Point3::new(x, y, z);
            let (found, expected) = (field.cast_ray(origin, direction, reach), brute(&field, origin, direction, reach));
            let same = found == expected || (found - expected).abs() < 1e-9;
            prop_assert!(same, "{} instead of {}", found, expected);
        }

        #[test]
        fn what_is_not_a_number_hits_nothing(which in 0..7_usize, bad in prop_oneof![Just(f64::NAN), Just(f64::INFINITY)]) {
            let mut parts = [1.0, 1.5, 1.0, 0.0, 0.0, -1.0, 5.0];
            parts[which] = bad;
            let [x, y, z, dx, dy, dz, reach] = parts;
            let found = hills(1, 9, 9).cast_ray(Point3::new(x, y, z), Vector3::new(dx, dy, dz), reach);
            prop_assert!(found == f64::INFINITY || (which == 6 && bad > 0.0));
        }
    }

    #[test]
    fn a_ray_along_an_edge_or_through_samples_is_stopped() {
        let field = hills(3, 17, 11);
        let pitch = field.pitch();
        for row in 0..11 {
            let y = 0.5 + pitch.y * f64::from(row);
            for down in [-1.0, 1.0] {
                let at = Point3::new(-1.0, y, -down * 0.6);
                let towards = unit(4.0, 0.0, down * 1.2);
                assert!(field.cast_ray(at, towards, 10.0).is_finite(), "row {row}");
            }
        }
    }

    #[test]
    fn a_ray_that_starts_on_the_surface_measures_nothing() {
        let area = Aabb::new(Point::origin(), Point::new(2.0, 2.0));
        let level = HeightField::from_fn(3, 3, area, |_| 0.25).unwrap();
        assert_eq!(level.cast_ray(Point3::new(0.3, 0.7, 0.25), Vector3::z(), 1.0), 0.0);
        assert_eq!(level.cast_ray(Point3::new(0.3, 0.7, 0.5), -Vector3::z(), 1.0), 0.25);
        assert_eq!(level.cast_ray(Point3::new(0.3, 0.7, 0.0), Vector3::z(), 1.0), 0.25);
        assert_eq!(level.cast_ray(Point3::new(0.3, 0.7, 0.5), -Vector3::z(), 0.2), f64::INFINITY);
    }
}
