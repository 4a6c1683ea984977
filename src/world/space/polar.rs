use std::f64::consts::FRAC_PI_2;

use super::fan::{Arc, Fan, Sector};
use super::ray::{greater, lesser};
use super::shape::{OrientedBox, Shape};
use crate::geometry::{Aabb, Point, Vector};

/// The nearest obstacle of each beam of a fan: a z-buffer over directions.
///
/// It stores inverse ranges, 0 for nothing. Along a straight face they are linear in the beam's direction, so
/// drawing a face takes two products, a sum and a maximum per beam, without a division.
#[derive(Debug, Clone)]
pub(super) struct PolarBuffer {
    pub(super) fan: Fan,
    inverse: Vec<f64>,
    eye: Point,
}

/// A box as seen from the eye: in the beams of the arc, the body begins beyond both lines.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stroke {
    arc: Arc,
    sector: Sector,
    /// For each of two lines, the unit vector towards it divided by its distance.
    lines: [Vector; 2],
    /// Whether the eye is in the box; then the other fields are undefined.
    pub(super) inside: bool,
}

impl PolarBuffer {
    pub(super) fn new(fan: Fan) -> Self {
        Self { inverse: vec![0.0; fan.beams()], fan, eye: Point::origin() }
    }

    /// Clears the buffer and sets the position and heading of its beams.
    pub(super) fn aim(&mut self, eye: Point, heading: f64) {
        self.fan.turn_to(heading);
        self.inverse.fill(0.0);
        self.eye = eye;
    }

    /// Writes the ranges of the first beams; infinite beyond `max_range`.
    pub(super) fn ranges(&self, max_range: f64, out: &mut [f64]) {
        let (chunks, rest) = self.inverse[..out.len()].as_chunks::<4>();
        let (ranges, last_ranges) = out.as_chunks_mut::<4>();
        for (ranges, inverses) in ranges.iter_mut().zip(chunks) {
            // In many scans most beams hit nothing, which is detected without a division.
            if inverses.iter().filter(|&&inverse| inverse > 0.0).count() == 0 {
                *ranges = [f64::INFINITY; 4];
            } else {
                invert(inverses, max_range, ranges);
            }
        }
        invert(rest, max_range, last_ranges);
    }

    /// Beams that may hit a box; all of them if the eye is in the box.
    #[inline]
    pub(super) fn sector_of_box(&self, bounds: &Aabb) -> Sector {
        let (min, max) = (bounds.min - self.eye, bounds.max - self.eye);
        let (right, left) = (min.x > 0.0, max.x < 0.0);
        let (above, below) = (min.y > 0.0, max.y < 0.0);
        if !(right || left || above || below) {
            return self.fan.all();
        }
        // Corners that bound the box as seen from each of its eight sides.
        let from = Vector::new(
            if above || !(below || right) { max.x } else { min.x },
            if right || (!left && above) { min.y } else { max.y },
        );
        let to = Vector::new(
            if above || (!below && right) { min.x } else { max.x },
            if left || (!right && above) { min.y } else { max.y },
        );
        self.fan.sector(&Arc { from, to, turn: 1.0 })
    }

    /// Beams that may hit a shape, and the smallest distance to it; all beams and 0 if the eye may be in it.
    #[inline]
    pub(super) fn sector_of(&self, shape: &Shape) -> (Sector, f64) {
        let (near, sector) = match shape {
            Shape::Disc { centre, radius } => {
                let to_centre = centre - self.eye;
                let distance = to_centre.norm();
                (distance - radius, self.sector_of_disc(to_centre, distance, *radius))
            }
            Shape::Box(shape) => {
                ((shape.centre - self.eye).norm() - shape.half.norm(), self.stroke(shape).sector)
            }
        };
        if near > 0.0 { (sector, near) } else { (self.fan.all(), 0.0) }
    }

    /// Whether every beam in a sector has a hit nearer than `near` metres; never for 0 metres.
    #[inline]
    pub(super) fn hides(&self, sector: Sector, near: f64) -> bool {
        let limit = (1.0 + 1e-9) / near;
        let mut hidden = true;
        self.fan.for_each_run(sector, |first, last| {
            hidden = hidden && all_at_least(&self.inverse[first..=last], limit);
        });
        hidden
    }

    /// A box as seen from the eye.
    #[inline]
    pub(super) fn stroke(&self, shape: &OrientedBox) -> Stroke {
        let to_centre = shape.centre - self.eye;
        let axis = shape.axis;
        let normal = Vector::new(-axis.y, axis.x);
        let (seen_along, seen_across) = (-axis.dot(&to_centre), -normal.dot(&to_centre));
        let (along, across) = (seen_along.abs() - shape.half.x, seen_across.abs() - shape.half.y);
        // Selections instead of branches, because half of the predictions would fail.
        let (sees_end, sees_side) = (select(along, 1.0, 0.0), select(across, 1.0, 0.0));
        // From the centre towards the end and side that face the eye.
        let (to_end, to_side) = (1.0_f64.copysign(seen_along), 1.0_f64.copysign(seen_across));
        let (end, side) = (axis * to_end, normal * to_side);
        let (e, s) = (end * shape.half.x, side * shape.half.y);
        // From the far corner of the side to the far corner of the end, if both are visible.
        let from = to_centre + s + e * (1.0 - 2.0 * sees_side);
        let to = to_centre + e + s * (1.0 - 2.0 * sees_end);
        // Seen from the left of its axis, a box's side runs counter-clockwise along the axis.
        let arc = Arc { from, to, turn: to_end * to_side };
        // An invisible line is replaced by the other.
        let per_end = end * (-1.0 / select(along, along, 1.0));
        let per_side = side * (-1.0 / select(across, across, 1.0));
        let first = per_side * sees_side + per_end * (1.0 - sees_side);
        let second = per_end * sees_end + per_side * (1.0 - sees_end);
        let inside = sees_end + sees_side == 0.0;
        Stroke { arc, sector: self.fan.sector(&arc), lines: [first, second], inside }
    }

    /// Draws a box that does not contain the eye.
    #[inline]
    pub(super) fn draw(&mut self, stroke: &Stroke) {
        let fan = &self.fan;
        fan.for_each_exact_run(&stroke.arc, stroke.sector, |first, last| {
            let run = first..=last;
            draw_lines(&fan.cos[run.clone()], &fan.sin[run.clone()], &mut self.inverse[run], &stroke.lines);
        });
    }

    /// Beams that may hit a disc with its centre at a distance greater than its radius.
    #[inline]
    fn sector_of_disc(&self, to_centre: Vector, distance: f64, radius: f64) -> Sector {
        // At least the arcsine from 0 to 1, and for small discs only slightly more.
        let sine = radius / distance;
        let half = sine + (FRAC_PI_2 - 1.0) * sine * sine * sine;
        self.fan.sector_about(to_centre, half)
    }

    /// Draws a disc; true if the eye is in it.
    pub(super) fn draw_disc(&mut self, centre: Point, radius: f64) -> bool {
        let to_centre = centre - self.eye;
        let distance = to_centre.norm();
        if distance <= radius {
            return true;
        }
        // The near and far distances along any beam have the same product, so the far one gives the inverse
        // of the near one.
        let per_product = 1.0 / ((distance - radius) * (distance + radius));
        let fan = &self.fan;
        fan.for_each_run(self.sector_of_disc(to_centre, distance, radius), |first, last| {
            let run = first..last + 1;
            let directions = fan.cos[run.clone()].iter().zip(&fan.sin[run.clone()]);
            for ((c, s), nearest) in directions.zip(&mut self.inverse[run]) {
                let aside = c * to_centre.y - s * to_centre.x;
                let squared = radius * radius - aside * aside;
                let far = c * to_centre.x + s * to_centre.y + greater(squared, 0.0).sqrt();
                let hit = if squared >= 0.0 { far * per_product } else { 0.0 };
                *nearest = greater(hit, *nearest);
            }
        });
        false
    }
}

/// Draws the farther of two lines in some beams. Not inlined, which tells the compiler that the slices do not
/// overlap.
#[inline(never)]
fn draw_lines(cos: &[f64], sin: &[f64], inverse: &mut [f64], [a, b]: &[Vector; 2]) {
    for ((c, s), nearest) in cos.iter().zip(sin).zip(inverse) {
        let both = lesser(c * a.x + s * a.y, c * b.x + s * b.y);
        *nearest = greater(both, *nearest);
    }
}

/// Writes inverses, infinite above a limit.
#[inline]
fn invert(numbers: &[f64], limit: f64, out: &mut [f64]) {
    for (range, number) in out.iter_mut().zip(numbers) {
        let inverse = 1.0 / number;
        *range = if inverse <= limit { inverse } else { f64::INFINITY };
    }
}

/// Whether no number is below a limit.
#[inline]
fn all_at_least(numbers: &[f64], limit: f64) -> bool {
    let (chunks, rest) = numbers.as_chunks::<8>();
    // Eight comparisons at a time, without a branch for each.
    let clear = |chunk: &[f64; 8]| chunk.iter().filter(|&&x| x < limit).count() == 0;
    chunks.iter().all(clear) && rest.iter().all(|&x| x >= limit)
}

/// `positive` if `x` is positive, `otherwise` if not.
#[inline]
fn select(x: f64, positive: f64, otherwise: f64) -> f64 {
    if x > 0.0 { positive } else { otherwise }
}
