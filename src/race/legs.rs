//! Legs of candidate rows, from cone to cone.

use super::cone::{APART, Cone};
use crate::geometry::{Point, Vector, math};

/// From a cone, or from the start of a row without one, to a possible next cone.
#[derive(Debug)]
pub(super) struct Leg {
    /// Index of the cone at its end.
    pub(super) to: usize,
    pub(super) ends: [Point; 2],
    /// Unit vector along it, heading (rad) and length (m).
    pub(super) along: Vector,
    pub(super) heading: f64,
    pub(super) length: f64,
}

impl Leg {
    fn new(from: Point, to: usize, place: Point) -> Self {
        let way = place - from;
        let length = way.norm();
        let heading = math::atan2(way.y, way.x);
        Self { to, ends: [from, place], along: way / length, heading, length }
    }
}

/// Legs from a point to at most `most` cones within reach, nearest first.
pub(super) fn legs_from(from: Point, cones: &[Cone], reach: f64, most: usize) -> Vec<Leg> {
    let mut near: Vec<(f64, usize)> = Vec::new();
    for (index, cone) in cones.iter().enumerate() {
        let away = (cone.position - from).norm();
        if (APART..reach).contains(&away) {
            near.push((away, index));
        }
    }
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    near.truncate(most);
    near.into_iter().map(|(_, to)| Leg::new(from, to, cones[to].position)).collect()
}
