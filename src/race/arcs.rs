use crate::geometry::{Point, Segment, Vector, cross, math};

/// A closed edge as arcs from cone to cone.
pub(super) struct Arcs<'a> {
    edge: &'a [Point],
    /// The arc that was found last.
    at: Option<usize>,
}

/// Number of arcs to either side of the last one among which the next one is.
const NEXT: usize = 8;

impl<'a> Arcs<'a> {
    pub(super) fn new(edge: &'a [Point]) -> Self {
        Self { edge, at: None }
    }

    fn leg(&self, k: usize) -> Vector {
        let n = self.edge.len();
        self.edge[(k + 1) % n] - self.edge[k % n]
    }

    /// Half the angle of an arc, which turns by half of the turns at its ends (rad).
    fn half_angle(&self, k: usize) -> f64 {
        let turn = |before: Vector, after: Vector| math::atan2(cross(before, after), before.dot(&after));
        let (before, here, after) = (self.leg(k + self.edge.len() - 1), self.leg(k), self.leg(k + 1));
        0.25 * (turn(before, here) + turn(here, after))
    }

    /// How far the arc beside a point of a chord is to the left of it (m), as a parabola. Points come in
    /// driving order.
    pub(super) fn bulge(&mut self, point: Point) -> f64 {
        let n = self.edge.len();
        let chord = |k: &usize| Segment::new(self.edge[k % n], self.edge[(k + 1) % n]);
        let near = self.at.map_or(0..n, |at| at + n - NEXT.min(n)..at + n + NEXT);
        let away = |k: &usize| chord(k).distance_to(point);
        let Some(k) = near.min_by(|a, b| away(a).total_cmp(&away(b))) else { return 0.0 };
        self.at = Some(k % n);
        let half = self.half_angle(k);
        let (leg, from) = (self.leg(k), point - self.edge[k % n]);
        let share = (from.dot(&leg) / leg.norm_squared().max(1e-18)).clamp(0.0, 1.0);
        // Twice the chord times the tangent of half of that angle is four times the sagitta.
        let highest = 2.0 * leg.norm() * math::sin(half) / (1.0 + math::cos(half));
        -highest * share * (1.0 - share)
    }
}
