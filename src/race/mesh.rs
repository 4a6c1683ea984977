//! Triangulation of cones.

use super::cone::Cone;
use super::error::LineError;
use super::pair::Pair;
use crate::geometry::{Point, Vector, cross};

/// A triangulation. Each of the three half-edges of a triangle represents the gap between its two cones, as
/// seen when entering the triangle by it.
pub(super) struct Mesh {
    /// The cone at the start of each half-edge.
    cones: Vec<usize>,
    twins: Vec<usize>,
    /// Whether triangles are counter-clockwise.
    counter_clockwise: bool,
    gaps: Vec<Gap>,
}

/// The gap between a left and a right cone.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gap {
    pub(super) middle: Point,
    /// Unit vector through it.
    pub(super) forward: Vector,
    pub(super) width: f64,
}

impl Gap {
    fn between(left: Point, right: Point) -> Self {
        let across = left - right;
        let width = across.norm();
        let forward = Vector::new(across.y, -across.x) / width.max(1e-9);
        Self { middle: nalgebra::center(&left, &right), forward, width }
    }

    /// Unit vector from the right cone to the left one.
    fn across(&self) -> Vector {
        Vector::new(-self.forward.y, self.forward.x)
    }
}

/// The leg from one cone to the next on a side.
pub(super) struct Leg {
    /// Index of the cone at its end.
    pub(super) to: usize,
    /// Side, 0 for left.
    pub(super) side: usize,
    /// Unit vector along it.
    pub(super) along: Vector,
    pub(super) length: f64,
}

impl Mesh {
    pub(super) fn new(cones: &[Cone]) -> Result<Self, LineError> {
        if cones.len() < 3 {
            return Err(LineError::TooFew { found: cones.len(), needed: 3 });
        }
        if let Some(index) =
            cones.iter().position(|c| !(c.position.x.is_finite() && c.position.y.is_finite()))
        {
            return Err(LineError::Degenerate { index });
        }
        let points: Vec<_> =
            cones.iter().map(|c| delaunator::Point { x: c.position.x, y: c.position.y }).collect();
        let triangulation = delaunator::triangulate(&points);
        let triangles = triangulation.triangles;
        if triangles.is_empty() {
            return Err(LineError::NoWay);
        }
        let at = |k: usize| cones[triangles[k]].position;
        let counter_clockwise = cross(at(1) - at(0), at(2) - at(0)) > 0.0;
        let gap = |edge: usize| {
            let [a, b] = [at(edge), at(following(edge))];
            if counter_clockwise { Gap::between(a, b) } else { Gap::between(b, a) }
        };
        let gaps = (0..triangles.len()).map(gap).collect();
        Ok(Self { gaps, cones: triangles, twins: triangulation.halfedges, counter_clockwise })
    }

    /// Gaps of all half-edges.
    pub(super) fn gaps(&self) -> &[Gap] {
        &self.gaps
    }

    /// Left and right cone when entering a triangle by a half-edge.
    pub(super) fn pair(&self, edge: usize) -> Pair {
        let (a, b) = (self.cones[edge], self.cones[following(edge)]);
        if self.counter_clockwise { [a, b] } else { [b, a] }
    }

    /// Left and right cone when leaving a triangle by a half-edge.
    pub(super) fn pair_behind(&self, exit: usize) -> Pair {
        let [left, right] = self.pair(exit);
        [right, left]
    }

    /// The two half-edges by which a triangle can be left.
    pub(super) fn exits(edge: usize) -> [usize; 2] {
        [following(edge), preceding(edge)]
    }

    /// The half-edge of the adjacent triangle; `None` at the border.
    pub(super) fn behind(&self, exit: usize) -> Option<usize> {
        let twin = self.twins[exit];
        (twin != delaunator::EMPTY).then_some(twin)
    }

    /// The leg passed when a triangle is entered by one half-edge and left by another.
    pub(super) fn leg(&self, edge: usize, exit: usize) -> Leg {
        let [left, right] = self.pair_behind(exit);
        let gap = &self.gaps[third(edge, exit)];
        let length = gap.width;
        if self.pair(edge)[1] == right {
            Leg { to: left, side: 0, along: gap.across(), length }
        } else {
            Leg { to: right, side: 1, along: -gap.across(), length }
        }
    }
}

/// Triangle of a half-edge.
pub(super) fn triangle(edge: usize) -> usize {
    edge / 3
}

/// The third half-edge of a triangle.
fn third(a: usize, b: usize) -> usize {
    9 * triangle(a) + 3 - a - b
}

fn following(edge: usize) -> usize {
    if edge % 3 == 2 { edge - 2 } else { edge + 1 }
}

fn preceding(edge: usize) -> usize {
    if edge.is_multiple_of(3) { edge + 2 } else { edge - 1 }
}
