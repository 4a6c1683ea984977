//! A way of arcs between cones, by a beam search.

use super::cone::Cone;
use super::lane::{Lane, LaneParameters};
use super::rows::{Passage, Rows, leads_back, passes};
use crate::geometry::{Point, Pose, Vector, cross, direction};

/// What touching a cone costs, having it on the wrong side, passing through a row of cones, leaving the lane found before,
/// bending and steering.
const TOUCH: f64 = 6.0;
const WRONG_SIDE: f64 = 2.0;
const THROUGH: f64 = 10.0;
const KEEP: f64 = 0.35;
const BEND: f64 = 4.0;
const STEER: f64 = 16.0;
/// What driving back costs where the car came from.
const BACK: f64 = 12.0;
/// How much farther outside a cone may stand than inside: tracks are wider here and there.
const WIDER: f64 = 1.6;
/// What a cone of a row is worth to a way that has it at its edge; any other one is worth 1.
const OF_ROW: f64 = 1.7;
/// Different curvatures to one side, and how many of them a way goes over from piece to piece at most.
const BENDS: i32 = 5;
const STEERS: i32 = 2;
/// Ways are alike that bend alike and end with headings and at places so near each other: radians, and metres squared.
const ALIKE: (f64, f64) = (0.12, 0.16);

/// A pose with the unit vector of its heading.
#[derive(Debug, Clone, Copy)]
struct Place {
    at: Point,
    ahead: Vector,
    heading: f64,
}

/// From a pose to another one, in its frame.
#[derive(Debug, Clone, Copy)]
struct Motion {
    by: Vector,
    turn: f64,
    turned: Vector,
}

/// An arc: how much it is bent, and the motions to its middle and to its end.
#[derive(Debug, Clone, Copy)]
struct Arc {
    curvature: f64,
    middle: Motion,
    end: Motion,
}

/// A piece of a way.
#[derive(Debug, Clone, Copy)]
struct Piece {
    middle: Place,
    end: Place,
    bend: i32,
    cost: f64,
    /// The cones that the way has gone by so far at half its width, a bit for each.
    passed: u128,
    parent: Option<usize>,
}

/// A cone that a way may come by.
#[derive(Debug, Clone, Copy)]
struct Beside {
    position: Point,
    /// Its bit among those that are passed.
    bit: u128,
    /// On which sides it is by its colour and by its row: 1 for left, 0 where that is not known.
    sides: [f64; 2],
    /// What it is worth at the edge.
    worth: f64,
}

/// What there may be on the way.
#[derive(Debug, Clone, Default)]
struct Scene {
    cones: Vec<Beside>,
    /// From cone to cone of both rows.
    legs: Vec<[Point; 2]>,
    /// The way by which the car came.
    earlier: Vec<Passage>,
}

/// What ways between cones are looked for with.
#[derive(Debug, Clone, Copy)]
pub(super) struct ArcSearch<'s> {
    pub(super) cones: &'s [Cone],
    /// What is no cone and not to be touched.
    pub(super) others: &'s [Point],
    /// The way by which the car came.
    pub(super) earlier: &'s [Passage],
    /// The lane that was found before.
    pub(super) before: &'s Lane,
    pub(super) parameters: &'s LaneParameters,
}

impl Place {
    fn after(&self, motion: &Motion) -> Self {
        let turned = |v: Vector| {
            Vector::new(self.ahead.x * v.x - self.ahead.y * v.y, self.ahead.y * v.x + self.ahead.x * v.y)
        };
        Self {
            at: self.at + turned(motion.by),
            ahead: turned(motion.turned),
            heading: self.heading + motion.turn,
        }
    }

    fn pose(&self) -> Pose {
        Pose::new(self.at.x, self.at.y, self.heading)
    }
}

impl From<Pose> for Place {
    fn from(pose: Pose) -> Self {
        Self { at: pose.position(), ahead: pose.forward(), heading: pose.heading }
    }
}

impl Arc {
    fn new(curvature: f64, length: f64) -> Self {
        let motion = |length: f64| {
            let turn = curvature * length;
            Motion { by: direction(0.5 * turn) * length, turn, turned: direction(turn) }
        };
        Self { curvature, middle: motion(0.5 * length), end: motion(length) }
    }
}

impl Scene {
    fn new(search: &ArcSearch, rows: &Rows) -> Self {
        let cones = search.cones;
        let sides = rows.sides(cones.len());
        let of_row = |(index, (cone, side)): (usize, (&Cone, &i8))| Beside {
            position: cone.position,
            bit: bit(index),
            sides: [f64::from(cone.colour.side()), f64::from(*side)],
            worth: if *side == 0 { 1.0 } else { OF_ROW },
        };
        let other = |place: &Point| Beside { position: *place, bit: 0, sides: [0.0; 2], worth: 0.0 };
        let beside = cones.iter().zip(&sides).enumerate().map(of_row);
        let cones_beside = beside.chain(search.others.iter().map(other)).collect();
        Self { cones: cones_beside, legs: rows.legs(cones), earlier: search.earlier.to_vec() }
    }

    /// Becomes what of another one is so near a place: cones, legs, and the way by which the car came.
    fn take_near(&mut self, other: &Self, place: Point, [cones, legs, earlier]: [f64; 3]) {
        let near = |point: Point, most: f64| (point - place).norm_squared() < most * most;
        self.cones.clear();
        self.cones.extend(other.cones.iter().filter(|cone| near(cone.position, cones)));
        self.legs.clear();
        let is_near = |leg: &&[Point; 2]| {
            let [from, to] = **leg;
            near(nalgebra::center(&from, &to), legs + 0.5 * (to - from).norm())
        };
        self.legs.extend(other.legs.iter().filter(is_near));
        self.earlier.clear();
        self.earlier.extend(other.earlier.iter().filter(|passage| near(passage.place, earlier)));
    }
}

/// The bit of a cone. Those beyond the 128th have none: they count whenever a way comes by.
fn bit(cone: usize) -> u128 {
    u32::try_from(cone).ok().and_then(|cone| 1_u128.checked_shl(cone)).unwrap_or(0)
}

impl ArcSearch<'_> {
    /// The best way from a car on between rows, and what it costs.
    pub(super) fn best(&self, rows: &Rows, car: Pose) -> Option<(Vec<Pose>, f64)> {
        let p = self.parameters;
        let arcs: Vec<Arc> = (-BENDS..=BENDS)
            .map(|bend| Arc::new(p.curvature * f64::from(bend) / f64::from(BENDS), p.piece))
            .collect();
        let all = Scene::new(self, rows);
        let mut near = Scene::default();
        // From the beginning of a piece to what touches it and to what may be at its edge.
        let beside = p.piece + self.before.half_width + p.clearance.max(WIDER * p.loose);
        let reach = [beside, p.piece, p.piece + 2.0 * self.before.half_width];
        let start =
            Piece { middle: car.into(), end: car.into(), bend: 0, cost: 0.0, passed: 0, parent: None };
        let mut pieces = vec![start];
        let mut beam = vec![0];
        let mut next: Vec<Piece> = Vec::new();
        for depth in 0..p.pieces {
            next.clear();
            for &parent in &beam {
                let most = if depth == 0 { BENDS } else { STEERS };
                near.take_near(&all, pieces[parent].end.at, reach);
                for (bend, arc) in (-BENDS..).zip(&arcs) {
                    if (bend - pieces[parent].bend).abs() <= most {
                        next.push(self.extended(&near, (parent, &pieces[parent]), bend, arc));
                    }
                }
            }
            beam = keep_best(&mut pieces, &next, p.beam);
        }
        let mut way = Vec::new();
        let mut at = *beam.first()?;
        let cost = pieces[at].cost;
        while let Some(parent) = pieces[at].parent {
            way.extend([pieces[at].end.pose(), pieces[at].middle.pose()]);
            at = parent;
        }
        way.reverse();
        Some((way, cost))
    }

    /// A way with one more piece, in the scene around it.
    fn extended(&self, near: &Scene, (parent, last): (usize, &Piece), bend: i32, arc: &Arc) -> Piece {
        let p = self.parameters;
        let (middle, end) = (last.end.after(&arc.middle), last.end.after(&arc.end));
        let steer = p.curvature * f64::from(bend - last.bend) / f64::from(BENDS);
        let (beside, passed) = self.along(near, middle, last.passed);
        let through = near.legs.iter().filter(|leg| passes([last.end.at, end.at], **leg)).count();
        let mut cost = last.cost + BEND * arc.curvature * arc.curvature + STEER * steer * steer + beside;
        cost += KEEP * self.before.away(middle.at) + THROUGH * through as f64;
        let passage = Passage { place: middle.at, ahead: middle.ahead };
        if leads_back(passage, &near.earlier, self.before.half_width) {
            cost += BACK;
        }
        Piece { middle, end, bend, cost, passed, parent: Some(parent) }
    }

    /// What the cones beside a piece cost, and those that have been passed after it.
    fn along(&self, near: &Scene, middle: Place, mut passed: u128) -> (f64, u128) {
        let (p, half_width) = (self.parameters, self.before.half_width);
        let mut cost = 0.0;
        for cone in &near.cones {
            let away = cone.position - middle.at;
            if away.dot(&middle.ahead).abs() > 0.5 * p.piece {
                continue;
            }
            let left = cross(middle.ahead, away);
            let aside = left.abs();
            let wrong = cone.sides.iter().any(|side| side * left < 0.0);
            let close = ((p.clearance - aside) / 0.4).max(0.0);
            let off = (aside - half_width) / if aside > half_width { WIDER * p.loose } else { p.loose };
            cost += TOUCH * (close * close).min(1.0);
            let fits = 1.0 - off * off;
            // A way that goes around the end of a row comes by its cones a second time.
            let again = passed & cone.bit != 0;
            if !wrong && fits > 0.0 && !again {
                cost -= cone.worth * fits;
                passed |= cone.bit;
            } else if wrong && aside < half_width + p.loose {
                cost += WRONG_SIDE;
            }
        }
        (cost, passed)
    }
}

/// Keeps the best of some pieces, so many of them and no two alike; their places.
fn keep_best(pieces: &mut Vec<Piece>, next: &[Piece], most: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..next.len()).collect();
    order.sort_by(|&a, &b| next[a].cost.total_cmp(&next[b].cost));
    let mut kept = Vec::with_capacity(most.min(next.len()));
    for piece in order.into_iter().map(|at| &next[at]) {
        if kept.len() == most {
            break;
        }
        let alike = |&other: &usize| {
            let other: &Piece = &pieces[other];
            other.bend == piece.bend
                && (other.end.heading - piece.end.heading).abs() < ALIKE.0
                && (other.end.at - piece.end.at).norm_squared() < ALIKE.1
        };
        if !kept.iter().any(alike) {
            pieces.push(*piece);
            kept.push(pieces.len() - 1);
        }
    }
    kept
}
