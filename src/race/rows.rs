//! The rows of cones on both sides of a lane, followed from cone to cone, starting at the car. A path that
//! passes through a row leaves the track.
//!
//! Both rows are followed together, because each supports the other: from a pair of a left and a right cone
//! to the next pair, which has one new cone. A row may thus turn sharply around one cone while the other goes
//! around it, and never changes over to the other edge.

use super::cone::Cone;
use super::legs::{Leg, legs_from};
use super::map::STRIDE;
use crate::geometry::{Point, Pose, Vector, angle_difference, cross, math};

#[cfg(test)]
mod tests;

/// Parameters of the rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowParameters {
    /// Maximum distance between cones, with one missing (m).
    pub(super) reach: f64,
    /// Approximate distance from the centre line to an edge (m).
    pub(super) half_width: f64,
    /// Minimum of that distance (m).
    pub(super) narrowest: f64,
    /// Maximum distance of a cone from its edge (m).
    pub(super) loose: f64,
    /// Maximum turn of a row at one cone (rad).
    pub(super) sharpest: f64,
}

/// Left and right.
const SIDES: [f64; 2] = [1.0, -1.0];
/// Number of pairs followed at the same time.
const BEAM: usize = 16;
/// Maximum number of cones in both rows.
const LONGEST: usize = 24;
/// Number of cones beside the car with which a row may begin.
const SEEDS: usize = 3;
/// Number of nearest cones considered as the next one.
const NEXT: usize = 10;
/// Penalty for misalignment of a leg with the lane (per rad²). One more cone is worth 1.
const SLANT: f64 = 0.35;
/// Penalty for the length of a leg (per m).
const FAR: f64 = 0.07;
/// Penalty for a missing cone in the other row.
const ALONE: f64 = 0.3;
/// Value of each cone relative to the one before: distant cones are seen less often.
const LESS: f64 = 0.85;
/// Cost by which a leg of the other row must be cheaper: from where that begins to count, to where it counts
/// fully.
const BETTER: [f64; 2] = [0.1, 0.43];
/// Maximum cost of a cone that is still followed, and maximum lag of a returned reading behind the best one.
const DEAREST: f64 = 2.4;
/// Maximum number of returned readings, where cones may belong to one edge or to the other.
const READINGS: usize = 4;

/// End of a row.
#[derive(Debug, Clone, Copy)]
struct End {
    /// `None` if a row begins without a cone.
    cone: Option<usize>,
    place: Point,
    heading: f64,
    /// Weight of the next cone.
    share: f64,
}

/// A point of the car's earlier path, and the unit tangent.
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

/// A left and a right row, given by their ends, with the predecessor.
#[derive(Debug, Clone, Copy)]
struct Pair {
    ends: [End; 2],
    worth: f64,
    parent: Option<usize>,
}

/// Rows of a lane.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Rows {
    /// Indices of the cones of the left and the right row, in order along the lane.
    pub(super) edges: [Vec<usize>; 2],
    /// Score as edges of a lane, about one per cone.
    pub(super) worth: f64,
}

impl Rows {
    /// Side of each cone, 1 for left, -1 for right, 0 for cones of no row.
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

/// The rows left and right of a lane, in up to four readings, best first; any two readings assign some cone
/// to different edges.
///
/// `places` are the previous poses of the car and the present one, oldest first; `earlier` is its earlier
/// path. A row ends where no cone continues it. O(n²) for n cones.
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

/// A leg that may extend one row of a pair.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// Index of the pair in the beam.
    from: usize,
    side: usize,
    leg: usize,
    /// Cost along its row; `most` is an upper bound of the new pair's score.
    cost: f64,
    most: f64,
}

struct Search<'c> {
    cones: &'c [Cone],
    /// Legs from each cone to possible next ones.
    legs: Vec<Vec<Leg>>,
    /// Legs to the first cones of the left and the right row, if these begin without a cone.
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

    /// Starts with pairs beside the car, or beside its previous poses.
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

    /// Cones with which a row may begin, beside the car or its previous poses, farthest back first; or none.
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

    /// Indices of the best successors of some pairs, no two with the same cones.
    ///
    /// Most costs are expensive to compute, so they are computed only for candidates that may be among the
    /// best.
    fn onward(&mut self, beam: &[usize]) -> Vec<usize> {
        let rows: Vec<[Row; 2]> = beam.iter().map(|&pair| [0, 1].map(|side| self.row(pair, side))).collect();
        let mut steps = (0..beam.len()).flat_map(|from| self.steps(beam, from)).collect::<Vec<Step>>();
        steps.sort_by(|a, b| b.most.total_cmp(&a.most));
        let mut steps = steps.into_iter().peekable();
        // The best one is last.
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

    /// Legs that may extend a pair.
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

    /// Cones of a pair after a leg.
    fn cones_after(&self, parent: usize, step: &Step) -> [Option<usize>; 2] {
        let pair = &self.pairs[parent];
        let leg = &self.legs_of(&pair.ends[step.side], step.side)[step.leg];
        let mut cones = pair.cones();
        cones[step.side] = Some(leg.to);
        cones
    }

    /// Legs that begin at the end of a row.
    fn legs_of(&self, end: &End, side: usize) -> &[Leg] {
        end.cone.map_or(&self.first[side], |cone| &self.legs[cone])
    }

    /// A pair after a leg; `None` if the leg is impossible.
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
        let end =
            End { cone: Some(leg.to), place: leg.ends[1], heading: leg.heading, share: own.share * LESS };
        let mut ends = pair.ends;
        ends[side] = end;
        let worth = pair.worth + own.share * (1.0 - cost);
        Some(Pair { ends, worth, parent: Some(parent) })
    }

    /// Cost of a leg along its own row.
    fn cost_along(&self, pair: &Pair, side: usize, leg: &Leg) -> f64 {
        let own = &pair.ends[side];
        let turn = angle_difference(leg.heading, own.heading);
        // In a pair, a row may turn sharply towards the direction of the other one.
        let slant = if self.is_paired(pair) {
            turn.abs().min(angle_difference(leg.heading, pair.ends[1 - side].heading).abs())
        } else {
            turn.abs()
        };
        leg_cost(slant, leg.length)
    }

    /// Cost of a leg relative to the other row; `None` if that is too close.
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

    /// The part of that cost due to the distance between the ends of both rows.
    fn cost_apart(&self, pair: &Pair, side: usize, leg: &Leg) -> f64 {
        let apart = (leg.ends[1] - pair.ends[1 - side].place).norm();
        if apart >= self.widest() {
            return ALONE;
        }
        let wide = (apart / (2.0 * self.p.half_width) - 1.2).max(0.0);
        wide * wide
    }

    /// Maximum distance between the cones of a pair (m).
    fn widest(&self) -> f64 {
        2.0 * OVERLAPS * self.p.half_width
    }

    /// Whether the cones of a pair are opposite each other; otherwise one row is missing.
    fn is_paired(&self, pair: &Pair) -> bool {
        (pair.ends[0].place - pair.ends[1].place).norm() < self.widest()
    }

    /// Whether the lane beside a leg is the car's earlier path in the opposite direction.
    fn leads_back(&self, side: usize, leg: &Leg) -> bool {
        // The centre line is to the right of the left row.
        let inwards = Vector::new(leg.along.y, -leg.along.x) * (SIDES[side] * self.p.half_width);
        let place = nalgebra::center(&leg.ends[0], &leg.ends[1]) + inwards;
        leads_back(Passage { place, ahead: leg.along }, self.earlier, self.p.half_width)
    }

    /// A pair and its predecessors.
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

    /// The rows with the highest score, and those that assign some cones differently.
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

/// A row, last cone first.
struct Row {
    ends: Vec<End>,
}

impl Row {
    /// Whether it contains a cone.
    fn holds(&self, cone: usize) -> bool {
        self.ends.iter().any(|end| end.cone == Some(cone))
    }

    /// Its legs, from cone to cone.
    fn legs(&self) -> impl Iterator<Item = [Point; 2]> {
        self.ends.windows(2).map(|ends| [ends[1].place, ends[0].place])
    }

    /// Distance to a point (m).
    fn distance_to(&self, point: Point) -> f64 {
        let end = (self.ends[0].place - point).norm();
        let away = |[a, b]: [Point; 2]| crate::geometry::Segment::new(a, b).distance_to(point);
        self.legs().map(away).fold(end, f64::min)
    }

    /// Whether a leg crosses it.
    fn is_crossed_by(&self, leg: [Point; 2]) -> bool {
        self.legs().any(|other| passes(leg, other))
    }

    /// How much better a cone would continue this row than by a leg of cost `own`, 0 to 1.
    fn takes(&self, cone: Point, own: f64, reach: f64) -> f64 {
        let mut better = BETTER[0];
        for end in &self.ends {
            let length = (cone - end.place).norm();
            // Most legs are too long to be better, however straight.
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
    /// Cost of a leg to a cone; `None` beyond reach, or if the direction of the row is not yet known.
    fn cost_to(&self, cone: Point, reach: f64) -> Option<f64> {
        let leg = cone - self.place;
        let known = self.cone.is_some() && self.share < 1.0 && leg.norm() < reach;
        known.then(|| leg_cost(angle_difference(math::atan2(leg.y, leg.x), self.heading), leg.norm()))
    }
}

/// Cost of a leg's turn and length.
fn leg_cost(turn: f64, length: f64) -> f64 {
    SLANT * turn * turn + FAR * length
}

/// Start of a row without a cone, beside the car.
fn beside(car: Pose, side: f64, p: &RowParameters) -> Point {
    car.to_world(Point::new(0.0, side * p.half_width))
}

/// Whether the segment from one point to another crosses a leg.
pub(super) fn passes([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    let side = |from: Point, to: Point, point: Point| cross(to - from, point - from) > 0.0;
    side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b)
}

/// Cosine of the angle between two paths below which one leads back along the other.
const BACK: f64 = -0.8;

/// Distance between the centre of a lane and that of a false one that shares an edge with it, in half-widths:
/// less than two.
const OVERLAPS: f64 = 1.8;

/// Whether a lane with its centre at a point coincides with, or overlaps, the car's earlier path in the
/// opposite direction.
pub(super) fn leads_back(middle: Passage, earlier: &[Passage], half_width: f64) -> bool {
    let overlap = OVERLAPS * half_width;
    let near = |other: &&Passage| (other.place - middle.place).norm_squared() < overlap * overlap;
    earlier.iter().filter(near).any(|other| other.ahead.dot(&middle.ahead) < BACK)
}
