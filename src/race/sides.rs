//! Sides of a driven path on which cones stand.

use super::cone::Cone;
use crate::geometry::{Point, Vector, cross};

/// Number of legs of a path that are examined together.
const STRETCH: usize = 12;

/// Side of each cone relative to a driven path, 1 for left, by the nearest leg of the path. Paths whose ends
/// are close together are treated as closed. Empty for paths of fewer than two points.
pub(super) fn sides(cones: &[Cone], way: &[Point]) -> Vec<i8> {
    let [first, .., last] = way else { return Vec::new() };
    let n = way.len();
    let legs = if (first - last).norm() < 8.0 { n } else { n - 1 };
    let legs: Vec<Leg> = (0..legs).map(|i| Leg::new(way[i], way[(i + 1) % n])).collect();
    let stretches: Vec<Stretch> = legs.chunks(STRETCH).map(Stretch::new).collect();
    cones.iter().map(|cone| side_of(&stretches, cone.position)).collect()
}

/// A leg of a path, and the inverse of its squared length.
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

/// Several legs, and a disc that contains them.
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

/// The leg of a path nearest to a point.
struct Nearest {
    squared: f64,
    /// The leg; `away` leads from its start to the point.
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
    // Skip stretches whose disc is farther away; NaN is not farther.
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
