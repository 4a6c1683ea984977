//! Features along the sides and at the corners of a room.

use std::f64::consts::{FRAC_PI_3, PI, TAU};

use super::contour::{Contour, Piece};
use super::{RoomFeature, RoomOptions};
use crate::geometry::{Point, Vector, cross, math};
use crate::random::Stream;

/// The wall with curves, doors, wedges and niches along the sides and at the corners.
pub(super) fn decorated(
    stream: &mut Stream,
    options: &RoomOptions,
    corners: &[Point],
) -> (Contour, Vec<RoomFeature>) {
    let n = corners.len();
    let mut features = Vec::new();
    let rounded: Vec<Option<Rounding>> = (0..n)
        .map(|i| {
            let around = [corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n]];
            stream.chance(0.2).then(|| rounding(stream, options, around)).flatten()
        })
        .collect();
    features.extend(rounded.iter().flatten().map(|_| RoomFeature::Rounding));
    let mut contour = Contour::default();
    for i in 0..n {
        let j = (i + 1) % n;
        let from = match &rounded[i] {
            Some(rounding) => {
                contour.add(rounding.arc.clone());
                rounding.end
            }
            None => corners[i],
        };
        let to = rounded[j].as_ref().map_or(corners[j], |rounding| rounding.start);
        let side = Side::new(from, to, options);
        features.extend(side.draw(stream, options, &mut contour));
    }
    (contour, features)
}

/// The arc that rounds a corner, and its ends.
struct Rounding {
    arc: Piece,
    start: Point,
    end: Point,
}

fn rounding(
    stream: &mut Stream,
    options: &RoomOptions,
    [before, corner, after]: [Point; 3],
) -> Option<Rounding> {
    let (into, out) = (corner - before, after - corner);
    let (u, v) = (into / into.norm(), out / out.norm());
    let turn = math::atan2(cross(u, v), u.dot(&v));
    let radius = options.least_radius + stream.between(0.0, 0.7);
    let tangent = radius * math::tan(0.5 * turn.abs());
    if turn.abs() < 0.3 || tangent > 0.4 * into.norm().min(out.norm()) {
        return None;
    }
    let (start, end) = (corner - u * tangent, corner + v * tangent);
    let left = Vector::new(-u.y, u.x) * radius.copysign(turn);
    Some(Rounding { arc: Piece::arc(start, start + left, turn), start, end })
}

/// A straight side with the room to its left.
struct Side {
    from: Point,
    to: Point,
    along: Vector,
    inward: Vector,
    /// Unchanged length at each end, and the length between (m).
    margin: f64,
    room: f64,
}

impl Side {
    fn new(from: Point, to: Point, options: &RoomOptions) -> Self {
        let length = (to - from).norm();
        let along = (to - from) / length.max(1e-9);
        let margin = 2.5 * options.distance;
        let inward = Vector::new(-along.y, along.x);
        Self { from, to, along, inward, margin, room: length - 2.0 * margin }
    }

    /// A point given by metres along the side and into the room.
    fn place(&self, (along, inward): (f64, f64)) -> Point {
        self.from + self.along * along + self.inward * inward
    }

    /// Adds straight walls through some points.
    fn through(&self, contour: &mut Contour, places: &[(f64, f64)]) {
        let points: Vec<Point> = places.iter().map(|&place| self.place(place)).collect();
        contour.lines(self.from, &points, self.to);
    }

    /// Random start of a feature of some width; `None` if there is no room.
    fn begin(&self, stream: &mut Stream, width: f64) -> Option<f64> {
        (width <= self.room).then(|| self.margin + stream.uniform() * (self.room - width))
    }

    /// Adds the side, possibly with a feature.
    fn draw(&self, stream: &mut Stream, options: &RoomOptions, contour: &mut Contour) -> Option<RoomFeature> {
        let feature = match stream.below(10) {
            0 | 1 => self.curve(stream, options, contour),
            2..=4 => self.door(stream, options, contour),
            5 => self.wedge(stream, options, contour),
            6 => self.nook(stream, options, contour),
            _ => None,
        };
        if feature.is_none() {
            self.through(contour, &[]);
        }
        feature
    }

    fn curve(
        &self,
        stream: &mut Stream,
        options: &RoomOptions,
        contour: &mut Contour,
    ) -> Option<RoomFeature> {
        let radius = options.least_radius + stream.between(0.0, 0.8);
        let half = stream.between(0.6, 1.45);
        let chord = 2.0 * radius * math::sin(half);
        let begin = self.begin(stream, chord)?;
        let bulge = stream.chance(0.5);
        let depth = radius * math::cos(half) * if bulge { -1.0 } else { 1.0 };
        let middle = self.place((begin + 0.5 * chord, depth));
        let turn = if bulge { -2.0 * half } else { 2.0 * half };
        let [a, b] = [begin, begin + chord].map(|along| self.place((along, 0.0)));
        contour.lines(self.from, &[], a);
        contour.add(Piece::arc(a, middle, turn));
        contour.lines(b, &[], self.to);
        Some(if bulge { RoomFeature::Bulge } else { RoomFeature::Bay })
    }

    fn door(&self, stream: &mut Stream, options: &RoomOptions, contour: &mut Contour) -> Option<RoomFeature> {
        let width = 2.0 * options.distance + stream.between(0.25, 0.6);
        let x = self.begin(stream, width)?;
        if stream.chance(0.3) {
            let depth = stream.between(0.02, 0.05);
            self.through(contour, &[(x, 0.0), (x, -depth), (x + width, -depth), (x + width, 0.0)]);
            return Some(RoomFeature::ClosedDoor);
        }
        let thickness = stream.between(0.1, 0.25);
        let [left, right] = [0, 1].map(|_| 3.0 * options.distance + stream.between(0.0, 0.5));
        let depth = thickness + 4.0 * options.distance + stream.between(0.0, 0.6);
        let chamber = [
            (x, 0.0),
            (x, -thickness),
            (x - left, -thickness),
            (x - left, -depth),
            (x + width + right, -depth),
            (x + width + right, -thickness),
            (x + width, -thickness),
            (x + width, 0.0),
        ];
        self.through(contour, &chamber);
        Some(RoomFeature::Door)
    }

    /// A wedge into the room, with a sharper tip than other corners.
    fn wedge(
        &self,
        stream: &mut Stream,
        options: &RoomOptions,
        contour: &mut Contour,
    ) -> Option<RoomFeature> {
        let tip = stream.between(TAU - options.corners.1, 0.6 * PI);
        let height = options.distance * stream.between(1.5, 3.5);
        let (apex, width) = triangle(stream, tip, height);
        let x = self.begin(stream, width)?;
        self.through(contour, &[(x, 0.0), (x + apex.x, apex.y), (x + width, 0.0)]);
        Some(RoomFeature::Wedge)
    }

    /// A pointed niche.
    fn nook(&self, stream: &mut Stream, options: &RoomOptions, contour: &mut Contour) -> Option<RoomFeature> {
        let tip = stream.between(options.corners.0, 2.0 * FRAC_PI_3);
        // As deep as the robot needs to get in and out again.
        let reach = 2.0 * options.distance / math::tan(0.5 * tip) + 2.0 * options.distance;
        let height = reach * math::cos(0.5 * tip) + stream.between(0.0, 0.4);
        let (apex, width) = triangle(stream, tip, height);
        let x = self.begin(stream, width)?;
        self.through(contour, &[(x, 0.0), (x + apex.x, -apex.y), (x + width, 0.0)]);
        Some(RoomFeature::Nook)
    }
}

/// A triangle over a straight side with a tip angle, more or less asymmetric: the tip and the width.
fn triangle(stream: &mut Stream, tip: f64, height: f64) -> (Vector, f64) {
    let share = stream.between(0.35, 0.65);
    let [left, right] = [share, 1.0 - share].map(|share| height / math::tan(share * (PI - tip)));
    (Vector::new(left, height), left + right)
}
