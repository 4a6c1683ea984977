//! Legs of candidate rows, from cone to cone.

use std::cell::OnceCell;

use super::cone::Cone;
use crate::geometry::{Point, Vector, cross, math};

/// Metres between two cones of a row at least.
const NEAREST: f64 = 0.3;

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
    /// Number of cones near it, on its right and on its left.
    crowd: OnceCell<[f64; 2]>,
}

impl Leg {
    fn new(from: Point, to: usize, place: Point) -> Self {
        let way = place - from;
        let length = way.norm();
        let heading = math::atan2(way.y, way.x);
        Self { to, ends: [from, place], along: way / length, heading, length, crowd: OnceCell::new() }
    }

    /// Number of cones on the lane's side within a distance, if it belongs to a left row, and if it belongs
    /// to a right row. Cached: always call it with the same arguments.
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

/// Legs from a point to at most `most` cones within reach, nearest first.
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
