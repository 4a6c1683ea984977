//! Maximum-likelihood estimate of the lane among cones.
//!
//! Cones of an edge stand close to it, others anywhere beyond it, and hardly any in between; an edge without
//! cones for long is unlikely. Each cone thus has a likelihood ratio with and without a lane. From a rough
//! path, expectation-maximisation finds the most likely lane: each cone is weighted by the probability that
//! it belongs to an edge, and least squares move the edges. The first rounds include cones some distance off;
//! the last ones only those next to an edge. Priors of any lane are included as well: its width is about the
//! previous one, and its curvature changes slowly.

use nalgebra::SMatrix;

use super::cone::Cone;
use super::curve::{ASIDE, BENDS, Beside, Curve, KNOTS, STEPS, TURNED, UNKNOWNS, Unknowns, WIDENS, WIDTH};
use super::lane_model::{Lane, LaneParameters, Way};
use super::rows::{Passage, leads_back, passes};
use crate::geometry::{Point, Pose, math};

type Information = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Typical distance of cones from their edge, as a fraction of `loose`.
const OFF: f64 = 0.25;
/// Factors on the distance within which cones count as those of the edge, from round to round.
const ROUNDS: [f64; 7] = [3.5, 2.5, 1.8, 1.3, 1.0, 1.0, 1.0];
/// Penalty of each exception: the logarithm of the odds against it, 1 to 55. Exceptions are a cone of the
/// other edge's colour, a cone in the lane, one that a car would touch, one just beside an edge that belongs
/// to none, a long edge without cones, a lane that turns back or between cones of one edge, and a lane other
/// than the previous one.
const UNUSUAL: f64 = 4.0;
/// Standard deviations of the regularity of lanes: half-width (relative), its growth (m/m), and the change of
/// curvature between knots (fraction of the maximum curvature).
const EVEN: f64 = 0.02;
/// Weight of a sudden change of curvature: small, because tracks have sharp bends.
const SHARP: f64 = 0.4;
/// Factor on the allowed change of curvature per unit of a round's reach beyond 1.
const SLOWLY: f64 = 6.0;
/// Standard deviation of the initial heading of the path (rad).
const HEADS: f64 = 0.2;
/// Number of steps between two checked points.
const STRIDE: usize = 4;

/// A lane fitted to cones.
#[derive(Debug, Clone)]
pub(super) struct LaneFit {
    /// Its centre line, as far as there are cones at its edges.
    pub(super) middle: Vec<Point>,
    /// Half its width beside the car (m).
    pub(super) half_width: f64,
    /// Cones of the left and the right edge, in order along it.
    pub(super) edges: [Vec<usize>; 2],
    /// Log-likelihood ratio of the cones with the lane and without any lane.
    pub(super) worth: f64,
}

/// Data that lanes are fitted to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fitter<'f> {
    pub(super) cones: &'f [Cone],
    pub(super) way: &'f Way<'f>,
    pub(super) earlier: &'f [Passage],
    /// The previous lane.
    pub(super) before: &'f Lane,
    pub(super) parameters: &'f LaneParameters,
}

/// A prior: a linear combination of unknowns, in standard deviations, and its residual.
#[derive(Debug, Clone, Copy)]
struct Expectation {
    sum: [(usize, f64); 2],
    off: f64,
    /// Whether the residual has a heavy-tailed (Student) rather than a Gaussian distribution.
    heavy: bool,
}

impl Expectation {
    /// Negative log-likelihood.
    fn cost(&self) -> f64 {
        let squared = self.off * self.off;
        if self.heavy { SHARP * math::ln(1.0 + squared) } else { 0.5 * squared }
    }

    /// Weight in least squares.
    fn weight(&self) -> f64 {
        if self.heavy { 2.0 * SHARP / (1.0 + self.off * self.off) } else { 1.0 }
    }
}

/// A cone of an edge: its position along it from the car (m), and its log-likelihood ratio.
#[derive(Debug, Clone, Copy)]
struct EdgeCone {
    cone: usize,
    along: f64,
    worth: f64,
}

impl Fitter<'_> {
    /// The most likely lane near some stations, with the index of the one beside the car; `None` without a
    /// path.
    pub(super) fn fit(&self, stations: &[Pose], car: usize) -> Option<LaneFit> {
        let mut curve = Curve::along(stations, car, self.before.half_width)?;
        for round in ROUNDS {
            self.improve(&mut curve, round);
        }
        Some(self.told(&curve))
    }

    /// Distance from the centre line within which cones are relevant (m).
    fn reach(&self) -> f64 {
        self.parameters.half_width[1] + self.parameters.loose + 2.0
    }

    /// Odds that a cone beside a curve belongs to its left and to its right edge.
    fn odds(&self, curve: &Curve, beside: &Beside, round: f64) -> [f64; 2] {
        let half_width = curve.half_width(beside.step);
        let known = self.cones[beside.cone].colour.side();
        let scale = OFF * self.parameters.loose * round;
        [1, -1].map(|side: i8| {
            let far = (f64::from(side) * beside.left - half_width) / scale;
            // Student's t-distribution with three degrees of freedom: some cones are farther off.
            let tail = 1.0 + far * far / 3.0;
            let mistaken = if known * side < 0 { math::exp(-UNUSUAL) } else { 1.0 };
            mistaken * math::exp(UNUSUAL) / (round * tail * tail)
        })
    }

    /// A Gauss-Newton step of a curve towards the most likely one.
    fn improve(&self, curve: &mut Curve, round: f64) {
        let (mut information, mut slope) = self.expected(curve, round);
        let scale = OFF * self.parameters.loose * round;
        for beside in curve.beside(self.cones, self.reach()) {
            let odds = self.odds(curve, &beside, round);
            let all = 1.0 + odds[0] + odds[1];
            let moves = curve.moves(beside.step);
            for (side, odds) in [1.0, -1.0].into_iter().zip(odds) {
                let off = side * beside.left - curve.half_width(beside.step);
                let weight = odds / all * 4.0 / (3.0 * scale * scale + off * off);
                let mut row = moves * -side;
                row[WIDTH] = -1.0;
                row[WIDENS] = -curve.past_car(beside.step);
                information.syger(weight, &row, &row, 1.0);
                slope += row * (off * weight);
            }
        }
        let Some(solver) = information.cholesky() else { return };
        let mut unknowns = curve.unknowns - solver.solve(&slope);
        let [least, most] = self.parameters.half_width;
        unknowns[WIDTH] = unknowns[WIDTH].clamp(least, most);
        curve.set(unknowns);
    }

    /// Information matrix and gradient of the priors.
    fn expected(&self, curve: &Curve, round: f64) -> (Information, Unknowns) {
        let (mut information, mut slope) = (Information::zeros(), Unknowns::zeros());
        for expectation in self.expectations(curve, round) {
            let weight = expectation.weight();
            for (i, a) in expectation.sum {
                slope[i] += weight * a * expectation.off;
                for (j, b) in expectation.sum {
                    information[(i, j)] += weight * a * b;
                }
            }
        }
        (information, slope)
    }

    fn expectations(&self, curve: &Curve, round: f64) -> impl Iterator<Item = Expectation> {
        let (p, usual, unknowns) = (self.parameters, self.before.half_width, curve.unknowns);
        let one = move |unknown: usize, expected: f64, deviation: f64| Expectation {
            sum: [(unknown, 1.0 / deviation), (unknown, 0.0)],
            off: (unknowns[unknown] - expected) / deviation,
            heavy: false,
        };
        let begin = [
            one(ASIDE, 0.0, p.loose),
            one(TURNED, 0.0, HEADS),
            one(WIDTH, usual, EVEN * usual),
            one(WIDENS, 0.0, EVEN),
        ];
        let bends = (BENDS..BENDS + KNOTS).map(move |knot| one(knot, 0.0, p.curvature));
        let deviation = EVEN * p.curvature * (1.0 + SLOWLY * (round - 1.0));
        let changes = (BENDS..BENDS + KNOTS - 1).map(move |knot| Expectation {
            sum: [(knot + 1, 1.0 / deviation), (knot, -1.0 / deviation)],
            off: (unknowns[knot + 1] - unknowns[knot]) / deviation,
            heavy: true,
        });
        begin.into_iter().chain(bends).chain(changes)
    }

    /// Likelihood of a curve, and the cones at its edges.
    fn told(&self, curve: &Curve) -> LaneFit {
        let mut edges: [Vec<EdgeCone>; 2] = [Vec::new(), Vec::new()];
        let mut worth = 0.0;
        for beside in curve.beside(self.cones, self.reach()) {
            let odds = self.odds(curve, &beside, 1.0);
            let likely = math::ln(1.0 + odds[0] + odds[1]);
            worth += likely - self.inside(curve, &beside);
            let side = usize::from(odds[1] > odds[0]);
            if odds[side] > 1.0 {
                edges[side].push(EdgeCone { cone: beside.cone, along: beside.along, worth: likely });
            }
        }
        for edge in &mut edges {
            edge.sort_by(|a, b| a.along.total_cmp(&b.along));
            worth -= twice(edge, self.parameters.loose) + self.holes(curve, edge);
        }
        worth -= self.expectations(curve, 1.0).map(|expectation| expectation.cost()).sum::<f64>();
        worth -= self.obstacles(curve) + self.back(curve) + self.through(curve) + self.changed(curve);
        let last = edges.iter().filter_map(|edge| edge.last()).map(|cone| cone.along).reduce(f64::max);
        let known = |last: f64| (last - curve.past_car(0)) / curve.step;
        let known = last.map_or(0, |last| known(last).max(0.0) as usize + 1);
        LaneFit {
            middle: curve.places[..known.min(STEPS + 1)].to_vec(),
            half_width: curve.unknowns[WIDTH],
            edges: edges.map(|edge| edge.iter().map(|cone| cone.cone).collect()),
            worth,
        }
    }

    /// Cost of a cone inside the lane.
    fn inside(&self, curve: &Curve, beside: &Beside) -> f64 {
        // It costs all of that as far within as a cone may be loose, and nothing up to half of it.
        let grows = 0.5 * self.parameters.loose;
        let aside = beside.left.abs();
        let within = (curve.half_width(beside.step) - aside) / grows - 1.0;
        let touched = (self.parameters.clearance - aside) / grows;
        UNUSUAL * (within.clamp(0.0, 1.0) + touched.clamp(0.0, 1.0))
    }

    /// Cost of long stretches without cones on an edge ahead of the car. Gaps behind the car are subtracted,
    /// because they exist whatever lies ahead.
    fn holes(&self, curve: &Curve, edge: &[EdgeCone]) -> f64 {
        let usual = 0.5 * self.parameters.spacing;
        let hole = |metres: f64| UNUSUAL * (1.0 - math::exp(-(metres / usual - 1.0).max(0.0)));
        let end = self.known(curve);
        let behind = edge.iter().map(|cone| cone.along).filter(|at| *at <= 0.0);
        let mut last = behind.fold(curve.past_car(0), f64::max);
        let mut cost = -hole(-last);
        let ahead = edge.iter().map(|cone| cone.along).filter(|at| (0.0..end).contains(at));
        for at in ahead.chain([end]) {
            cost += hole(at - last);
            last = at;
        }
        cost
    }

    /// Distance along a curve within which all cones are known (m).
    fn known(&self, curve: &Curve) -> f64 {
        let (car, most) = (self.way.car.position(), self.parameters.ahead);
        let is_far = |step: &usize| (curve.places[*step] - car).norm() > most;
        curve.past_car((curve.car..STEPS).find(is_far).unwrap_or(STEPS))
    }

    /// Cost of obstacles inside the lane that are not cones.
    fn obstacles(&self, curve: &Curve) -> f64 {
        let others: Vec<Cone> = self.way.others.iter().map(|place| Cone::unknown(*place)).collect();
        curve.beside(&others, self.reach()).iter().map(|beside| self.inside(curve, beside)).sum()
    }

    /// Cost of a curve that leads back to where the car came from.
    fn back(&self, curve: &Curve) -> f64 {
        let leads = |step: &usize| {
            let passage = Passage { place: curve.places[*step], ahead: curve.ahead[*step] };
            leads_back(passage, self.earlier, self.before.half_width)
        };
        UNUSUAL * (curve.car..=STEPS).step_by(STRIDE).filter(leads).count() as f64
    }

    /// Cost of a curve that passes between cones known to belong to one edge.
    fn through(&self, curve: &Curve) -> f64 {
        let usual = 0.5 * self.parameters.spacing;
        let places: Vec<Point> = curve.places[curve.car..].iter().step_by(STRIDE).copied().collect();
        let mut crossed = 0;
        for (i, a) in self.cones.iter().enumerate().filter(|(_, cone)| cone.colour.side() != 0) {
            for b in self.cones[..i].iter().filter(|b| b.colour.side() == a.colour.side()) {
                if (a.position - b.position).norm_squared() < usual * usual {
                    let crosses = |way: &&[Point]| passes([way[0], way[1]], [a.position, b.position]);
                    crossed += places.windows(2).filter(crosses).count();
                }
            }
        }
        UNUSUAL * crossed as f64
    }

    /// Cost of differing from the previous lane.
    fn changed(&self, curve: &Curve) -> f64 {
        let ahead = curve.places[curve.car..].iter().step_by(STRIDE);
        let count = ahead.len() as f64;
        UNUSUAL * ahead.map(|place| self.before.away(*place)).sum::<f64>() / count
    }
}

/// What cones of an edge are worth that stand as near to another one as they may be loose: of an edge that
/// tells one thing, not two.
fn twice(edge: &[EdgeCone], loose: f64) -> f64 {
    let less = |pair: &[EdgeCone]| {
        if pair[1].along - pair[0].along < loose { pair[0].worth.min(pair[1].worth) } else { 0.0 }
    };
    edge.windows(2).map(less).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::direction;
    use proptest::prelude::*;

    /// Pose on a bend that begins at the car, at a distance along the lane.
    fn on_bend(curvature: f64, along: f64) -> Pose {
        let turn = curvature * along.max(0.0);
        let way = direction(0.5 * turn) * along;
        Pose::new(way.x, way.y, turn)
    }

    /// Cones at both edges of a lane 3.6 m wide, right edge first.
    fn edges(curvature: f64) -> Vec<Cone> {
        let edge = |side: f64| {
            (-2..6).map(move |k| on_bend(curvature, 3.0 * f64::from(k)).to_world(Point::new(0.0, 1.8 * side)))
        };
        edge(-1.0).chain(edge(1.0)).map(Cone::unknown).collect()
    }

    fn fitted(cones: &[Cone], ahead: &[Pose]) -> LaneFit {
        let behind: Vec<Pose> = [-6.0, -4.0, -2.0].map(|x| Pose::new(x, 0.0, 0.0)).to_vec();
        let way = Way { behind: &behind, car: Pose::default(), earlier: &[], others: &[] };
        let before = Lane::unknown(1.8);
        let parameters = LaneParameters::default();
        let fitter = Fitter { cones, way: &way, earlier: &[], before: &before, parameters: &parameters };
        let stations = [&behind[..], &[way.car], ahead].concat();
        fitter.fit(&stations, behind.len()).unwrap()
    }

    /// A path along a bend, with a lateral error per metre.
    fn rough(curvature: f64, aside: f64) -> Vec<Pose> {
        (1..=17)
            .map(|k| on_bend(curvature, f64::from(k)).compose(&Pose::new(0.0, aside * f64::from(k), 0.0)))
            .collect()
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn false_cones_do_not_move_a_lane(
            curvature in -0.12..0.12f64, aside in -0.03..0.03f64, at in 0.0..12.0f64, beyond in 1.2..2.5f64, left: bool,
        ) {
            let mut cones = edges(curvature);
            let aside_of = |y: f64| if left { y } else { -y };
            cones.push(Cone::unknown(on_bend(curvature, at).to_world(Point::new(0.0, aside_of(1.8 + beyond)))));
            let found = fitted(&cones, &rough(curvature, aside));
            prop_assert_eq!(&found.edges[1], &(0..8).collect::<Vec<_>>());
            prop_assert_eq!(&found.edges[0], &(8..16).collect::<Vec<_>>());
            for point in &found.middle {
                let off = (-60..180).map(|k| (on_bend(curvature, 0.1 * f64::from(k)).position() - point).norm());
                prop_assert!(off.fold(f64::INFINITY, f64::min) < 0.2, "{point}");
            }
        }

        #[test]
        fn a_way_that_leads_off_the_lane_leads_to_none_that_is_better(curvature in -0.1..0.1f64, missing in 0..16usize) {
            let mut cones = edges(curvature);
            cones.remove(missing);
            let right = fitted(&cones, &rough(curvature, 0.0));
            let wrong = fitted(&cones, &rough(curvature, 0.2));
            // Both may end in the same lane, except for convergence error: much less than the 3.3 that a cone
            // is worth.
            prop_assert!(right.worth > wrong.worth - 1.0, "{} {}", right.worth, wrong.worth);
            prop_assert!(right.worth > 20.0);
        }
    }

    #[test]
    fn cones_that_are_next_to_each_other_count_once() {
        let mut cones = edges(0.0);
        let once = fitted(&cones, &rough(0.0, 0.0)).worth;
        cones.push(Cone::unknown(cones[4].position + crate::geometry::Vector::new(0.3, 0.02)));
        let twice = fitted(&cones, &rough(0.0, 0.0)).worth;
        assert!((once - twice).abs() < 0.3, "{once} {twice}");
    }

    #[test]
    fn a_lane_with_one_edge_is_worth_less_and_is_one() {
        let all = edges(0.04);
        let right: Vec<Cone> = all[..8].to_vec();
        let ahead = rough(0.04, 0.0);
        let (both, one) = (fitted(&all, &ahead), fitted(&right, &ahead));
        assert!(one.worth > 0.0 && both.worth > one.worth + 8.0 * 2.5, "{} {}", one.worth, both.worth);
        let away = one.middle.iter().zip(&both.middle).map(|(a, b)| (a - b).norm());
        assert!(away.fold(0.0, f64::max) < 0.15, "{one:?} {both:?}");
    }
}
