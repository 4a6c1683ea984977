//! The rows of cones that a lane lies between, followed from cone to cone from where the car is: a way that passes through one of
//! them leaves the track.
//!
//! Both are followed together, as it takes both to know either one: from a pair of a left and a right cone to the next pair, of
//! which one cone is new. So a row can turn sharply around one cone where the other one goes around it, and goes over to the other
//! edge nowhere.

use super::cone::Cone;
use super::legs::{Leg, legs_from};
use super::map::STRIDE;
use crate::geometry::{Point, Pose, Vector, angle_difference, cross, math};

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

/// Left and right.
const SIDES: [f64; 2] = [1.0, -1.0];
/// Pairs that are followed at a time.
const BEAM: usize = 16;
/// Cones of both rows at most.
const LONGEST: usize = 24;
/// Cones beside the car with which a row may begin.
const SEEDS: usize = 3;
/// Cones that may come next, the nearest ones.
const NEXT: usize = 10;
/// What it costs that a leg is aslant to the lane, for a radian squared. One more cone is worth 1.
const SLANT: f64 = 0.35;
/// What it costs that a leg is long, for a metre.
const FAR: f64 = 0.07;
/// What it costs that the other row is missing.
const ALONE: f64 = 0.3;
/// What a cone of a row is worth as a share of the one before: of what is farther off, less is seen.
const LESS: f64 = 0.85;
/// By how much a leg of the other row has to cost less, from where that begins to count to where it counts fully.
const BETTER: [f64; 2] = [0.1, 0.43];
/// What a cone may cost that is followed all the same, and how much less than the best rows others are worth at most that are
/// told of.
const DEAREST: f64 = 2.4;
/// Rows that are told of at most, where cones may be those of one edge or of the other.
const READINGS: usize = 4;

/// The end of a row.
#[derive(Debug, Clone, Copy)]
struct End {
    /// `None` where a row begins without a cone.
    cone: Option<usize>,
    place: Point,
    heading: f64,
    /// What the next cone is worth.
    share: f64,
}

/// A place by which a car came, and the unit vector along its way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passage {
    pub(super) place: Point,
    pub(super) ahead: Vector,
}

impl From<Pose> for Passage {
    fn from(pose: Pose) -> Self {
        Self { place: pose.position(), ahead: pose.forward() }
    }
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
pub(super) fn rows(cones: &[Cone], places: &[Pose], earlier: &[Passage], p: &RowParameters) -> Vec<Rows> {
    let Some(car) = places.last() else { return vec![Rows::default()] };
    let mut search = Search::new(cones, *car, earlier, p);
    search.begin(places, *car);
    let mut beam: Vec<usize> = (0..search.pairs.len()).collect();
    for _ in 0..LONGEST {
        beam = search.onward(&beam);
    }
    search.readings()
}

impl Pair {
    fn cones(&self) -> [Option<usize>; 2] {
        self.ends.map(|end| end.cone)
    }
}

/// A leg by which one of the rows of a pair may go on.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// The pair, as one of those that are followed.
    from: usize,
    side: usize,
    leg: usize,
    /// What it costs along its row, and what the pair with it is worth at most.
    cost: f64,
    most: f64,
}

struct Search<'c> {
    cones: &'c [Cone],
    /// From each cone to those that may come next.
    legs: Vec<Vec<Leg>>,
    /// From where the left and the right row begin without a cone to their first ones.
    first: [Vec<Leg>; 2],
    earlier: &'c [Passage],
    p: &'c RowParameters,
    pairs: Vec<Pair>,
}

impl<'c> Search<'c> {
    fn new(cones: &'c [Cone], car: Pose, earlier: &'c [Passage], p: &'c RowParameters) -> Self {
        let legs = cones.iter().map(|cone| legs_from(cone.position, cones, p.reach, NEXT)).collect();
        let first = SIDES.map(|side| legs_from(beside(car, side, p), cones, p.reach, cones.len()));
        Self { cones, legs, first, earlier, p, pairs: Vec::new() }
    }

    /// The pairs beside the car, or beside where it was.
    fn begin(&mut self, places: &[Pose], car: Pose) {
        let [left, right] = SIDES.map(|side| self.seeds(places, car, side));
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
                (local.x.abs() < STRIDE && near).then_some((at, place.heading, (aside - p.half_width).abs()))
            });
            let Some((at, heading, off)) = beside else { continue };
            if f64::from(colour.side()) * side >= 0.0 {
                let end = End { cone: Some(cone), place: *position, heading, share: 1.0 };
                found.push((at, end, -0.5 * off));
            }
        }
        found.sort_by_key(|(at, ..)| *at);
        let place = beside(car, side, p);
        let none = End { cone: None, place, heading: car.heading, share: 1.0 };
        found.into_iter().take(SEEDS).map(|(_, end, worth)| (end, worth)).chain([(none, -1.0)]).collect()
    }

    /// The best pairs that may come after some, no two of the same cones; their places.
    ///
    /// Most of what a leg costs takes long to find out, and is found out of those alone that may be among the best.
    fn onward(&mut self, beam: &[usize]) -> Vec<usize> {
        let rows: Vec<[Row; 2]> = beam.iter().map(|&pair| [0, 1].map(|side| self.row(pair, side))).collect();
        let mut steps = (0..beam.len()).flat_map(|from| self.steps(beam, from)).collect::<Vec<Step>>();
        steps.sort_by(|a, b| b.most.total_cmp(&a.most));
        let mut steps = steps.into_iter().peekable();
        // The best one last.
        let mut found: Vec<Pair> = Vec::new();
        let mut kept: Vec<[Option<usize>; 2]> = Vec::with_capacity(BEAM);
        while kept.len() < BEAM {
            let best = found.last().map_or(f64::NEG_INFINITY, |pair| pair.worth);
            if let Some(step) = steps.next_if(|step| step.most >= best) {
                let parent = beam[step.from];
                if !kept.contains(&self.cones_after(parent, &step))
                    && let Some(pair) = self.with(parent, &rows[step.from], &step)
                {
                    found.insert(found.partition_point(|other| other.worth < pair.worth), pair);
                }
                continue;
            }
            let Some(pair) = found.pop() else { break };
            if !kept.contains(&pair.cones()) {
                kept.push(pair.cones());
                self.pairs.push(pair);
            }
        }
        (self.pairs.len() - kept.len()..self.pairs.len()).collect()
    }

    /// The legs by which a pair may go on.
    fn steps<'s>(&'s self, beam: &[usize], from: usize) -> impl Iterator<Item = Step> + 's {
        let pair = &self.pairs[beam[from]];
        (0..2).flat_map(move |side| {
            let own = &pair.ends[side];
            self.legs_of(own, side).iter().enumerate().filter_map(move |(at, leg)| {
                let of_other_edge = f64::from(self.cones[leg.to].colour.side()) * SIDES[side] < 0.0;
                if of_other_edge || angle_difference(leg.heading, own.heading).abs() > self.p.sharpest {
                    return None;
                }
                let cost = self.cost_along(pair, side, leg);
                let least = cost + self.cost_apart(pair, side, leg);
                let most = pair.worth + own.share * (1.0 - least);
                (least <= DEAREST).then_some(Step { from, side, leg: at, cost, most })
            })
        })
    }

    /// The cones of a pair that has gone on by a leg.
    fn cones_after(&self, parent: usize, step: &Step) -> [Option<usize>; 2] {
        let pair = &self.pairs[parent];
        let leg = &self.legs_of(&pair.ends[step.side], step.side)[step.leg];
        let mut cones = pair.cones();
        cones[step.side] = Some(leg.to);
        cones
    }

    /// The legs that begin where a row ends.
    fn legs_of(&self, end: &End, side: usize) -> &[Leg] {
        end.cone.map_or(&self.first[side], |cone| &self.legs[cone])
    }

    /// A pair with its cone of one side replaced by that at the end of a leg. `None` where that cannot be.
    fn with(&self, parent: usize, rows: &[Row; 2], step: &Step) -> Option<Pair> {
        let (pair, side) = (&self.pairs[parent], step.side);
        let own = &pair.ends[side];
        let leg = &self.legs_of(own, side)[step.leg];
        if rows.iter().any(|row| row.holds(leg.to))
            || self.leads_back(side, leg)
            || rows[1 - side].is_crossed_by(leg.ends)
        {
            return None;
        }
        let cost = step.cost + self.cost_beside(pair, &rows[1 - side], side, leg)?;
        if cost > DEAREST {
            return None;
        }
        let end = End {
            cone: Some(leg.to),
            place: leg.ends[1],
            heading: leg.heading,
            share: own.share * LESS,
        };
        let mut ends = pair.ends;
        ends[side] = end;
        let worth = pair.worth + own.share * (1.0 - cost);
        Some(Pair { ends, worth, parent: Some(parent) })
    }

    /// What it costs that a row goes on along a leg.
    fn cost_along(&self, pair: &Pair, side: usize, leg: &Leg) -> f64 {
        let own = &pair.ends[side];
        let turn = angle_difference(leg.heading, own.heading);
        // Where there is a pair, a row may turn sharply to where the other one goes already.
        let slant = if self.is_paired(pair) {
            turn.abs().min(angle_difference(leg.heading, pair.ends[1 - side].heading).abs())
        } else {
            turn.abs()
        };
        leg_cost(slant, leg.length)
    }

    /// What it costs that the other row is where it is beside a leg. `None` where that is too near.
    fn cost_beside(&self, pair: &Pair, other: &Row, side: usize, leg: &Leg) -> Option<f64> {
        let (narrowest, place) = (self.p.narrowest, leg.ends[1]);
        let width = other.distance_to(place);
        if width < 1.5 * narrowest {
            return None;
        }
        let turn = angle_difference(leg.heading, pair.ends[side].heading);
        let taken = other.takes(place, leg_cost(turn, leg.length), self.p.reach);
        let apart = (place - pair.ends[1 - side].place).norm();
        let narrow = if apart < self.widest() { (1.0 - width / (2.0 * narrowest)).max(0.0) } else { 0.0 };
        Some(taken + 16.0 * narrow * narrow + self.cost_apart(pair, side, leg))
    }

    /// The part of that for how far apart the ends of both rows are.
    fn cost_apart(&self, pair: &Pair, side: usize, leg: &Leg) -> f64 {
        let apart = (leg.ends[1] - pair.ends[1 - side].place).norm();
        if apart >= self.widest() {
            return ALONE;
        }
        let wide = (apart / (2.0 * self.p.half_width) - 1.2).max(0.0);
        wide * wide
    }

    /// Metres between the cones of a pair at most: where they are farther apart, a second lane is between them, and one row is
    /// missing.
    fn widest(&self) -> f64 {
        2.0 * OVERLAPS * self.p.half_width
    }

    /// Whether the cones of a pair stand opposite each other: else one row is missing.
    fn is_paired(&self, pair: &Pair) -> bool {
        (pair.ends[0].place - pair.ends[1].place).norm() < self.widest()
    }

    /// Whether the lane beside a leg is the way by which the car came, the wrong way round.
    fn leads_back(&self, side: usize, leg: &Leg) -> bool {
        // The middle of the lane is to the right of its left row.
        let inwards = Vector::new(leg.along.y, -leg.along.x) * (SIDES[side] * self.p.half_width);
        let place = nalgebra::center(&leg.ends[0], &leg.ends[1]) + inwards;
        leads_back(Passage { place, ahead: leg.along }, self.earlier, self.p.half_width)
    }

    /// A pair and those before it.
    fn back(&self, pair: usize) -> impl Iterator<Item = &Pair> {
        std::iter::successors(Some(&self.pairs[pair]), |pair| pair.parent.map(|parent| &self.pairs[parent]))
    }

    /// One of the rows of a pair.
    fn row(&self, pair: usize, side: usize) -> Row {
        let mut ends: Vec<End> = Vec::with_capacity(LONGEST);
        for pair in self.back(pair) {
            let end = pair.ends[side];
            if ends.last().is_none_or(|last| last.place != end.place) {
                ends.push(end);
            }
        }
        Row { ends }
    }

    /// The rows that are worth most, and those that read some of their cones otherwise.
    fn readings(&self) -> Vec<Rows> {
        let mut order: Vec<usize> = (0..self.pairs.len()).collect();
        order.sort_by(|&a, &b| self.pairs[b].worth.total_cmp(&self.pairs[a].worth));
        let least = order.first().map_or(0.0, |&best| self.pairs[best].worth - DEAREST);
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

/// A row, the last cone first.
struct Row {
    ends: Vec<End>,
}

impl Row {
    /// Whether it has a cone already.
    fn holds(&self, cone: usize) -> bool {
        self.ends.iter().any(|end| end.cone == Some(cone))
    }

    /// Its legs, from cone to cone.
    fn legs(&self) -> impl Iterator<Item = [Point; 2]> {
        self.ends.windows(2).map(|ends| [ends[1].place, ends[0].place])
    }

    /// Metres from a point.
    fn distance_to(&self, point: Point) -> f64 {
        let end = (self.ends[0].place - point).norm();
        let away = |[a, b]: [Point; 2]| crate::geometry::Segment::new(a, b).distance_to(point);
        self.legs().map(away).fold(end, f64::min)
    }

    /// Whether a leg passes through it.
    fn is_crossed_by(&self, leg: [Point; 2]) -> bool {
        self.legs().any(|other| passes(leg, other))
    }

    /// How far a cone, to which a leg would cost so much, goes on better with this row, 0 to 1.
    fn takes(&self, cone: Point, own: f64, reach: f64) -> f64 {
        let mut better = BETTER[0];
        for end in &self.ends {
            let length = (cone - end.place).norm();
            // Most legs are too long to be better however straight on they lead.
            if own - FAR * length > better
                && let Some(cost) = end.cost_to(cone, reach)
            {
                better = better.max(own - cost);
            }
        }
        ((better - BETTER[0]) / (BETTER[1] - BETTER[0])).clamp(0.0, 1.0)
    }
}

impl End {
    /// What a leg from here to a cone costs. `None` where nothing is known of how the row goes here, and beyond reach.
    fn cost_to(&self, cone: Point, reach: f64) -> Option<f64> {
        let leg = cone - self.place;
        let known = self.cone.is_some() && self.share < 1.0 && leg.norm() < reach;
        known.then(|| leg_cost(angle_difference(math::atan2(leg.y, leg.x), self.heading), leg.norm()))
    }
}

/// What it costs that a leg turns by some radians, and that it is so long.
fn leg_cost(turn: f64, length: f64) -> f64 {
    SLANT * turn * turn + FAR * length
}

/// Where a row begins without a cone beside a car, on its left or on its right.
fn beside(car: Pose, side: f64, p: &RowParameters) -> Point {
    car.to_world(Point::new(0.0, side * p.half_width))
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
pub(super) fn leads_back(middle: Passage, earlier: &[Passage], half_width: f64) -> bool {
    let overlap = OVERLAPS * half_width;
    let near = |other: &&Passage| (other.place - middle.place).norm_squared() < overlap * overlap;
    earlier.iter().filter(near).any(|other| other.ahead.dot(&middle.ahead) < BACK)
}
