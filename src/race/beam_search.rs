//! A beam search from triangle to triangle between cones.

use super::cone::Cone;
use super::mesh::{Mesh, triangle};
use super::pair::{CentreLineParameters, Pair, Way};
use crate::geometry::{Point, Pose, Vector, cross};

/// Ways that are followed at a time.
const BEAM: usize = 8;
/// Edges at which a way may begin.
const STARTS: usize = 5;
/// What a cone costs that was passed on the other side.
const WRONG_SIDE: f64 = 6.0;
/// What a step as on a track is worth where loops are compared.
const GOOD_STEP: f64 = 0.15;
/// What a step as on a track costs at most.
const GOOD_COST: f64 = 0.3;
/// What a metre is worth where ways that end are compared.
const GOOD_METRE: f64 = 0.4;
/// Triangles back to which a way may not return.
const MEMORY: usize = 16;

/// Goes from triangle to triangle between some cones.
pub(super) struct BeamSearch<'c> {
    pub(super) cones: &'c [Cone],
    pub(super) parameters: &'c CentreLineParameters,
    /// The triangulation of these cones.
    pub(super) mesh: &'c Mesh,
    /// On which side of the way that was driven before each cone is, 1 for left; empty without one.
    pub(super) sides: &'c [i8],
}

/// A pair that a way passes, and the place of the one before.
#[derive(Debug, Clone, Copy)]
struct Link {
    pair: Pair,
    before: Option<usize>,
}

/// Where a way that is being followed has come to.
#[derive(Debug, Clone, Copy)]
struct Head {
    /// The place of its last pair.
    link: usize,
    /// The half-edge by which it enters a triangle, and that by which it entered the first one.
    edge: usize,
    root: usize,
    /// The directions of the last legs on both sides.
    legs: [Option<Vector>; 2],
    cost: f64,
    length: f64,
    /// Steps from cone to cone as on a track.
    good: u32,
    /// The last triangles, as a ring: that of a step is at its number modulo the length.
    trail: [usize; MEMORY],
}

/// How a way may go on.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// The place of the way among those that are followed.
    head: usize,
    /// The half-edge by which it leaves its triangle, and that by which it enters the next one.
    exit: usize,
    entry: usize,
    /// What the way costs with this step, and its good steps.
    cost: f64,
    good: u32,
}

/// The best way so far: how bad it is, and the place of its last pair.
type Best = Option<(f64, usize)>;

/// Takes in a way, if it is better than the best one.
fn keep(best: &mut Best, badness: f64, last: impl FnOnce() -> usize) {
    if best.is_none_or(|(least, _)| badness < least) {
        *best = Some((badness, last()));
    }
}

/// Notes a pair that a way passes; its place.
fn link(links: &mut Vec<Link>, pair: Pair, before: Option<usize>) -> usize {
    links.push(Link { pair, before });
    links.len() - 1
}

/// Ways that are being followed.
#[derive(Default)]
struct Search {
    /// The pairs of all ways.
    links: Vec<Link>,
    /// The ways that are followed now, all as many steps long.
    heads: Vec<Head>,
    /// Those that were followed one step before.
    earlier: Vec<Head>,
    depth: usize,
    /// The best ways so far that closed, and that ended.
    closed: Best,
    ended: Best,
}

impl Search {
    /// The pairs of the best way, and whether it is closed.
    fn best(&self) -> Option<(Vec<Pair>, bool)> {
        let (_, last) = self.closed.or(self.ended)?;
        let mut pairs = Vec::new();
        let mut at = Some(last);
        while let Some(place) = at {
            pairs.push(self.links[place].pair);
            at = self.links[place].before;
        }
        pairs.reverse();
        Some((pairs, self.closed.is_some()))
    }
}

impl BeamSearch<'_> {
    fn position(&self, cone: usize) -> Point {
        self.cones[cone].position
    }

    /// What a pair costs by itself, for being too near or too far from each other.
    fn gap_cost(&self, width: f64) -> f64 {
        let [low, high] = self.parameters.width;
        let short = ((low - width) / 0.4).max(0.0);
        let long = ((width - high) / 2.0).max(0.0);
        // A pair is far apart wherever one side has lost its cones, which alone must not drive the way off the other side.
        (short * short).min(8.0) + (long * long).min(1.0)
    }

    /// What a cone costs on a side, 0 for left.
    fn colour_cost(&self, cone: usize, side: usize) -> f64 {
        let wanted = if side == 0 { 1 } else { -1 };
        let colour = if self.cones[cone].colour.side() == -wanted { self.parameters.colour } else { 0.0 };
        let driven = if self.sides.get(cone) == Some(&-wanted) { WRONG_SIDE } else { 0.0 };
        colour + driven
    }

    /// The best way from a car on. `None` if there is none.
    pub(super) fn run(&self, car: Pose) -> Option<Way> {
        let mut search = self.search(car);
        let mut steps: Vec<Step> = Vec::new();
        for left in (0..self.cones.len() + self.cones.len() / 4 + 8).rev() {
            steps.clear();
            self.look_on(&mut search, &mut steps);
            // Nothing takes costs back, so a way is left that cannot become a better loop than the best one, were all its steps good.
            let bound = search.closed.map_or(f64::INFINITY, |(badness, _)| badness);
            let best = |step: &Step| step.cost - GOOD_STEP * (f64::from(step.good) + left as f64);
            steps.retain(|step| step.cost.is_finite() && best(step) < bound);
            if steps.is_empty() {
                break;
            }
            self.follow(&mut search, &mut steps);
        }
        let (mut pairs, closed) = search.best()?;
        if !closed {
            self.cut(&mut pairs);
        }
        (pairs.len() >= 2).then_some(Way { pairs, closed })
    }

    /// Ways that begin at the edges across the car's way, nearly where it is.
    fn search(&self, car: Pose) -> Search {
        let mut search = Search::default();
        for (cost, edge) in self.starts(car) {
            let link = link(&mut search.links, self.mesh.pair(edge), None);
            let trail = [triangle(edge); MEMORY];
            let head = Head { link, edge, root: edge, legs: [None; 2], cost, length: 0.0, good: 0, trail };
            search.heads.push(head);
        }
        search
    }

    /// What the edges cost at which a way may begin, the best first.
    fn starts(&self, car: Pose) -> Vec<(f64, usize)> {
        let (at, forward) = (car.position(), car.forward());
        let local = |point: Point| (forward.dot(&(point - at)), cross(forward, point - at));
        let start = |edge: usize| {
            let gap = &self.mesh.gaps()[edge];
            let (ahead, left) = local(gap.middle);
            let turn = 1.0 - gap.forward.dot(&forward);
            if !(-2.0..9.0).contains(&ahead) || left.abs() > 3.5 || turn > 0.5 {
                return None;
            }
            let pair = self.mesh.pair(edge);
            let away = (ahead - 1.0).abs() * 0.15 + left.abs() * 0.4;
            let colours = self.colour_cost(pair[0], 0) + self.colour_cost(pair[1], 1);
            // The car passes between them and not beside both.
            let sides = pair.map(|cone| local(self.position(cone)).1);
            let beside = if sides[0] > 0.0 && sides[1] < 0.0 { 0.0 } else { 4.0 };
            Some((away + 4.0 * turn + colours + beside + self.gap_cost(gap.width), edge))
        };
        let mut found: Vec<_> = (0..self.mesh.gaps().len()).filter_map(start).collect();
        found.retain(|(cost, _)| cost.is_finite());
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.truncate(STARTS);
        found
    }

    /// How the ways that are followed may go on. Those that close or end are taken in.
    fn look_on(&self, search: &mut Search, steps: &mut Vec<Step>) {
        let Search { links, heads, closed, ended, .. } = search;
        for (place, head) in heads.iter().enumerate() {
            // A way that ends is better the farther it leads.
            keep(ended, self.badness_of_end(head.cost, head.length), || head.link);
            for exit in Mesh::exits(head.edge) {
                let Some(entry) = self.mesh.behind(exit) else {
                    self.leave(links, ended, head, exit);
                    continue;
                };
                if triangle(entry) == triangle(head.root) && head.length > self.parameters.shortest_loop {
                    let aslant = if entry == head.root { 0.0 } else { 0.5 };
                    // Of two loops, that with more of what a track looks like: not the shorter one.
                    keep(closed, head.cost + aslant - GOOD_STEP * f64::from(head.good), || head.link);
                } else if !head.trail.contains(&triangle(entry)) {
                    let added = self.step_cost(head, exit);
                    let good = head.good + u32::from(added < GOOD_COST);
                    steps.push(Step { head: place, exit, entry, cost: head.cost + added, good });
                }
            }
        }
    }

    /// A way over the border of the triangulation ends there.
    fn leave(&self, links: &mut Vec<Link>, ended: &mut Best, head: &Head, exit: usize) {
        let length = head.length + 0.5 * self.mesh.leg(head.edge, exit).length;
        let cost = head.cost + self.step_cost(head, exit);
        let last = || link(links, self.mesh.pair_behind(exit), Some(head.link));
        keep(ended, self.badness_of_end(cost, length), last);
    }

    fn badness_of_end(&self, cost: f64, length: f64) -> f64 {
        cost - GOOD_METRE * length.min(self.parameters.horizon)
    }

    /// What it costs a way to leave its triangle by a half-edge.
    fn step_cost(&self, head: &Head, exit: usize) -> f64 {
        let forward = self.mesh.gaps()[head.edge].forward;
        let gap = &self.mesh.gaps()[exit];
        let leg = self.mesh.leg(head.edge, exit);
        let far = ((leg.length - self.parameters.spacing) / 2.0).max(0.0);
        let mut cost = self.gap_cost(gap.width) + (far * far).min(5.0) + self.colour_cost(leg.to, leg.side);
        // An edge goes on ahead: neither back nor around a sharp corner.
        cost += 2.5 * (0.3 - leg.along.dot(&forward)).max(0.0);
        if let Some(last) = head.legs[leg.side] {
            cost += 2.5 * (0.2 - last.dot(&leg.along)).max(0.0);
        }
        // The gap looks into the triangle, the way out of it.
        cost + 2.0 * (0.5 + gap.forward.dot(&forward)).max(0.0)
    }

    /// Follows the best ones of some steps, one at each edge.
    fn follow(&self, search: &mut Search, steps: &mut [Step]) {
        steps.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        search.depth += 1;
        std::mem::swap(&mut search.heads, &mut search.earlier);
        search.heads.clear();
        for step in steps.iter() {
            if search.heads.len() == BEAM {
                break;
            }
            if !search.heads.iter().any(|other| other.edge == step.entry) {
                self.take(search, step);
            }
        }
    }

    /// Lets one of the ways take a step.
    fn take(&self, search: &mut Search, step: &Step) {
        let Search { links, heads, earlier, depth, .. } = search;
        let head = &earlier[step.head];
        let leg = self.mesh.leg(head.edge, step.exit);
        let mut next = Head {
            link: link(links, self.mesh.pair(step.entry), Some(head.link)),
            edge: step.entry,
            cost: step.cost,
            good: step.good,
            // From the middle of a side of a triangle to that of another one it is half as far as along the third.
            length: head.length + 0.5 * leg.length,
            ..*head
        };
        next.legs[leg.side] = Some(leg.along);
        next.trail[*depth % MEMORY] = triangle(step.entry);
        heads.push(next);
    }

    /// Cuts an open way at the horizon.
    fn cut(&self, pairs: &mut Vec<Pair>) {
        let mut length = 0.0;
        for k in 1..pairs.len() {
            let middle = |[left, right]: Pair| nalgebra::center(&self.position(left), &self.position(right));
            length += (middle(pairs[k]) - middle(pairs[k - 1])).norm();
            if length > self.parameters.horizon {
                pairs.truncate(k + 1);
                return;
            }
        }
    }
}
