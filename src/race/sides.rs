//! On which side of a way that was driven cones stand.

use super::cone::Cone;
use crate::geometry::{Point, Vector, cross};

/// Legs of a way that are looked at together.
const STRETCH: usize = 12;

/// On which side of a way that was driven before each cone is, 1 for left: by the leg that is nearest to it. Ways whose ends are
/// near each other are closed. Nothing for a way of less than two points.
pub(super) fn sides(cones: &[Cone], way: &[Point]) -> Vec<i8> {
    let [first, .., last] = way else { return Vec::new() };
    let n = way.len();
    let legs = if (first - last).norm() < 8.0 { n } else { n - 1 };
    let legs: Vec<Leg> = (0..legs).map(|i| Leg::new(way[i], way[(i + 1) % n])).collect();
    let stretches: Vec<Stretch> = legs.chunks(STRETCH).map(Stretch::new).collect();
    cones.iter().map(|cone| side_of(&stretches, cone.position)).collect()
}

/// A leg of a way, and the square of its length upside down.
#[derive(Debug, Clone, Copy)]
struct Leg {
    from: Point,
    along: Vector,
    inverse: f64,
}

impl Leg {
    fn new(from: Point, to: Point) -> Self {
        let along = to - from;
        Self { from, along, inverse: 1.0 / along.norm_squared().max(1e-18) }
    }
}

/// Some legs, and a disc in which they all are.
struct Stretch<'l> {
    legs: &'l [Leg],
    middle: Point,
    radius: f64,
}

impl<'l> Stretch<'l> {
    fn new(legs: &'l [Leg]) -> Self {
        let middle = legs[legs.len() / 2].from;
        let ends = legs.iter().flat_map(|leg| [leg.from, leg.from + leg.along]);
        let radius = ends.map(|end| (end - middle).norm()).fold(0.0, f64::max);
        Self { legs, middle, radius }
    }
}

/// The leg of a way that is nearest to a point.
struct Nearest {
    squared: f64,
    /// Along the leg, and from where it begins to the point.
    along: Vector,
    away: Vector,
}

impl Nearest {
    fn look_at(&mut self, legs: &[Leg], point: Point) {
        for leg in legs {
            let away = point - leg.from;
            let share = (away.dot(&leg.along) * leg.inverse).clamp(0.0, 1.0);
            let squared = (away - leg.along * share).norm_squared();
            if squared < self.squared {
                *self = Self { squared, along: leg.along, away };
            }
        }
    }
}

fn side_of(stretches: &[Stretch], point: Point) -> i8 {
    let mut nearest = Nearest { squared: f64::INFINITY, along: Vector::zeros(), away: Vector::zeros() };
    // What is farther than the whole of a disc is needs no look. What is no number is not farther.
    let farthest = |stretch: &Stretch| (point - stretch.middle).norm() + stretch.radius;
    let bound = stretches.iter().map(farthest).fold(f64::INFINITY, f64::min);
    for stretch in stretches {
        let is_farther = (point - stretch.middle).norm() - stretch.radius > bound;
        if !is_farther {
            nearest.look_at(stretch.legs, point);
        }
    }
    if cross(nearest.along, nearest.away) > 0.0 { 1 } else { -1 }
}
