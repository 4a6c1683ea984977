//! The rows of cones that a lane lies between, followed from cone to cone from where the car is: a way that passes through one of
//! them leaves the track.
//!
//! Both are followed together, as it takes both to know either one: from a pair of a left and a right cone to the next pair, of
//! which one cone is new. So a row can turn sharply around one cone where the other one goes around it, and goes over to the other
//! edge nowhere.

use super::cone::Cone;
use crate::geometry::{Point, Pose, Vector, cross, math};

#[cfg(test)]
mod tests;

/// How rows are followed.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowParameters {
    /// Metres from cone to cone at most, where one is missing.
    pub(super) reach: f64,
    /// Metres from the middle of the lane to its edge, about.
    pub(super) half_width: f64,
    /// The least that this may be.
    pub(super) narrowest: f64,
    /// Metres by which a cone of an edge may stand off it.
    pub(super) loose: f64,
    /// Radians by which a row turns at most at one cone.
    pub(super) sharpest: f64,
}

/// Pairs that are followed at a time.
const BEAM: usize = 16;
/// Cones of both rows at most.
const LONGEST: usize = 24;
/// Cones beside the car with which a row may begin.
const SEEDS: usize = 3;
/// Cones that may come next, the nearest ones.
const NEXT: usize = 10;
/// Metres ahead of the car, or behind a place where it was, at which a cone is beside it.
const BESIDE: f64 = 2.0;
/// Metres between two cones of a row at least.
const NEAREST: f64 = 0.3;
/// How much farther apart than usual the cones of a pair are at most: where they are farther, one row is missing.
const FARTHER: f64 = 1.7;
/// What it costs that a leg is aslant to the lane, for a radian squared, that it is long, for a metre, that a cone is missing on it,
/// that it turns otherwise than the last one, for a radian squared, that the known edge of a cone is the other one, that the other
/// row is missing, that a pair is narrower or wider than usual, in the square of its share, and that a cone stands between the
/// rows. One more cone is worth 1, and each of a row less than the one before by a share: of what is farther off, less is seen.
const SLANT: f64 = 0.35;
const FAR: f64 = 0.07;
const MISSING: f64 = 0.15;
const CHANGE: f64 = 0.3;
const OTHER_EDGE: f64 = 2.5;
const ALONE: f64 = 0.3;
const WIDTH: f64 = 1.0;
const BETWEEN: f64 = 1.5;
const LESS: f64 = 0.85;
/// What it costs that the cone goes on far better with the other row, and by how much a leg of that has to cost less, from where
/// that begins to count to where it counts fully.
const TAKEN: f64 = 1.0;
const BETTER: [f64; 2] = [0.1, 0.43];
/// What a cone may cost that is followed all the same.
const DEAREST: f64 = 2.4;
/// Rows that are told of at most, where cones may be those of one edge or of the other.
const READINGS: usize = 4;
/// How much less than the best rows others are worth at most that are told of.
const WORSE: f64 = 2.0;

/// The end of a row.
#[derive(Debug, Clone, Copy)]
struct End {
    /// `None` where a row begins without a cone.
    cone: Option<usize>,
    place: Point,
    heading: Vector,
    turn: f64,
    /// What the next cone is worth.
    share: f64,
}

/// A left and a right row, by their ends, and how they got there.
#[derive(Debug, Clone, Copy)]
struct Pair {
    ends: [End; 2],
    worth: f64,
    parent: Option<usize>,
}

/// The rows of a lane.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Rows {
    /// The left and the right one: their cones, by their indices, in their order along the lane.
    pub(super) edges: [Vec<usize>; 2],
    /// How much they look like the edges of a lane, about a cone's worth for each of theirs.
    pub(super) worth: f64,
}

impl Rows {
    /// The legs of both rows, from cone to cone.
    pub(super) fn legs(&self, cones: &[Cone]) -> Vec<[Point; 2]> {
        let leg = |pair: &[usize]| [cones[pair[0]].position, cones[pair[1]].position];
        self.edges.iter().flat_map(|edge| edge.windows(2).map(leg)).collect()
    }

    /// On which side of the lane each of so many cones is, 1 for left, 0 for those of no row.
    pub(super) fn sides(&self, cones: usize) -> Vec<i8> {
        let mut sides = vec![0; cones];
        for (edge, side) in self.edges.iter().zip([1, -1]) {
            for &cone in edge {
                sides[cone] = side;
            }
        }
        sides
    }
}

/// The rows on the left and on the right of a lane, in up to four ways in which cones can be read, the best first: each two of them
/// have some cone at different edges.
///
/// `places` is where the car was and is, oldest first, and `earlier` the way by which it came. A row ends where no cone goes on with
/// it. Takes O(n²) for n cones.
pub(super) fn rows(cones: &[Cone], places: &[Pose], earlier: &[Pose], p: &RowParameters) -> Vec<Rows> {
    let Some(car) = places.last() else { return vec![Rows::default()] };
    let mut search = Search { cones, nearest: nearest(cones, p.reach), earlier, p, pairs: Vec::new() };
    search.begin(places, *car);
    let mut beam: Vec<usize> = (0..search.pairs.len()).collect();
    for _ in 0..LONGEST {
        let mut next: Vec<Pair> = beam.iter().flat_map(|&parent| search.onward(parent)).collect();
        next.sort_by(|a, b| b.worth.total_cmp(&a.worth));
        beam.clear();
        for pair in next {
            let alike = |&other: &usize| search.pairs[other].cones() == pair.cones();
            if beam.len() < BEAM && !beam.iter().any(alike) {
                search.pairs.push(pair);
                beam.push(search.pairs.len() - 1);
            }
        }
    }
    search.readings()
}

/// For each cone the others within reach, the nearest ones first.
fn nearest(cones: &[Cone], reach: f64) -> Vec<Vec<usize>> {
    let others = |cone: &Cone| {
        let away = |other: &usize| (cones[*other].position - cone.position).norm();
        let mut near: Vec<usize> =
            (0..cones.len()).filter(|other| (NEAREST..reach).contains(&away(other))).collect();
        near.sort_by(|a, b| away(a).total_cmp(&away(b)));
        near.truncate(NEXT);
        near
    };
    cones.iter().map(others).collect()
}

impl Pair {
    fn cones(&self) -> [Option<usize>; 2] {
        self.ends.map(|end| end.cone)
    }
}

struct Search<'c> {
    cones: &'c [Cone],
    nearest: Vec<Vec<usize>>,
    earlier: &'c [Pose],
    p: &'c RowParameters,
    pairs: Vec<Pair>,
}

impl Search<'_> {
    /// The pairs beside the car, or beside where it was.
    fn begin(&mut self, places: &[Pose], car: Pose) {
        let [left, right] = [1.0, -1.0].map(|side| self.seeds(places, car, side));
        for (left, worth) in &left {
            for (right, other) in &right {
                let narrow = (left.place - right.place).norm() < 1.5 * self.p.narrowest;
                if !narrow {
                    self.pairs.push(Pair { ends: [*left, *right], worth: worth + other, parent: None });
                }
            }
        }
    }

    /// Cones beside the car, or beside where it was, with which a row may begin, those farthest back; or none.
    fn seeds(&self, places: &[Pose], car: Pose, side: f64) -> Vec<(End, f64)> {
        let p = self.p;
        let mut found: Vec<(usize, End, f64)> = Vec::new();
        for (cone, Cone { position, colour }) in self.cones.iter().enumerate() {
            let beside = places.iter().enumerate().find_map(|(at, place)| {
                let local = place.to_local(*position);
                let aside = side * local.y;
                let near = (0.5 * p.half_width..p.half_width + p.loose + 0.4).contains(&aside);
                (local.x.abs() < BESIDE && near).then_some((
                    at,
                    place.forward(),
                    (aside - p.half_width).abs(),
                ))
            });
            let Some((at, heading, off)) = beside else { continue };
            if f64::from(colour.side()) * side >= 0.0 {
                let end = End { cone: Some(cone), place: *position, heading, turn: 0.0, share: 1.0 };
                found.push((at, end, -0.5 * off));
            }
        }
        found.sort_by_key(|(at, ..)| *at);
        let place = car.to_world(Point::new(0.0, side * p.half_width));
        let none = End { cone: None, place, heading: car.forward(), turn: 0.0, share: 1.0 };
        found.into_iter().take(SEEDS).map(|(_, end, worth)| (end, worth)).chain([(none, -1.0)]).collect()
    }

    /// The pairs that may come next.
    fn onward(&self, parent: usize) -> Vec<Pair> {
        let mut found = Vec::new();
        for side in 0..2 {
            let candidates: Vec<usize> = match self.pairs[parent].ends[side].cone {
                Some(cone) => self.nearest[cone].clone(),
                None => (0..self.cones.len()).collect(),
            };
            found.extend(candidates.into_iter().filter_map(|cone| self.with(parent, side, cone)));
        }
        found
    }

    /// A pair with its cone of one side replaced by the next one. `None` where that cannot be.
    fn with(&self, parent: usize, side: usize, cone: usize) -> Option<Pair> {
        let (pair, p) = (&self.pairs[parent], self.p);
        let sign = [1.0, -1.0][side];
        let (own, other) = (&pair.ends[side], &pair.ends[1 - side]);
        let Cone { position, colour } = self.cones[cone];
        let leg = position - own.place;
        let length = leg.norm();
        if !(NEAREST..p.reach).contains(&length) || self.holds(parent, cone) {
            return None;
        }
        let turn = angle(own.heading, leg);
        if turn.abs() > p.sharpest {
            return None;
        }
        // Where there is a pair, a row may turn sharply to where the other one goes already.
        let usual = 2.0 * p.half_width;
        let paired = (own.place - other.place).norm() < FARTHER * usual;
        let slant = if paired { turn.abs().min(angle(other.heading, leg).abs()) } else { turn.abs() };
        let width = self.distance_to_row(parent, 1 - side, position);
        if width < 1.5 * p.narrowest || self.crosses(parent, 1 - side, [own.place, position]) {
            return None;
        }
        // The middle of the lane is to the right of its left row.
        let inwards = Vector::new(leg.y, -leg.x) * (sign * p.half_width / length);
        let middle = own.place + leg * 0.5 + inwards;
        if leads_back(Pose::new(middle.x, middle.y, math::atan2(leg.y, leg.x)), self.earlier, p.half_width) {
            return None;
        }
        // Half of the reach is as far as cones stand apart where none is missing.
        let missing = (3.0 * (length / (0.5 * p.reach) - 1.0)).clamp(0.0, 1.0);
        let mut cost = leg_cost(slant, length) + MISSING * missing * missing;
        let change = turn - own.turn;
        // The first leg may be aslant: the car is.
        if own.share < 1.0 {
            cost += CHANGE * (change * change).min(1.0);
        }
        if f64::from(colour.side()) * sign < 0.0 {
            cost += OTHER_EDGE;
        }
        cost += TAKEN * self.taken(parent, 1 - side, position, leg_cost(turn, length));
        let apart = (position - other.place).norm();
        if apart < FARTHER * usual {
            let narrow = (1.0 - width / (2.0 * p.narrowest)).max(0.0);
            let wide = (apart / usual - 1.2).max(0.0);
            cost += WIDTH * (16.0 * narrow * narrow + wide * wide);
        } else {
            cost += ALONE;
        }
        if cost > DEAREST {
            return None;
        }
        if paired {
            cost += BETWEEN * self.between([own.place, position, other.place]) as f64;
        }
        cost += BETWEEN * self.beside([own.place, position], sign) as f64;
        let end =
            End { cone: Some(cone), place: position, heading: leg / length, turn, share: own.share * LESS };
        let mut ends = pair.ends;
        ends[side] = end;
        let worth = pair.worth + own.share * (1.0 - cost);
        (cost < DEAREST).then_some(Pair { ends, worth, parent: Some(parent) })
    }

    /// A pair and those before it.
    fn back(&self, pair: usize) -> impl Iterator<Item = &Pair> {
        std::iter::successors(Some(&self.pairs[pair]), |pair| pair.parent.map(|parent| &self.pairs[parent]))
    }

    /// Whether a row has a cone already.
    fn holds(&self, pair: usize, cone: usize) -> bool {
        self.back(pair).any(|pair| pair.cones().contains(&Some(cone)))
    }

    /// The legs of one of the rows of a pair, the last one first.
    fn legs(&self, pair: usize, side: usize) -> impl Iterator<Item = [Point; 2]> {
        let ends = self.back(pair).map(move |pair| pair.ends[side].place);
        let mut last = None;
        ends.filter_map(move |place| {
            last.replace(place).filter(|after| *after != place).map(|after| [place, after])
        })
    }

    /// Metres from a point to one of the rows of a pair.
    fn distance_to_row(&self, pair: usize, side: usize, point: Point) -> f64 {
        let end = (self.pairs[pair].ends[side].place - point).norm();
        self.legs(pair, side)
            .map(|[a, b]| crate::geometry::Segment::new(a, b).distance_to(point))
            .fold(end, f64::min)
    }

    /// Whether a leg passes through one of the rows of a pair.
    fn crosses(&self, pair: usize, side: usize, leg: [Point; 2]) -> bool {
        self.legs(pair, side).any(|other| passes(leg, other))
    }

    /// How far a cone, to which a leg would cost so much, goes on better with one of the rows of a pair, 0 to 1.
    fn taken(&self, pair: usize, side: usize, cone: Point, own: f64) -> f64 {
        let ends = self.back(pair).map(|pair| &pair.ends[side]);
        let better = ends.filter_map(|end| Some(own - end.cost_to(cone, self.p.reach)?)).fold(0.0, f64::max);
        ((better - BETTER[0]) / (BETTER[1] - BETTER[0])).clamp(0.0, 1.0)
    }

    /// How many cones stand within a triangle.
    fn between(&self, [a, b, c]: [Point; 3]) -> usize {
        let inside = |cone: &&Cone| {
            let turns = [(a, b), (b, c), (c, a)].map(|(from, to)| cross(to - from, cone.position - from));
            turns.iter().all(|turn| *turn > 1e-9) || turns.iter().all(|turn| *turn < -1e-9)
        };
        self.cones.iter().filter(inside).count()
    }

    /// How many cones stand near a leg on the side of the lane, which is to the right of a left row's leg.
    fn beside(&self, [from, to]: [Point; 2], sign: f64) -> usize {
        let leg = to - from;
        let length = leg.norm();
        let inside = |cone: &&Cone| {
            let away = cone.position - from;
            let (along, inwards) = (leg.dot(&away) / length, -sign * cross(leg, away) / length);
            (NEAREST..length - NEAREST).contains(&along) && (NEAREST..self.p.narrowest).contains(&inwards)
        };
        self.cones.iter().filter(inside).count()
    }

    /// The rows that are worth most, and those that read some of their cones otherwise.
    fn readings(&self) -> Vec<Rows> {
        let mut order: Vec<usize> = (0..self.pairs.len()).collect();
        order.sort_by(|&a, &b| self.pairs[b].worth.total_cmp(&self.pairs[a].worth));
        let least = order.first().map_or(0.0, |&best| self.pairs[best].worth - WORSE);
        let mut found: Vec<(Rows, Vec<i8>)> = Vec::new();
        for pair in order.into_iter().take_while(|&pair| self.pairs[pair].worth > least) {
            let rows = self.rows_to(pair);
            let sides = rows.sides(self.cones.len());
            let contradicts = |(_, other): &(Rows, Vec<i8>)| sides.iter().zip(other).any(|(a, b)| a * b < 0);
            if found.iter().all(contradicts) {
                found.push((rows, sides));
            }
            if found.len() == READINGS {
                break;
            }
        }
        found.into_iter().map(|(rows, _)| rows).collect()
    }

    /// The rows that end with a pair.
    fn rows_to(&self, pair: usize) -> Rows {
        let edges = [0, 1].map(|side| {
            let mut edge: Vec<usize> = self.back(pair).filter_map(|pair| pair.ends[side].cone).collect();
            edge.dedup();
            edge.reverse();
            edge
        });
        Rows { edges, worth: self.pairs[pair].worth }
    }
}

impl End {
    /// What a leg from here to a cone costs. `None` where nothing is known of how the row goes here, and beyond reach.
    fn cost_to(&self, cone: Point, reach: f64) -> Option<f64> {
        let leg = cone - self.place;
        let known = self.cone.is_some() && self.share < 1.0 && leg.norm() < reach;
        known.then(|| leg_cost(angle(self.heading, leg), leg.norm()))
    }
}

/// What it costs that a leg turns by some radians, and that it is so long.
fn leg_cost(turn: f64, length: f64) -> f64 {
    SLANT * turn * turn + FAR * length
}

/// The angle from one vector to another, positive to the left.
fn angle(from: Vector, to: Vector) -> f64 {
    math::atan2(cross(from, to), from.dot(&to))
}

/// Whether the way from one point to another passes through a leg.
pub(super) fn passes([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    let side = |from: Point, to: Point, point: Point| cross(to - from, point - from) > 0.0;
    side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b)
}

/// The cosine of the angle between two ways beyond which one leads back along the other.
const BACK: f64 = -0.8;

/// Half widths between the middles of a lane and of what is no lane, as it is partly the same: less than two lie between two lanes.
const OVERLAPS: f64 = 1.8;

/// Whether a lane with its middle at a place is the one by which the car came there earlier, or overlaps it, the wrong way round.
pub(super) fn leads_back(middle: Pose, earlier: &[Pose], half_width: f64) -> bool {
    let overlap = OVERLAPS * half_width;
    let near = |pose: &&Pose| (pose.position() - middle.position()).norm_squared() < overlap * overlap;
    earlier.iter().filter(near).any(|pose| pose.forward().dot(&middle.forward()) < BACK)
}
