use super::fan::{Arc, Fan};
use super::ray::{greater, lesser};
use super::shape::OrientedBox;
use crate::geometry::{Aabb, Point, Vector};

/// The nearest thing in each beam of a fan: a z-buffer over directions.
///
/// It keeps inverse ranges, 0 for nothing: along a straight face they are linear in the beam's direction, so drawing
/// a face is two products, a sum and a maximum for each beam, without a division.
#[derive(Debug, Clone)]
pub(super) struct PolarBuffer {
    pub(super) fan: Fan,
    inverse: Vec<f64>,
    eye: Point,
}

impl PolarBuffer {
    pub(super) fn new(fan: Fan) -> Self {
        Self { inverse: vec![0.0; fan.beams()], fan, eye: Point::origin() }
    }

    /// Empties the buffer and points its beams from a place in the world.
    pub(super) fn aim(&mut self, eye: Point, heading: f64) {
        self.fan.turn_to(heading);
        self.inverse.fill(0.0);
        self.eye = eye;
    }

    /// Writes the ranges of the beams, infinite beyond `max_range`.
    pub(super) fn ranges(&self, max_range: f64, out: &mut [f64]) {
        for (range, inverse) in out.iter_mut().zip(&self.inverse) {
            let distance = 1.0 / inverse;
            *range = if distance <= max_range { distance } else { f64::INFINITY };
        }
    }

    /// Whether every beam towards a box has hit something before the box, which is `near` metres away.
    #[inline]
    pub(super) fn hides_box(&self, bounds: &Aabb, near: f64) -> bool {
        let (min, max) = (bounds.min - self.eye, bounds.max - self.eye);
        let (right, left) = (min.x > 0.0, max.x < 0.0);
        let (above, below) = (min.y > 0.0, max.y < 0.0);
        if !(right || left || above || below) {
            return false;
        }
        // The corners that bound the box as seen from each of its eight sides.
        let start = Vector::new(
            if above || !(below || right) { max.x } else { min.x },
            if right || !left && above { min.y } else { max.y },
        );
        let end = Vector::new(
            if above || !below && right { min.x } else { max.x },
            if left || !right && above { min.y } else { max.y },
        );
        self.hides(&Arc { start, end }, near)
    }

    /// Whether every beam towards a disc has hit something before it.
    #[inline]
    pub(super) fn hides_disc(&self, centre: Point, radius: f64) -> bool {
        let to_centre = centre - self.eye;
        let distance = to_centre.norm();
        distance > radius && self.hides(&disc_arc(to_centre, radius), distance - radius)
    }

    fn hides(&self, arc: &Arc, near: f64) -> bool {
        let limit = (1.0 + 1e-9) / near;
        let mut hidden = true;
        self.fan.for_each_run(arc, |first, last| {
            hidden = hidden && self.inverse[first..=last].iter().all(|&inverse| inverse >= limit);
        });
        hidden
    }

    /// Draws a box; true if the eye is in it.
    #[inline]
    pub(super) fn draw_box(&mut self, shape: &OrientedBox) -> bool {
        let seen = shape.local(self.eye);
        let (along, across) = (seen.x.abs() - shape.half.x, seen.y.abs() - shape.half.y);
        if along <= 0.0 && across <= 0.0 {
            return true;
        }
        let to_centre = shape.centre - self.eye;
        let axis = shape.axis;
        let normal = Vector::new(-axis.y, axis.x);
        // From the middle towards the end and the side that face the eye.
        let end = if seen.x < 0.0 { -axis } else { axis };
        let side = if seen.y < 0.0 { -normal } else { normal };
        let (e, s) = (end * shape.half.x, side * shape.half.y);
        let (nearest, past_side, past_end) = (to_centre + e + s, to_centre - e + s, to_centre + e - s);
        // Seen from the left of its axis, a box's side runs counter-clockwise along the axis.
        let turns_left = (seen.x < 0.0) == (seen.y < 0.0);
        let arc = |from: Vector, to: Vector| {
            if turns_left { Arc { start: from, end: to } } else { Arc { start: to, end: from } }
        };
        if along <= 0.0 {
            self.draw_face(&arc(past_side, nearest), -side / across);
        } else if across <= 0.0 {
            self.draw_face(&arc(nearest, past_end), -end / along);
        } else {
            self.draw_corner(&arc(past_side, past_end), -side / across, -end / along);
        }
        false
    }

    /// Draws a straight face. `inverse` is the unit vector towards its line, by the distance to it.
    #[inline]
    fn draw_face(&mut self, arc: &Arc, inverse: Vector) {
        let fan = &self.fan;
        fan.for_each_exact_run(arc, |first, last| {
            let directions = fan.cos[first..=last].iter().zip(&fan.sin[first..=last]);
            for ((c, s), nearest) in directions.zip(&mut self.inverse[first..=last]) {
                *nearest = greater(c * inverse.x + s * inverse.y, *nearest);
            }
        });
    }

    /// Draws two faces that meet at a corner towards the eye: a beam is in the body when it has crossed both lines.
    #[inline]
    fn draw_corner(&mut self, arc: &Arc, side: Vector, end: Vector) {
        let fan = &self.fan;
        fan.for_each_exact_run(arc, |first, last| {
            let directions = fan.cos[first..=last].iter().zip(&fan.sin[first..=last]);
            for ((c, s), nearest) in directions.zip(&mut self.inverse[first..=last]) {
                let both = lesser(c * side.x + s * side.y, c * end.x + s * end.y);
                *nearest = greater(both, *nearest);
            }
        });
    }

    /// Draws a disc; true if the eye is in it.
    #[inline]
    pub(super) fn draw_disc(&mut self, centre: Point, radius: f64) -> bool {
        let to_centre = centre - self.eye;
        let distance = to_centre.norm();
        if distance <= radius {
            return true;
        }
        // Near and far distance along any beam have the same product, so the far one gives the near one's inverse.
        let per_product = 1.0 / ((distance - radius) * (distance + radius));
        let fan = &self.fan;
        fan.for_each_run(&disc_arc(to_centre, radius), |first, last| {
            let directions = fan.cos[first..=last].iter().zip(&fan.sin[first..=last]);
            for ((c, s), nearest) in directions.zip(&mut self.inverse[first..=last]) {
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

/// The directions between the two tangents to a disc, from outside it.
#[inline]
fn disc_arc(to_centre: Vector, radius: f64) -> Arc {
    let length = (to_centre.norm_squared() - radius * radius).max(0.0).sqrt();
    let across = Vector::new(-to_centre.y, to_centre.x) * radius;
    let along = to_centre * length;
    Arc { start: along - across, end: along + across }
}
