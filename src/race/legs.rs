//! The legs of which a row of cones may be made, from cone to cone.

use super::cone::{APART, Cone};
use crate::geometry::{Point, Vector, math};

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
}

impl Leg {
    fn new(from: Point, to: usize, place: Point) -> Self {
        let way = place - from;
        let length = way.norm();
        let heading = math::atan2(way.y, way.x);
        Self { to, ends: [from, place], along: way / length, heading, length }
    }
}

/// The legs from a place to so many cones within reach at most, the nearest ones first.
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
