//! Beam search over the triangles between cones.

use super::cone::Cone;
use super::mesh::{Mesh, triangle};
use super::pair::{CentreLineParameters, Pair, Way};
use crate::geometry::{Point, Pose, Vector, cross};

/// Number of paths followed at the same time.
const BEAM: usize = 8;
/// Number of edges at which a path may begin.
const STARTS: usize = 5;
/// Cost of a cone passed on the wrong side.
const WRONG_SIDE: f64 = 6.0;
/// Value of a metre when finished paths are compared.
const GOOD_METRE: f64 = 0.4;
/// Number of previous triangles to which a path must not return.
const MEMORY: usize = 16;

/// A beam search over the triangles between cones.
pub(super) struct BeamSearch<'c> {
    pub(super) cones: &'c [Cone],
    pub(super) parameters: &'c CentreLineParameters,
    /// Triangulation of the cones.
    pub(super) mesh: &'c Mesh,
    /// Side of each cone relative to the path driven before, 1 for left; empty without one.
    pub(super) sides: &'c [i8],
}

/// A pair of cones passed by a path, and the index of the preceding pair.
#[derive(Debug, Clone, Copy)]
struct Link {
    pair: Pair,
    before: Option<usize>,
}

/// End of a path that is being extended.
#[derive(Debug, Clone, Copy)]
struct Head {
    /// Index of its last pair.
    link: usize,
    /// The half-edge by which it enters a triangle; `root` is that of its first triangle.
    edge: usize,
    root: usize,
    /// Directions of the last legs on both sides.
    legs: [Option<Vector>; 2],
    cost: f64,
    length: f64,
    /// The last triangles, as a ring buffer indexed by the step modulo its length.
    trail: [usize; MEMORY],
}

/// A possible extension of a path.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// Index of the path among those being extended.
    head: usize,
    /// The half-edge by which it leaves its triangle; `entry` is that into the next one.
    exit: usize,
    entry: usize,
    /// Cost of the path with this step.
    cost: f64,
}

/// The best path so far: its cost, and the index of its last pair.
type Best = Option<(f64, usize)>;

/// Keeps a path if it is better than the best one.
fn keep(best: &mut Best, badness: f64, last: impl FnOnce() -> usize) {
    if best.is_none_or(|(least, _)| badness < least) {
        *best = Some((badness, last()));
    }
}

/// Records a pair and returns its index.
fn link(links: &mut Vec<Link>, pair: Pair, before: Option<usize>) -> usize {
    links.push(Link { pair, before });
    links.len() - 1
}

/// State of the search.
#[derive(Default)]
struct Search {
    /// Pairs of all paths.
    links: Vec<Link>,
    /// Paths being extended, all of the same number of steps.
    heads: Vec<Head>,
    /// Paths of the previous step.
    earlier: Vec<Head>,
    depth: usize,
    /// The best path so far that closed; `ended` is the best that ended.
    closed: Best,
    ended: Best,
}

impl Search {
    /// Pairs of the best path, and whether it is closed.
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

    /// Cost of a pair for being too close or too far apart.
    fn gap_cost(&self, width: f64) -> f64 {
        let [low, high] = self.parameters.width;
        let short = ((low - width) / 0.4).max(0.0);
        let long = ((width - high) / 2.0).max(0.0);
        // Where one side has lost its cones, pairs are far apart; this alone must not drive the path off the
        // other side.
        (short * short).min(8.0) + (long * long).min(1.0)
    }

    /// Cost of a cone on a side, 0 for left.
    fn colour_cost(&self, cone: usize, side: usize) -> f64 {
        let wanted = if side == 0 { 1 } else { -1 };
        let colour = if self.cones[cone].colour.side() == -wanted { self.parameters.colour } else { 0.0 };
        let driven = if self.sides.get(cone) == Some(&-wanted) { WRONG_SIDE } else { 0.0 };
        colour + driven
    }

    /// The best path ahead of a car; `None` if there is none.
    pub(super) fn run(&self, car: Pose) -> Option<Way> {
        let mut search = self.search(car);
        let mut steps: Vec<Step> = Vec::new();
        for _ in 0..self.cones.len() + self.cones.len() / 4 + 8 {
            steps.clear();
            self.look_on(&mut search, &mut steps);
            // Costs only grow. Drop paths that cannot become a better loop than the best one.
            let bound = search.closed.map_or(f64::INFINITY, |(badness, _)| badness);
            steps.retain(|step| step.cost.is_finite() && step.cost < bound);
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

    /// Starts paths at the edges across the car's direction, close to the car.
    fn search(&self, car: Pose) -> Search {
        let mut search = Search::default();
        for (cost, edge) in self.starts(car) {
            let link = link(&mut search.links, self.mesh.pair(edge), None);
            let trail = [triangle(edge); MEMORY];
            let head = Head { link, edge, root: edge, legs: [None; 2], cost, length: 0.0, trail };
            search.heads.push(head);
        }
        search
    }

    /// Edges at which a path may start, with their costs, the best first.
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
            // The car passes between the two cones, not beside both.
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

    /// Collects the possible extensions of all paths; paths that close or end are recorded.
    fn look_on(&self, search: &mut Search, steps: &mut Vec<Step>) {
        let Search { links, heads, closed, ended, .. } = search;
        for (place, head) in heads.iter().enumerate() {
            // An ending path is better the farther it leads.
            keep(ended, self.badness_of_end(head.cost, head.length), || head.link);
            for exit in Mesh::exits(head.edge) {
                let Some(entry) = self.mesh.behind(exit) else {
                    self.leave(links, ended, head, exit);
                    continue;
                };
                if triangle(entry) == triangle(head.root) && head.length > self.parameters.shortest_loop {
                    let aslant = if entry == head.root { 0.0 } else { 0.5 };
                    keep(closed, head.cost + aslant, || head.link);
                } else if !head.trail.contains(&triangle(entry)) {
                    let added = self.step_cost(head, exit);
                    steps.push(Step { head: place, exit, entry, cost: head.cost + added });
                }
            }
        }
    }

    /// Ends a path that leaves the triangulation.
    fn leave(&self, links: &mut Vec<Link>, ended: &mut Best, head: &Head, exit: usize) {
        let length = head.length + 0.5 * self.mesh.leg(head.edge, exit).length;
        let cost = head.cost + self.step_cost(head, exit);
        let last = || link(links, self.mesh.pair_behind(exit), Some(head.link));
        keep(ended, self.badness_of_end(cost, length), last);
    }

    fn badness_of_end(&self, cost: f64, length: f64) -> f64 {
        cost - GOOD_METRE * length.min(self.parameters.horizon)
    }

    /// Cost of leaving a triangle by a half-edge.
    fn step_cost(&self, head: &Head, exit: usize) -> f64 {
        let forward = self.mesh.gaps()[head.edge].forward;
        let gap = &self.mesh.gaps()[exit];
        let leg = self.mesh.leg(head.edge, exit);
        let far = ((leg.length - self.parameters.spacing) / 2.0).max(0.0);
        let mut cost = self.gap_cost(gap.width) + (far * far).min(5.0) + self.colour_cost(leg.to, leg.side);
        // An edge of the track leads ahead, neither back nor around a sharp corner.
        cost += 2.5 * (0.3 - leg.along.dot(&forward)).max(0.0);
        if let Some(last) = head.legs[leg.side] {
            cost += 2.5 * (0.2 - last.dot(&leg.along)).max(0.0);
        }
        // The gap faces into the triangle, the path out of it.
        cost + 2.0 * (0.5 + gap.forward.dot(&forward)).max(0.0)
    }

    /// Keeps the best extensions, one per edge.
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

    /// Extends one path by a step.
    fn take(&self, search: &mut Search, step: &Step) {
        let Search { links, heads, earlier, depth, .. } = search;
        let head = &earlier[step.head];
        let leg = self.mesh.leg(head.edge, step.exit);
        let mut next = Head {
            link: link(links, self.mesh.pair(step.entry), Some(head.link)),
            edge: step.entry,
            cost: step.cost,
            // The distance between the midpoints of two sides of a triangle is half the third side.
            length: head.length + 0.5 * leg.length,
            ..*head
        };
        next.legs[leg.side] = Some(leg.along);
        next.trail[*depth % MEMORY] = triangle(step.entry);
        heads.push(next);
    }

    /// Cuts an open path at the horizon.
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
