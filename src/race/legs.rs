//! The legs of which a row of cones may be made, from cone to cone.

use std::cell::OnceCell;

use super::cone::Cone;
use crate::geometry::{Point, Vector, cross, math};

/// Metres between two cones of a row at least.
const NEAREST: f64 = 0.3;

/// From a cone, or from where a row begins without one, to a cone that may come next.
#[derive(Debug)]
pub(super) struct Leg {
    /// The cone to which it leads.
    pub(super) to: usize,
    pub(super) ends: [Point; 2],
    /// The unit vector along it, its heading, and how long it is.
    pub(super) along: Vector,
    pub(super) heading: f64,
    pub(super) length: f64,
    /// Cones near it, on its right and on its left.
    crowd: OnceCell<[f64; 2]>,
}

impl Leg {
    fn new(from: Point, to: usize, place: Point) -> Self {
        let way = place - from;
        let length = way.norm();
        let heading = math::atan2(way.y, way.x);
        Self { to, ends: [from, place], along: way / length, heading, length, crowd: OnceCell::new() }
    }

    /// How many cones stand on the side of the lane within some metres of it, if it is one of a left row and if it is one of a
    /// right row. Counted once: it is asked with the same cones and metres always.
    pub(super) fn crowd(&self, cones: &[Cone], within: f64) -> [f64; 2] {
        *self.crowd.get_or_init(|| {
            let mut sides = [0.0; 2];
            for cone in cones {
                let away = cone.position - self.ends[0];
                let (along, right) = (self.along.dot(&away), -cross(self.along, away));
                let is_beside = (NEAREST..self.length - NEAREST).contains(&along);
                if is_beside && (NEAREST..within).contains(&right.abs()) {
                    sides[usize::from(right < 0.0)] += 1.0;
                }
            }
            sides
        })
    }
}

/// The legs from a place to so many cones within reach at most, the nearest ones first.
pub(super) fn legs_from(from: Point, cones: &[Cone], reach: f64, most: usize) -> Vec<Leg> {
    let mut near: Vec<(f64, usize)> = Vec::new();
    for (index, cone) in cones.iter().enumerate() {
        let away = (cone.position - from).norm();
        if (NEAREST..reach).contains(&away) {
            near.push((away, index));
        }
    }
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    near.truncate(most);
    near.into_iter().map(|(_, to)| Leg::new(from, to, cones[to].position)).collect()
}
