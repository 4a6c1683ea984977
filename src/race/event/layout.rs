//! Layouts of strip and skidpad by the rules, and their registration among cones.

use nalgebra::{Matrix6, Vector6};

use crate::geometry::{Point, Pose, Vector, normalize_angle};
use crate::race::cone::Cone;

/// The edges of an event, given by a few numbers. The placement of cones along an edge differs from site to
/// site.
///
/// In its frame, x is ahead of the car at the start and y to its left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EventShape {
    /// Two straight rows along x.
    Strip {
        /// Distance from the centre line to each row (m).
        half_width: f64,
    },
    /// Two pairs of circles, right and left of the origin, and the lanes along x that lead to it and away
    /// from it.
    Eight {
        /// Distance from the origin to each centre (m).
        apart: f64,
        /// Radius of the inner circles (m).
        inner: f64,
        /// Radius of the outer circles (m).
        outer: f64,
    },
}

/// An edge near a point.
#[derive(Debug, Clone, Copy)]
struct Edge {
    /// Signed distance of the point beyond the edge (m).
    off: f64,
    /// Gradient of that distance in the point; `by_shape` is that in the numbers of the shape.
    by_place: Vector,
    by_shape: [f64; 3],
}

/// Distance along x from the origin of a skidpad beyond which its lanes are straight (m).
const LANES: f64 = 6.5;

impl EventShape {
    /// A strip as wide as the rules let it be at least.
    pub const STRIP: Self = Self::Strip { half_width: 1.5 };
    /// The skidpad of the rules of Formula Student: centres 18.25 m from each other, circles of 15.25 and
    /// 21.25 m.
    pub const EIGHT: Self = Self::Eight { apart: 9.125, inner: 7.625, outer: 10.625 };

    /// Its numbers (m).
    pub(super) fn numbers(&self) -> [f64; 3] {
        match *self {
            Self::Strip { half_width } => [half_width, 0.0, 0.0],
            Self::Eight { apart, inner, outer } => [apart, inner, outer],
        }
    }

    /// The same kind of shape with other numbers.
    fn with(&self, [first, inner, outer]: [f64; 3]) -> Self {
        match self {
            Self::Strip { .. } => Self::Strip { half_width: first },
            Self::Eight { .. } => Self::Eight { apart: first, inner, outer },
        }
    }

    /// The shape by the rules, and the permitted deviation of its numbers (m).
    fn ruled(&self) -> (Self, f64) {
        match self {
            Self::Strip { .. } => (Self::Strip { half_width: 1.75 }, 0.5),
            Self::Eight { .. } => (Self::EIGHT, 0.15),
        }
    }

    /// Half the width of the straight lanes (m).
    pub fn half_width(&self) -> f64 {
        match *self {
            Self::Strip { half_width } => half_width,
            Self::Eight { apart, inner, .. } => apart - inner,
        }
    }

    /// The edge nearest to a point.
    fn edge(&self, place: Point) -> Edge {
        let row = |by_shape: [f64; 3]| {
            let side = 1.0_f64.copysign(place.y);
            Edge { off: place.y.abs() - self.half_width(), by_place: Vector::new(0.0, side), by_shape }
        };
        let Self::Eight { apart, inner, outer } = *self else { return row([-1.0, 0.0, 0.0]) };
        let arm = place - Point::new(0.0, apart.copysign(place.y));
        let distance = arm.norm().max(1e-9);
        let outwards = arm / distance;
        let by_apart = -outwards.y.copysign(outwards.y * place.y);
        let circles = [(inner, [by_apart, -1.0, 0.0]), (outer, [by_apart, 0.0, -1.0])];
        let circles =
            circles.map(|(radius, by_shape)| Edge { off: distance - radius, by_place: outwards, by_shape });
        let nearer = |a: Edge, b: Edge| if b.off.abs() < a.off.abs() { b } else { a };
        let nearest = nearer(circles[0], circles[1]);
        if place.x.abs() > LANES { nearer(nearest, row([-1.0, 1.0, 0.0])) } else { nearest }
    }
}

/// A layout: edges at a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EventLayout {
    /// Frame of the shape.
    pub pose: Pose,
    /// Edges in that frame.
    pub shape: EventShape,
}

/// Distance from an edge within which a cone belongs to it (m).
pub(super) const AT_EDGE: f64 = 0.4;
/// The same distance while a layout is being searched (m).
const GATE: f64 = 0.8;
/// Placement error of cones at an edge, and the error beyond which they count less (m).
const PLACED: (f64, f64) = (0.1, 0.3);
/// Minimum fraction of all cones that stand at edges: for a layout to be found, to be followed, and where
/// only the cones identify the event.
const SHARES: [f64; 3] = [0.6, 0.4, 0.9];
/// Minimum number of these cones.
const FEWEST: usize = 3;
/// Maximum motion of a layout between two observations, in the frame of a map that drifts (m, m, rad).
const MOVES: [f64; 3] = [0.05, 0.05, 0.01];

impl EventLayout {
    /// Searches for a strip or a skidpad among cones, for a car that stands before its start. `None` if no
    /// layout fits the cones, or too few of them are visible. O(n) for n cones.
    ///
    /// ```
    /// use roverlab::race::{Cone, EventLayout, EventShape};
    /// use roverlab::geometry::{Point, Pose};
    /// let row = |y: f64| (0..5).map(move |k| Cone::unknown(Point::new(5.0 * f64::from(k), y)));
    /// let cones: Vec<Cone> = row(1.9).chain(row(-1.9)).collect();
    /// let found = EventLayout::find(&cones, Pose::new(-2.0, 0.2, 0.05), EventShape::STRIP).unwrap();
    /// assert!((found.shape.half_width() - 1.9).abs() < 0.05 && found.pose.heading.abs() < 0.01);
    /// // The origin of a strip is at the car's position, on the centre line.
    /// assert!((found.pose.position() - Point::new(-2.0, 0.0)).norm() < 0.05);
    /// ```
    pub fn find(cones: &[Cone], car: Pose, shape: EventShape) -> Option<Self> {
        let mut best: Option<(f64, Self)> = None;
        for start in Self::guesses(car, shape) {
            let score = start.score(cones);
            if best.is_none_or(|(before, _)| score > before) {
                best = Some((score, start));
            }
        }
        let (_, mut found) = best?;
        for _ in 0..20 {
            found.improve(cones, [0.3, 0.3, 0.1]);
        }
        if matches!(shape, EventShape::Strip { .. }) {
            // Nothing determines where a strip begins.
            let ahead = found.pose.to_local(car.position()).x;
            found.pose = found.pose.compose(&Pose::new(ahead, 0.0, 0.0));
        }
        (found.holds(cones, SHARES[0]) && found.has_both_hands(cones)).then_some(found)
    }

    /// Initial guesses of the layout around a car before the start.
    fn guesses(car: Pose, shape: EventShape) -> impl Iterator<Item = Self> {
        let (begins, widths) = match shape {
            EventShape::Strip { .. } => (0..1, 5),
            EventShape::Eight { .. } => (12..56, 1),
        };
        begins.flat_map(move |ahead| {
            (-5..=5).flat_map(move |turn| {
                (-3..=3).flat_map(move |aside| {
                    (0..widths).map(move |wide| {
                        let [ahead, turn, aside] = [ahead, turn, aside].map(f64::from);
                        let aims = car.compose(&Pose::new(0.0, 0.4 * aside, 0.03 * turn));
                        let pose = aims.compose(&Pose::new(0.5 * ahead, 0.0, 0.0));
                        let shape = match shape {
                            EventShape::Strip { .. } => {
                                EventShape::Strip { half_width: 1.5 + 0.25 * f64::from(wide) }
                            }
                            EventShape::Eight { .. } => EventShape::EIGHT,
                        };
                        Self { pose, shape }
                    })
                })
            })
        })
    }

    /// Number of cones at edges, weighted by proximity.
    fn score(&self, cones: &[Cone]) -> f64 {
        let near = |cone: &Cone| {
            let off = self.off(cone.position) / AT_EDGE;
            (1.0 - off * off).max(0.0)
        };
        cones.iter().map(near).sum()
    }

    /// Distance of a point beyond the nearest edge (m).
    fn off(&self, place: Point) -> f64 {
        self.shape.edge(self.pose.to_local(place)).off
    }

    /// Whether enough cones are at the edges to keep a layout.
    pub(super) fn fits(&self, cones: &[Cone]) -> bool {
        self.holds(cones, SHARES[1])
    }

    fn holds(&self, cones: &[Cone], share: f64) -> bool {
        let count = self.at_edges(cones).count();
        count >= FEWEST && count as f64 >= share * cones.len() as f64
    }

    pub(super) fn at_edges<'c>(&self, cones: &'c [Cone]) -> impl Iterator<Item = &'c Cone> {
        let layout = *self;
        cones.iter().filter(move |cone| layout.off(cone.position).abs() < AT_EDGE)
    }

    /// Whether cones are on both sides: a single row may be the edge of anything.
    fn has_both_hands(&self, cones: &[Cone]) -> bool {
        let fewest = if matches!(self.shape, EventShape::Strip { .. }) { 2 } else { 4 };
        let on = |side: f64| {
            self.at_edges(cones).filter(|cone| side * self.pose.to_local(cone.position).y > 0.0).count()
        };
        on(1.0) >= fewest && on(-1.0) >= fewest
    }

    /// Whether nearly all cones are at the edges.
    pub(super) fn is_whole(&self, cones: &[Cone]) -> bool {
        self.holds(cones, SHARES[2])
    }

    /// Whether there are cones at the edges of a skidpad beyond the centres of both circles: those of its
    /// lanes could be a strip's.
    pub(super) fn has_circles(&self, cones: &[Cone]) -> bool {
        let EventShape::Eight { apart, .. } = self.shape else { return false };
        let beyond = |side: f64| {
            let aside = |cone: &&Cone| side * self.pose.to_local(cone.position).y > apart;
            self.at_edges(cones).filter(aside).count()
        };
        beyond(1.0) >= FEWEST && beyond(-1.0) >= FEWEST
    }

    /// Follows the cones of a map, whose frame drifts.
    pub(super) fn follow(&mut self, cones: &[Cone]) {
        self.improve(cones, MOVES);
    }

    /// One damped Gauss-Newton step that minimises the distances of cones from their edges, with robust
    /// weights.
    fn improve(&mut self, cones: &[Cone], moves: [f64; 3]) {
        let (ruled, differs) = self.shape.ruled();
        let mut matrix = Matrix6::zeros();
        let mut right = Vector6::zeros();
        for (axis, (number, rule)) in self.shape.numbers().iter().zip(ruled.numbers()).enumerate() {
            matrix[(axis, axis)] = 1.0 / (moves[axis] * moves[axis]);
            matrix[(axis + 3, axis + 3)] = 1.0 / (differs * differs);
            right[axis + 3] = (rule - number) / (differs * differs);
        }
        for cone in cones {
            let place = self.pose.to_local(cone.position);
            let Edge { off, by_place, by_shape: [a, b, c] } = self.shape.edge(place);
            if off.abs() > GATE {
                continue;
            }
            let weight = 1.0 / (PLACED.0 * PLACED.0 * (1.0 + (off / PLACED.1) * (off / PLACED.1)));
            let turn = by_place.x * place.y - by_place.y * place.x;
            let row = Vector6::new(-by_place.x, -by_place.y, turn, a, b, c);
            matrix += row * row.transpose() * weight;
            right -= row * (weight * off);
        }
        let Some(inverse) = matrix.try_inverse() else { return };
        let change = inverse * right;
        if !change.iter().all(|value| value.is_finite()) {
            return;
        }
        self.pose = self.pose.compose(&Pose::new(change[0], change[1], normalize_angle(change[2])));
        let numbers = self.shape.numbers();
        self.shape = self.shape.with([0, 1, 2].map(|k| numbers[k] + change[k + 3]));
    }
}

#[cfg(test)]
mod tests;
