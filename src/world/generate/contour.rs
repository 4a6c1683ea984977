//! The outline of walls around a room.

use std::f64::consts::{FRAC_PI_2, PI};

use super::round;
use crate::geometry::{Aabb, Point, Segment, Vector, cross, math, normalize_angle};
use crate::world::Wall;

/// A straight or round part of a contour, as points along it.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    points: Vec<Point>,
}

impl Piece {
    fn line(from: Point, to: Point) -> Self {
        Self { points: vec![from, to] }
    }

    /// An arc from a point about a centre, by an angle counter-clockwise, with facets of at most 40 mm.
    pub(super) fn arc(from: Point, middle: Point, turn: f64) -> Self {
        /// Longest facet of a round contour (m).
        const FACET: f64 = 0.04;
        let arm = from - middle;
        let angle = math::atan2(arm.y, arm.x);
        let mut points = round::arc(middle, arm.norm(), angle, angle + turn, FACET);
        points[0] = from;
        Self { points }
    }

    fn segments(&self) -> impl Iterator<Item = Segment> + '_ {
        self.points.windows(2).map(|ends| Segment::new(ends[0], ends[1]))
    }

    fn length(&self) -> f64 {
        self.segments().map(|segment| segment.length()).sum()
    }

    fn nearest(&self, point: Point) -> Point {
        let closest = self.segments().map(|segment| segment.closest_point(point));
        closest.min_by(|a, b| (a - point).norm().total_cmp(&(b - point).norm())).unwrap_or(point)
    }
}

/// A closed line of walls; the room is to its left.
#[derive(Debug, Clone, Default)]
pub(super) struct Contour {
    pieces: Vec<Piece>,
}

/// Smallest change of direction that counts as a corner (rad).
const CORNER: f64 = 0.25;

impl Contour {
    /// Straight sides between corners.
    pub(super) fn of_corners(corners: &[Point]) -> Self {
        let next = corners.iter().cycle().skip(1);
        Self { pieces: corners.iter().zip(next).map(|(&a, &b)| Piece::line(a, b)).collect() }
    }

    pub(super) fn add(&mut self, piece: Piece) {
        self.pieces.push(piece);
    }

    /// Straight pieces through a sequence of points.
    pub(super) fn lines(&mut self, from: Point, through: &[Point], to: Point) {
        let mut last = from;
        for &point in through.iter().chain([&to]) {
            self.pieces.push(Piece::line(last, point));
            last = point;
        }
    }

    /// All points in order; the first is not repeated.
    fn points(&self) -> Vec<Point> {
        let mut points: Vec<Point> = Vec::new();
        for point in self.pieces.iter().flat_map(|piece| &piece.points) {
            if points.last().is_none_or(|last| (last - point).norm() > 1e-9) {
                points.push(*point);
            }
        }
        points.pop();
        points
    }

    pub(super) fn bounds(&self) -> Aabb {
        Aabb::around(self.points()).unwrap_or(Aabb::new(Point::origin(), Point::origin()))
    }

    /// The corners with their interior angles.
    pub(super) fn corners(&self) -> Vec<(Point, f64)> {
        let points = self.points();
        let n = points.len();
        (0..n)
            .filter_map(|i| {
                let (into, out) = (points[i] - points[(i + n - 1) % n], points[(i + 1) % n] - points[i]);
                let turn = math::atan2(cross(into, out), into.dot(&out));
                (turn.abs() > CORNER).then_some((points[i], PI - turn))
            })
            .collect()
    }

    /// Whether all corner angles are in a range and the line winds once.
    pub(super) fn angles_within(&self, (least, most): (f64, f64)) -> bool {
        let points = self.points();
        let n = points.len();
        let turns = (0..n).map(|i| {
            let (into, out) = (points[i] - points[(i + n - 1) % n], points[(i + 1) % n] - points[i]);
            normalize_angle(math::atan2(out.y, out.x) - math::atan2(into.y, into.x))
        });
        let all: f64 = turns.sum();
        (all - 2.0 * PI).abs() < 1e-6
            && self.corners().iter().all(|(_, angle)| (least..=most).contains(angle))
    }

    pub(super) fn holds(&self, point: Point) -> bool {
        super::figure::Outline::closed(self.points()).holds(point)
    }

    pub(super) fn distance_to(&self, point: Point) -> f64 {
        self.pieces.iter().map(|piece| (piece.nearest(point) - point).norm()).fold(f64::INFINITY, f64::min)
    }

    /// Whether a robot can follow the wall all the way round at a distance, with no other wall nearer and
    /// some margin.
    pub(super) fn can_be_followed(&self, distance: f64) -> bool {
        let lengths: Vec<f64> = self.pieces.iter().map(Piece::length).collect();
        if !self.corners_have_room(distance) {
            return false;
        }
        (0..self.pieces.len()).all(|i| {
            let others: Vec<usize> = strangers(i, &lengths, 1.5 * distance);
            let nearby = |j: usize| j != i && !others.contains(&j);
            // In corners the robot also keeps its distance to the next wall, so it does not use all places.
            let is_used = |place: Point| {
                let near = (0..self.pieces.len()).filter(|&j| nearby(j));
                near.map(|j| (self.pieces[j].nearest(place) - place).norm()).all(|gap| gap > 0.95 * distance)
            };
            self.pieces[i].segments().all(|segment| {
                samples(&segment, 0.25 * distance).all(|(point, inward)| {
                    let place = point + inward * distance;
                    let used = is_used(place);
                    others.iter().all(|&j| {
                        let other = self.pieces[j].nearest(place);
                        let behind = (other - point).dot(&inward) < 0.0;
                        // There may be another room behind the wall, but walls must not cross.
                        if behind || !used {
                            (other - point).norm() > 0.05
                        } else {
                            (other - place).norm() > 1.5 * distance
                        }
                    })
                })
            })
        })
    }

    /// Whether the straight sides between two sharp corners are long enough to drive along.
    fn corners_have_room(&self, distance: f64) -> bool {
        let corners = self.corners();
        let needs = |point: Point| {
            let corner = corners.iter().find(|(place, _)| (place - point).norm() < 1e-6);
            corner.map_or(0.0, |&(_, angle)| if angle < PI { distance / math::tan(0.5 * angle) } else { 0.0 })
        };
        self.pieces.iter().all(|piece| {
            let (first, last) = (piece.points[0], piece.points[piece.points.len() - 1]);
            let taken = needs(first) + needs(last);
            // Sides of doors may be short; sides that the robot drives along may not.
            taken == 0.0 || piece.length() < 0.06 || piece.length() > taken + distance
        })
    }

    /// The walls, shifted. Their faces towards the room are on the line and overlap at corners.
    pub(super) fn walls(&self, shift: Vector) -> Vec<Wall> {
        let points: Vec<Point> = self.points().into_iter().map(|point| point + shift).collect();
        let n = points.len();
        let half = 0.5 * Wall::DEFAULT_THICKNESS;
        let turn = |i: usize| {
            let (into, out) = (points[i] - points[(i + n - 1) % n], points[(i + 1) % n] - points[i]);
            math::atan2(cross(into, out), into.dot(&out))
        };
        (0..n)
            .map(|i| {
                let (a, b) = (points[i], points[(i + 1) % n]);
                let along = (b - a) / (b - a).norm();
                let outward = Vector::new(along.y, -along.x) * half;
                // Where the room's corner is less than a half turn, the outer faces must be longer to meet;
                // above three right angles they would protrude on the other side.
                let more = |turn: f64| {
                    if turn > 0.0 {
                        half * math::tan(0.5 * turn.min(2.0))
                    } else if turn < -FRAC_PI_2 {
                        -2.0 * half / math::tan(PI + turn)
                    } else {
                        0.0
                    }
                };
                let (a, b) = (a - along * more(turn(i)), b + along * more(turn((i + 1) % n)));
                Wall::new(a + outward, b + outward)
            })
            .collect()
    }
}

/// Points along a segment, at most `spacing` apart, with the direction into the room.
fn samples(segment: &Segment, spacing: f64) -> impl Iterator<Item = (Point, Vector)> + use<> {
    let along = segment.b - segment.a;
    let inward = Vector::new(-along.y, along.x) / along.norm();
    let count = (along.norm() / spacing).ceil().max(1.0) as usize;
    let start = segment.a;
    (0..=count).map(move |k| (start + along * (k as f64 / count as f64), inward))
}

/// Pieces farther than `apart` from piece `of` along the line, in both directions.
fn strangers(of: usize, lengths: &[f64], apart: f64) -> Vec<usize> {
    let n = lengths.len();
    let gap = |from: usize, to: usize| -> f64 {
        let steps = (to + n - from) % n;
        (1..steps).map(|k| lengths[(from + k) % n]).sum()
    };
    let is_next = |j: usize| (j + 1) % n == of || (of + 1) % n == j;
    (0..n).filter(|&j| j != of && !is_next(j)).filter(|&j| gap(of, j).min(gap(j, of)) > apart).collect()
}
