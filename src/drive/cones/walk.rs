//! From triangle to triangle between cones.

use super::centre_line::CentreLineParameters;
use super::cone::Cone;
use super::error::PlanError;
use crate::geometry::{Point, Pose, Vector, cross};

/// Indices of a left and a right cone with the way between them.
pub(super) type Pair = [usize; 2];

/// A way between cones.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Way {
    pub(super) pairs: Vec<Pair>,
    pub(super) closed: bool,
}

/// Ways that are followed at a time.
const BEAM: usize = 8;
/// Edges at which a way may begin.
const STARTS: usize = 5;
/// What a cone costs that was passed on the other side.
const WRONG_SIDE: f64 = 6.0;
/// What a step as on a track is worth where loops are compared.
const GOOD_STEP: f64 = 0.15;
/// Triangles back to which a way may not return.
const MEMORY: usize = 16;

/// The triangulation of some cones.
pub(super) struct Mesh {
    triangles: Vec<usize>,
    twins: Vec<usize>,
    /// Whether the triangles turn counter-clockwise.
    counter_clockwise: bool,
    /// What there is to know of each half-edge, for whoever enters its triangle by it.
    gaps: Vec<Gap>,
}

/// The gap between a left and a right cone.
#[derive(Debug, Clone, Copy)]
struct Gap {
    middle: Point,
    /// The unit vector through it.
    forward: Vector,
    width: f64,
}

impl Gap {
    fn between(left: Point, right: Point) -> Self {
        let across = left - right;
        let width = across.norm();
        let forward = Vector::new(across.y, -across.x) / width.max(1e-9);
        Self { middle: nalgebra::center(&left, &right), forward, width }
    }

    /// The same for whoever comes from the other side.
    fn reversed(self) -> Self {
        Self { forward: -self.forward, ..self }
    }
}

/// Goes from triangle to triangle between some cones.
pub(super) struct Walker<'c> {
    pub(super) cones: &'c [Cone],
    pub(super) parameters: &'c CentreLineParameters,
    /// The triangulation of these cones.
    pub(super) mesh: &'c Mesh,
    /// On which side of the way that was driven before each cone is, 1 for left; empty without one.
    pub(super) sides: &'c [i8],
}

/// The best way so far: how bad it is, and its last node.
type Best = Option<(f64, usize)>;

/// Takes in a way, if it is better than the best one.
fn keep(best: &mut Best, badness: f64, node: usize) {
    if best.is_none_or(|(least, _)| badness < least) {
        *best = Some((badness, node));
    }
}

/// Ways that are being followed.
struct Search {
    /// The steps of all ways.
    nodes: Vec<Node>,
    /// The edges at which they begin.
    roots: Vec<usize>,
    /// The last steps of those that are followed now.
    beam: Vec<usize>,
    /// The best ways so far that closed, and that ended.
    closed: Best,
    ended: Best,
}

impl Search {
    fn new(starts: Vec<Node>) -> Self {
        let roots = starts.iter().map(|node| node.edge).collect();
        let beam = (0..starts.len()).collect();
        Self { nodes: starts, roots, beam, closed: None, ended: None }
    }

    /// Follows the best ones of some steps, one at each edge.
    fn follow(&mut self, candidates: &mut [Node]) {
        candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        self.beam.clear();
        for candidate in candidates.iter() {
            if self.beam.len() == BEAM {
                break;
            }
            if !self.beam.iter().any(|&other| self.nodes[other].edge == candidate.edge) {
                self.nodes.push(*candidate);
                self.beam.push(self.nodes.len() - 1);
            }
        }
    }

    /// The pairs of the best way, and whether it is closed.
    fn best(&self) -> Option<(Vec<Pair>, bool)> {
        let (_, end) = self.closed.or(self.ended)?;
        let mut pairs = Vec::new();
        let mut at = Some(end);
        while let Some(index) = at {
            pairs.push(self.nodes[index].pair);
            at = self.nodes[index].parent;
        }
        pairs.reverse();
        Some((pairs, self.closed.is_some()))
    }
}

/// A step of a way: an edge that is crossed, and how it got there.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// The half-edge of the triangle that is entered.
    edge: usize,
    pair: Pair,
    /// The cones of both sides before these.
    before: [Option<usize>; 2],
    parent: Option<usize>,
    root: usize,
    cost: f64,
    length: f64,
    /// Steps from cone to cone as on a track.
    good: u32,
}

impl Mesh {
    pub(super) fn new(cones: &[Cone]) -> Result<Self, PlanError> {
        if cones.len() < 3 {
            return Err(PlanError::TooFew { found: cones.len(), needed: 3 });
        }
        if let Some(index) =
            cones.iter().position(|c| !(c.position.x.is_finite() && c.position.y.is_finite()))
        {
            return Err(PlanError::Degenerate { index });
        }
        let points: Vec<_> =
            cones.iter().map(|c| delaunator::Point { x: c.position.x, y: c.position.y }).collect();
        let triangulation = delaunator::triangulate(&points);
        let triangles = triangulation.triangles;
        if triangles.is_empty() {
            return Err(PlanError::NoWay);
        }
        let at = |k: usize| cones[triangles[k]].position;
        let counter_clockwise = cross(at(1) - at(0), at(2) - at(0)) > 0.0;
        let gap = |edge: usize| {
            let [a, b] = [at(edge), at(following(edge))];
            if counter_clockwise { Gap::between(a, b) } else { Gap::between(b, a) }
        };
        let gaps = (0..triangles.len()).map(gap).collect();
        Ok(Self { gaps, triangles, twins: triangulation.halfedges, counter_clockwise })
    }
}

impl Walker<'_> {
    fn position(&self, cone: usize) -> Point {
        self.cones[cone].position
    }

    /// The left and the right cone for whoever enters a triangle by a half-edge.
    fn pair(&self, edge: usize) -> Pair {
        let (a, b) = (self.mesh.triangles[edge], self.mesh.triangles[following(edge)]);
        if self.mesh.counter_clockwise { [a, b] } else { [b, a] }
    }

    /// What a pair costs by itself: for being too near or too far from each other, and for wrong colours.
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

    /// Edges across the car's way, nearly where it is, the best first.
    fn starts(&self, car: Pose) -> Vec<Node> {
        let mut found: Vec<(f64, usize)> = (0..self.mesh.triangles.len())
            .filter_map(|edge| {
                let (pair, gap) = (self.pair(edge), self.mesh.gaps[edge]);
                let local = car.to_local(gap.middle);
                let turn = 1.0 - gap.forward.dot(&car.forward());
                if !(-2.0..9.0).contains(&local.x) || local.y.abs() > 3.5 || turn > 0.5 {
                    return None;
                }
                let away = (local.x - 1.0).abs() * 0.15 + local.y.abs() * 0.4;
                let colours = self.colour_cost(pair[0], 0) + self.colour_cost(pair[1], 1);
                // The car passes between them and not beside both.
                let sides = [car.to_local(self.position(pair[0])).y, car.to_local(self.position(pair[1])).y];
                let beside = if sides[0] > 0.0 && sides[1] < 0.0 { 0.0 } else { 4.0 };
                Some((away + 4.0 * turn + colours + beside + self.gap_cost(gap.width), edge))
            })
            .collect();
        found.retain(|(cost, _)| cost.is_finite());
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.truncate(STARTS);
        let node = |(root, (cost, edge)): (usize, (f64, usize))| {
            let pair = self.pair(edge);
            Node { edge, pair, before: [None; 2], parent: None, root, cost, length: 0.0, good: 0 }
        };
        found.into_iter().enumerate().map(node).collect()
    }

    /// The best way from a car on. `None` if there is none.
    pub(super) fn walk(&self, car: Pose) -> Option<Way> {
        let mut search = Search::new(self.starts(car));
        let mut candidates: Vec<Node> = Vec::new();
        for left in (0..self.cones.len() + self.cones.len() / 4 + 8).rev() {
            candidates.clear();
            self.steps(&mut search, &mut candidates);
            // Nothing takes costs back, so a way is left that cannot become a better loop than the best one, were all its steps good.
            let bound = search.closed.map_or(f64::INFINITY, |(badness, _)| badness);
            let best = |node: &Node| node.cost - GOOD_STEP * (f64::from(node.good) + left as f64);
            candidates.retain(|candidate| candidate.cost.is_finite() && best(candidate) < bound);
            if candidates.is_empty() {
                break;
            }
            search.follow(&mut candidates);
        }
        let (mut pairs, closed) = search.best()?;
        if !closed {
            self.cut(&mut pairs);
        }
        (pairs.len() >= 2).then_some(Way { pairs, closed })
    }

    /// The next steps of all ways that are followed. Those that close or end are taken in.
    fn steps(&self, search: &mut Search, candidates: &mut Vec<Node>) {
        for &index in &search.beam {
            let node = search.nodes[index];
            // A way that ends is better the farther it leads.
            let reached = node.length.min(self.parameters.horizon);
            keep(&mut search.ended, node.cost - 0.4 * reached, index);
            let root = search.roots[node.root];
            for exit in [following(node.edge), preceding(node.edge)] {
                let twin = self.mesh.twins[exit];
                if twin == delaunator::EMPTY {
                    self.leave(&mut search.nodes, index, exit, &mut search.ended);
                } else if twin / 3 == root / 3 && node.length > self.parameters.shortest_loop {
                    let aslant = if twin == root { 0.0 } else { 0.5 };
                    // Of two loops, that with more of what a track looks like: not the shorter one.
                    keep(&mut search.closed, node.cost + aslant - GOOD_STEP * f64::from(node.good), index);
                } else if !was_in(&search.nodes, index, twin / 3) {
                    let step = self.step(&node, index, (self.pair(twin), self.mesh.gaps[twin]), twin);
                    candidates.push(step);
                }
            }
        }
    }

    /// A way over the border of the triangulation ends there.
    fn leave(&self, nodes: &mut Vec<Node>, index: usize, exit: usize, ended: &mut Best) {
        let node = nodes[index];
        let [a, b] = self.pair(exit);
        // Seen from the triangle that is left, the sides are the other way around.
        let last = self.step(&node, index, ([b, a], self.mesh.gaps[exit].reversed()), exit);
        let badness = last.cost - 0.4 * last.length.min(self.parameters.horizon);
        if ended.is_none_or(|(least, _)| badness < least) {
            nodes.push(last);
            *ended = Some((badness, nodes.len() - 1));
        }
    }

    /// The step to a pair that shares a cone with the present one.
    fn step(&self, node: &Node, parent: usize, (pair, gap): (Pair, Gap), edge: usize) -> Node {
        let from = self.mesh.gaps[node.edge];
        let side = usize::from(pair[0] == node.pair[0]);
        let (new, old) = (pair[side], node.pair[side]);
        let leg = self.position(new) - self.position(old);
        let length = leg.norm();
        let far = ((length - self.parameters.spacing) / 2.0).max(0.0);
        let mut cost = self.gap_cost(gap.width) + (far * far).min(5.0) + self.colour_cost(new, side);
        // An edge goes on ahead: neither back nor around a sharp corner.
        let ahead = leg.dot(&from.forward) / length.max(1e-9);
        cost += 2.5 * (0.3 - ahead).max(0.0);
        if let Some(earlier) = node.before[side] {
            let last = self.position(old) - self.position(earlier);
            let turn = last.dot(&leg) / (last.norm() * length).max(1e-9);
            cost += 2.5 * (0.2 - turn).max(0.0);
        }
        let turn = gap.forward.dot(&from.forward);
        cost += 2.0 * (0.5 - turn).max(0.0);
        let good = node.good + u32::from(cost < 0.3);
        let mut before = node.before;
        before[side] = Some(old);
        let length = node.length + (gap.middle - from.middle).norm();
        Node {
            edge,
            pair,
            before,
            parent: Some(parent),
            root: node.root,
            cost: node.cost + cost,
            length,
            good,
        }
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

/// Whether a way was in a triangle lately.
fn was_in(nodes: &[Node], index: usize, triangle: usize) -> bool {
    let mut at = Some(index);
    for _ in 0..MEMORY {
        let Some(node) = at else { return false };
        if nodes[node].edge / 3 == triangle {
            return true;
        }
        at = nodes[node].parent;
    }
    false
}

/// On which side of a way that was driven before each cone is, 1 for left: by the leg that is nearest to it. Ways whose ends are
/// near each other are closed. Nothing for a way of less than two points. Takes O(n m) for n cones and m points.
pub(super) fn sides(cones: &[Cone], way: &[Point]) -> Vec<i8> {
    let [first, .., last] = way else { return Vec::new() };
    let n = way.len();
    let legs = if (first - last).norm() < 8.0 { n } else { n - 1 };
    let legs: Vec<Leg> = (0..legs).map(|i| Leg::new(way[i], way[(i + 1) % n])).collect();
    cones.iter().map(|cone| side_of(&legs, cone.position)).collect()
}

/// A leg of a way, and the square of its length upside down.
#[derive(Debug, Clone, Copy)]
struct Leg {
    from: Point,
    along: Vector,
    inverse: f64,
}

impl Leg {
    fn new(from: Point, to: Point) -> Self {
        let along = to - from;
        Self { from, along, inverse: 1.0 / along.norm_squared().max(1e-18) }
    }
}

fn side_of(legs: &[Leg], point: Point) -> i8 {
    let mut best = (f64::INFINITY, Vector::zeros(), Vector::zeros());
    for leg in legs {
        let away = point - leg.from;
        let share = (away.dot(&leg.along) * leg.inverse).clamp(0.0, 1.0);
        let squared = (away - leg.along * share).norm_squared();
        if squared < best.0 {
            best = (squared, leg.along, away);
        }
    }
    if cross(best.1, best.2) > 0.0 { 1 } else { -1 }
}

fn following(edge: usize) -> usize {
    if edge % 3 == 2 { edge - 2 } else { edge + 1 }
}

fn preceding(edge: usize) -> usize {
    if edge.is_multiple_of(3) { edge + 2 } else { edge - 1 }
}

#[cfg(test)]
mod tests {
    use crate::drive::cones::*;
    use crate::geometry::{Point, Pose};
    use crate::random::Stream;

    const TRACKS: u64 = if cfg!(debug_assertions) { 50 } else { 500 };

    fn blind(cones: &[Cone]) -> Vec<Cone> {
        cones.iter().map(|cone| Cone::unknown(cone.position)).collect()
    }

    /// The greatest distance of the found middle from the true one.
    fn error(found: &CentreLine, truth: &Corridor) -> f64 {
        let middle: Vec<Point> = truth.stations().iter().map(|s| s.position).collect();
        let away = |p: Point| middle.iter().map(|m| (m - p).norm()).fold(f64::INFINITY, f64::min);
        found.corridor.stations().iter().map(|s| away(s.position)).fold(0.0, f64::max)
    }

    /// Plans on many tracks from which a function takes cones away or to which it adds some. The share of plans that are closed
    /// and nowhere farther than so many metres from the true middle; with `driven`, the way of the first lap is known.
    fn share(wrong: f64, driven: bool, change: impl Fn(&GeneratedTrack, &mut Stream) -> Vec<Cone>) -> f64 {
        let mut good = 0;
        for seed in 0..TRACKS {
            let generated = generate(seed, &TrackOptions::drawn(seed)).unwrap();
            let mut random = Stream::new(seed).child("change", 0);
            let cones = blind(&change(&generated, &mut random));
            // A first lap is driven some decimetres beside the middle.
            let stations = generated.corridor.stations().iter().step_by(2);
            let way: Vec<Point> = stations.map(|s| s.aside(random.between(-0.4, 0.4))).collect();
            let way = if driven { way } else { Vec::new() };
            let start = generated.track.start.unwrap();
            let found = CentreLine::along(&cones, start, &way, &CentreLineParameters::default());
            match found.map(|line| (line.corridor.is_closed(), error(&line, &generated.corridor))) {
                Ok((true, error)) if error < wrong => good += 1,
                other => eprintln!("{seed}: {other:?}"),
            }
        }
        f64::from(good) / TRACKS as f64
    }

    fn with_false_and_missing(generated: &GeneratedTrack, random: &mut Stream) -> Vec<Cone> {
        let GeneratedTrack { track, corridor } = generated;
        let mut cones: Vec<Cone> = track.cones.iter().copied().filter(|_| !random.chance(0.1)).collect();
        let n = corridor.stations().len();
        for _ in 0..cones.len() / 10 {
            let station = corridor.stations()[random.below(n)];
            let offset = station.left + random.between(0.8, 3.0);
            cones.push(Cone::unknown(station.aside(if random.chance(0.5) { offset } else { -offset })));
        }
        // None in the middle of another part of the track.
        cones.retain(|c| corridor.stations().iter().all(|s| (s.position - c.position).norm() > s.left - 0.2));
        cones
    }

    fn with_a_gap(generated: &GeneratedTrack, random: &mut Stream) -> Vec<Cone> {
        let GeneratedTrack { track, corridor } = generated;
        let n = corridor.stations().len();
        let (from, left) = (30 + random.below(n - 60), random.chance(0.5));
        let side = if left { ConeColour::Blue } else { ConeColour::Yellow };
        let edge = corridor.edge(left);
        let gone =
            |c: &Cone| c.colour == side && (from..from + 20).any(|k| (edge[k] - c.position).norm() < 0.8);
        track.cones.iter().copied().filter(|c| !gone(c)).collect()
    }

    #[test]
    fn generated_tracks_without_colours() {
        assert_eq!(share(1.0, false, |generated, _| generated.track.cones.clone()), 1.0);
    }

    #[test]
    fn cones_missing_and_too_many() {
        assert!(share(1.8, true, with_false_and_missing) >= 0.9);
    }

    #[test]
    fn one_side_is_missing_for_twenty_metres() {
        assert!(share(1.8, true, with_a_gap) >= 0.8);
        // Without a lap that was driven, the colours would tell; a colour-blind plan is right for most tracks only.
        assert!(share(1.8, false, with_a_gap) >= 0.6);
    }

    #[test]
    fn too_few_cones_or_none_ahead() {
        let p = CentreLineParameters::default();
        let two = [Cone::unknown(Point::origin()); 2];
        let error = CentreLine::from_cones(&two, Pose::default(), &p).unwrap_err();
        assert_eq!(error, PlanError::TooFew { found: 2, needed: 3 });
        let far: Vec<Cone> =
            (0..9).map(|i| Cone::unknown(Point::new(90.0 + f64::from(i % 3), f64::from(i / 3)))).collect();
        assert_eq!(CentreLine::from_cones(&far, Pose::default(), &p).unwrap_err(), PlanError::NoWay);
        let line: Vec<Cone> = (0..9).map(|i| Cone::unknown(Point::new(f64::from(i), 0.0))).collect();
        assert_eq!(CentreLine::from_cones(&line, Pose::default(), &p).unwrap_err(), PlanError::NoWay);
        let mut bad = far;
        bad[4].position.x = f64::NAN;
        assert_eq!(
            CentreLine::from_cones(&bad, Pose::default(), &p).unwrap_err(),
            PlanError::Degenerate { index: 4 }
        );
    }
}
