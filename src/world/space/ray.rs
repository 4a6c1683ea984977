use super::shape::{Block, OrientedBox, Shape};
use super::solid::{SolidId, Span};
use super::store::{Placed, Space};
use crate::geometry::{Point, Vector, cross};

/// A ray. Distances along it are horizontal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub(super) origin: Point,
    /// Horizontal unit vector.
    pub(super) direction: Vector,
    /// Height of the origin, and its change per metre.
    pub(super) z: f64,
    pub(super) slope: f64,
}

impl Space {
    /// Distance to the first wall or solid on a level ray (m); infinite if there is none within `max_range`.
    ///
    /// `direction` is a unit vector, and `z` the height of the ray above the floor (m). A ray that starts in
    /// or on an obstacle has distance 0. The solid `except` is ignored.
    pub fn cast_ray(
        &self,
        origin: Point,
        direction: Vector,
        z: f64,
        max_range: f64,
        except: Option<SolidId>,
    ) -> f64 {
        self.cast(&Ray { origin, direction, z, slope: 0.0 }, max_range, except)
    }

    pub(super) fn cast(&self, ray: &Ray, max_range: f64, except: Option<SolidId>) -> f64 {
        let mut nearest = f64::INFINITY;
        let wall = |wall: &Block, nearest: &mut f64| {
            if let Some(hit) = ray.hit_box(&wall.shape, &wall.span) {
                *nearest = lesser(hit, *nearest);
            }
        };
        let solid = |number: u32, nearest: &mut f64| {
            let placed = &self.solids[number as usize];
            if except == Some(SolidId(number)) {
                return;
            }
            if let Some(hit) = ray.hit(placed) {
                *nearest = lesser(hit, *nearest);
            }
            if let Some(hit) = placed.mast.as_ref().and_then(|mast| ray.hit_box(&mast.shape, &mast.span)) {
                *nearest = lesser(hit, *nearest);
            }
        };
        self.grid.loose_walls().iter().for_each(|&n| wall(&self.walls[n as usize], &mut nearest));
        self.grid.loose_solids().iter().for_each(|&n| solid(n, &mut nearest));
        self.grid.lattice.walk(ray.origin, ray.direction, lesser(nearest, max_range), |cell| {
            self.grid.walls_in(cell).iter().for_each(|own| wall(own, &mut nearest));
            self.grid.solids_in(cell).for_each(|&n| solid(n, &mut nearest));
            nearest
        });
        if nearest <= max_range { nearest } else { f64::INFINITY }
    }
}

impl Ray {
    /// Distance to a solid.
    #[inline]
    pub(super) fn hit(&self, placed: &Placed) -> Option<f64> {
        match &placed.shape {
            Shape::Disc { centre, radius } if placed.taper == 0.0 => {
                self.hit_disc(*centre, *radius, &placed.span)
            }
            Shape::Disc { centre, .. } => self.hit_cone(*centre, placed),
            Shape::Box(shape) => self.hit_box(shape, &placed.span),
        }
    }

    /// The radius of a cone is linear along the ray.
    fn hit_cone(&self, centre: Point, cone: &Placed) -> Option<f64> {
        let (radius, shrinks) = (cone.radius_at(self.z), cone.taper * self.slope);
        let to_centre = centre - self.origin;
        let square = 1.0 - shrinks * shrinks;
        let middle = (self.direction.dot(&to_centre) - radius * shrinks) / square;
        let squared = middle * middle - (to_centre.norm_squared() - radius * radius) / square;
        // A ray at least as steep as the cone's side does not hit the side that rays from beside it hit.
        if squared < 0.0 || square <= 0.0 {
            return None;
        }
        let half = squared.sqrt();
        self.first_within(middle - half, middle + half, &cone.span)
    }

    #[inline]
    fn hit_disc(&self, centre: Point, radius: f64, span: &Span) -> Option<f64> {
        let to_centre = centre - self.origin;
        let aside = cross(self.direction, to_centre);
        let squared = radius * radius - aside * aside;
        if squared < 0.0 {
            return None;
        }
        let (along, half) = (self.direction.dot(&to_centre), squared.sqrt());
        self.first_within(along - half, along + half, span)
    }

    #[inline]
    pub(super) fn hit_box(&self, shape: &OrientedBox, span: &Span) -> Option<f64> {
        let to_centre = shape.centre - self.origin;
        let (along, across) = (self.direction.dot(&shape.axis), cross(shape.axis, self.direction));
        // Whether the whole line intersects the box is decided here, once, so that later rounding cannot let
        // it slip through.
        let aside = cross(self.direction, to_centre).abs();
        if aside > shape.half.x * across.abs() + shape.half.y * along.abs() {
            return None;
        }
        let (u_in, u_out) = crossing(shape.axis.dot(&to_centre), shape.half.x, along);
        let (s_in, s_out) = crossing(cross(shape.axis, to_centre), shape.half.y, across);
        self.first_within(greater(u_in, s_in), lesser(u_out, s_out), span)
    }

    /// First distance from 0 between `enter` and `leave` at which the ray's height is in the span.
    #[inline]
    fn first_within(&self, enter: f64, leave: f64, span: &Span) -> Option<f64> {
        if leave < 0.0 {
            return None;
        }
        let enter = greater(enter, 0.0);
        if self.slope == 0.0 {
            return span.contains(self.z).then_some(enter);
        }
        let middle = 0.5 * (span.bottom + span.top) - self.z;
        let (low, high) = crossing(middle, 0.5 * (span.top - span.bottom), self.slope);
        // Rounding may exchange the borders of a line of zero thickness.
        let leave = greater(leave, enter);
        let (enter, leave) = (greater(enter, low), lesser(leave, high));
        (enter <= leave).then_some(enter)
    }
}

/// Interval in which a point that moves from 0 at `speed` is within `half` of `middle`.
#[inline]
fn crossing(middle: f64, half: f64, speed: f64) -> (f64, f64) {
    if speed == 0.0 {
        return (f64::NEG_INFINITY, f64::INFINITY);
    }
    let inverse = 1.0 / speed;
    let (middle, half) = (middle * inverse, half * inverse.abs());
    (middle - half, middle + half)
}

/// Minimum of two numbers, in one instruction.
#[inline]
pub(super) fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Maximum of two numbers, in one instruction.
#[inline]
pub(super) fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
