//! State of the road with its covariance: pose of the car on it, curvatures ahead, width, and the camera's
//! pitch error. All lengths are at the scale of the rules.

use nalgebra::{SMatrix, SVector};

use super::curve::{Bends, Curve, Foot, KNOTS, SPACING, bend_at};
use super::{MarkingPoint, RoadCamera};
use crate::geometry::{Point, Pose, Vector, math};

/// Number of states of a road.
pub(super) const STATES: usize = KNOTS + 4;
/// Index of the offset to the left of the road's centre line (m).
const OFFSET: usize = 0;
/// Index of the heading to the left of it (rad).
const HEADING: usize = 1;
/// Index of the first curvature (1/m).
const BENDS: usize = 2;
/// Index of the distance from the centre line to an edge line (m).
const EDGE: usize = BENDS + KNOTS;
/// Index of the pitch of the camera (rad).
const PITCH: usize = EDGE + 1;

pub(super) type State = SVector<f64, STATES>;
pub(super) type Covariance = SMatrix<f64, STATES, STATES>;

/// Estimate of the road.
#[derive(Debug, Clone)]
pub(super) struct Road {
    pub(super) state: State,
    pub(super) covariance: Covariance,
}

/// A point's contribution to the fit.
struct Measured {
    residual: f64,
    slope: State,
    sigma: f64,
    along: f64,
}

/// Initial standard deviations of offset, heading, curvatures, edge and pitch.
const FIRST: [f64; 5] = [0.12, 0.12, 0.7, 0.035, 0.01];
/// Initial distance from the road's centre line to an edge line (m).
const EDGE_AT_FIRST: f64 = 0.42;
/// Process noise: deviations per square root of the distance driven.
const DRIFT: [f64; 5] = [0.009, 0.020, 0.20, 0.003, 0.0005];
/// Curvature of a road that is not yet in view: its deviation (1/m), and the distance in which it decays (m).
const UNSEEN: (f64, f64) = (0.6, 1.5);
/// Soft limit of a road's curvature, with its deviation (1/m).
const TIGHTEST: (f64, f64) = (1.0, 0.1);
/// Soft range of a road's edge, with its deviation (m).
const EDGES: ([f64; 2], f64) = ([0.36, 0.48], 0.01);
/// Uncertainty of a line's centre: constant (m), and as a fraction of a pixel.
const BLUR: (f64, f64) = (0.006, 0.6);
/// Deviation of a line between knots from the model, per square of the distance ahead (m per m²).
const ROUGH: f64 = 0.010;
/// Number of points that count as one: points of a frame share the errors of camera and model.
const TOGETHER: f64 = 8.0;
/// Distance between the lines of a pair (m).
const PAIR: f64 = 0.02;
/// Least cosine of the angle of a road to the car at which rows are still across it: 66 degrees.
const ALONG: f64 = 0.4;
/// Number of knots that are kept where the road ahead is followed: so far, it has been seen for a while. With
/// one fewer, a narrow lens misses half of the stop lines behind tight bends.
const KEPT: usize = 2;
/// Passes in which the road ahead is followed: distance from a line within which points count, and distance
/// along the road up to which they do (m). From one to the next, the tightest road leaves its tangent by less
/// than half the distance between two lines.
const FOLLOWED: [(f64, f64); 7] =
    [(0.05, 0.5), (0.05, 0.75), (0.05, 1.0), (0.05, 1.3), (0.05, 1.6), (0.03, 2.0), (0.03, f64::INFINITY)];

impl Road {
    /// The estimate before the road is seen, from the car's offset and heading.
    pub(super) fn new(offset: f64, heading: f64, bend: f64, edge: Option<f64>) -> Self {
        let mut state = State::zeros();
        state[OFFSET] = offset;
        state[HEADING] = heading;
        (0..KNOTS).for_each(|knot| state[BENDS + knot] = bend);
        state[EDGE] = edge.unwrap_or(EDGE_AT_FIRST);
        let mut covariance = Covariance::zeros();
        for (index, sigma) in deviations(FIRST).into_iter().enumerate() {
            covariance[(index, index)] = sigma * sigma;
        }
        Self { state, covariance }
    }

    pub(super) fn offset(&self) -> f64 {
        self.state[OFFSET]
    }

    pub(super) fn heading(&self) -> f64 {
        self.state[HEADING]
    }

    pub(super) fn edge(&self) -> f64 {
        self.state[EDGE]
    }

    pub(super) fn pitch(&self) -> f64 {
        self.state[PITCH]
    }

    pub(super) fn bends(&self) -> Bends {
        std::array::from_fn(|knot| self.state[BENDS + knot])
    }

    /// Standard deviations of the offset plus a multiple of the edge, of the heading, and of the curvature.
    pub(super) fn sigmas(&self, share: f64) -> [f64; 3] {
        let p = &self.covariance;
        let offset = p[(OFFSET, OFFSET)] + 2.0 * share * p[(OFFSET, EDGE)] + share * share * p[(EDGE, EDGE)];
        [offset, p[(HEADING, HEADING)], p[(BENDS, BENDS)]].map(|variance| variance.max(0.0).sqrt())
    }

    /// Predicts the state after the car has driven a distance (m) and turned to the left by an angle (rad).
    pub(super) fn drive(&mut self, metres: f64, turn: f64) {
        let (offset, heading) = (self.state[OFFSET], self.state[HEADING] + 0.5 * turn);
        let (sin, cos) = math::sin_cos(heading);
        let bends = self.bends();
        let along = metres * cos / (1.0 - bends[0] * offset).max(0.3);
        let mut step = Covariance::identity();
        step[(OFFSET, HEADING)] = metres * cos;
        step[(HEADING, BENDS)] = -along;
        step[(HEADING, OFFSET)] = -bends[0] * bends[0] * along;
        let share = (along / SPACING).clamp(-1.0, 1.0);
        for knot in 0..KNOTS - 1 {
            step[(BENDS + knot, BENDS + knot)] = 1.0 - share;
            step[(BENDS + knot, BENDS + knot + 1)] = share;
        }
        let ahead: Bends = std::array::from_fn(|knot| bend_at(&bends, SPACING * knot as f64 + along));
        self.state[OFFSET] += metres * sin;
        self.state[HEADING] += turn - 0.5 * along * (bends[0] + ahead[0]);
        (0..KNOTS).for_each(|knot| self.state[BENDS + knot] = ahead[knot]);
        self.covariance = step * self.covariance * step.transpose();
        for (index, sigma) in deviations(DRIFT).into_iter().enumerate() {
            self.covariance[(index, index)] += sigma * sigma * metres.abs();
        }
        self.forget(along.abs());
    }

    /// The part that comes into view is unknown: the farthest curvature decays towards zero.
    fn forget(&mut self, along: f64) {
        let last = BENDS + KNOTS - 1;
        let kept = math::exp(-along / UNSEEN.1);
        self.state[last] *= kept;
        for i in 0..STATES {
            self.covariance[(last, i)] *= kept;
            self.covariance[(i, last)] *= kept;
        }
        self.covariance[(last, last)] += (1.0 - kept * kept) * UNSEEN.0 * UNSEEN.0;
    }

    /// Adds the prior of all roads: how tight their bends are, and how wide they are.
    fn bound(&self, information: &mut Covariance, pull: &mut State) {
        let mut keep = |index: usize, [least, most]: [f64; 2], sigma: f64| {
            let excess = self.state[index] - self.state[index].clamp(least, most);
            if excess != 0.0 {
                information[(index, index)] += 1.0 / (sigma * sigma);
                pull[index] -= excess / (sigma * sigma);
            }
        };
        (0..KNOTS).for_each(|knot| keep(BENDS + knot, [-TIGHTEST.0, TIGHTEST.0], TIGHTEST.1));
        keep(EDGE, EDGES.0, EDGES.1);
    }

    /// Fits the state to points; weights exclude points of no line of the road. `wide` is the initial
    /// distance within which points count (m). Returns the weight of the points within 1.5 m.
    pub(super) fn see(&mut self, points: &[MarkingPoint], camera: &RoadCamera, wide: f64) -> f64 {
        let passes = [wide, 0.6 * wide, 0.03, 0.03].map(|limit| (limit, f64::INFINITY));
        self.fit(points, camera, &passes)
    }

    /// The same road with its curvatures ahead unknown, fitted to points from near to far, and the weight of
    /// the points within 1.5 m. The lines of a road are parallel, and all look alike: where a bend is farther
    /// off than expected by the distance between two of them, each is taken for the next one. Where most
    /// lines are missing, a few that lie beside those expected bend the road away from the others. A fit by
    /// all points at once stays there, and one from near to far does not get there.
    pub(super) fn followed(&self, points: &[MarkingPoint], camera: &RoadCamera) -> (Self, f64) {
        let mut road = self.clone();
        for index in BENDS + KEPT..BENDS + KNOTS {
            road.state[index] = self.state[BENDS + KEPT - 1];
            road.covariance.row_mut(index).fill(0.0);
            road.covariance.column_mut(index).fill(0.0);
            road.covariance[(index, index)] = UNSEEN.0 * UNSEEN.0;
        }
        let support = road.fit(points, camera, &FOLLOWED);
        (road, support)
    }

    /// How many times as far apart two lines are at a place, along a row across the car, as across the road.
    pub(super) fn slant(&self, curve: &Curve, place: Point) -> f64 {
        let car = Pose::new(0.0, self.offset(), self.heading());
        let (sin, cos) = math::sin_cos(self.heading());
        let foot = curve.foot(car.to_world(place));
        foot.map_or(1.0, |foot| 1.0 / (cos * foot.normal.y - sin * foot.normal.x).abs().max(ALONG))
    }

    /// Fits in passes: distance from a line within which points count, and distance along the road up to
    /// which they do (m).
    fn fit(&mut self, points: &[MarkingPoint], camera: &RoadCamera, passes: &[(f64, f64)]) -> f64 {
        let Some(prior) = self.covariance.cholesky().map(|root| root.inverse()) else { return 0.0 };
        let before = self.state;
        let mut support = 0.0;
        let mut information = prior;
        for &(limit, reach) in passes {
            let curve = Curve::new(&self.bends());
            information = prior;
            let mut pull = prior * (before - self.state);
            support = 0.0;
            for point in points {
                let Some(seen) = self.measure(&curve, point, camera).filter(|seen| seen.along < reach) else {
                    continue;
                };
                let off = seen.residual / (limit + 2.0 * seen.sigma);
                let fits = 1.0 / (1.0 + off * off);
                let weight = fits * fits / (TOGETHER * seen.sigma * seen.sigma);
                information += seen.slope * seen.slope.transpose() * weight;
                pull += seen.slope * (seen.residual * weight);
                if seen.along < 1.5 {
                    support += fits * fits;
                }
            }
            self.bound(&mut information, &mut pull);
            let Some(root) = information.cholesky() else { return 0.0 };
            self.state += root.solve(&pull);
        }
        if let Some(root) = information.cholesky() {
            self.covariance = root.inverse();
        }
        support
    }

    /// Quality of fit without fitting: each point counts up to 1.
    pub(super) fn score(&self, points: &[MarkingPoint], camera: &RoadCamera) -> f64 {
        let curve = Curve::new(&self.bends());
        let fits = points.iter().filter_map(|point| {
            let seen = self.measure(&curve, point, camera)?;
            let off = seen.residual / 0.04;
            Some(1.0 / (1.0 + off * off))
        });
        fits.sum()
    }

    /// Residual of a point: its distance from the nearest line, and the derivative by the state.
    fn measure(&self, curve: &Curve, point: &MarkingPoint, camera: &RoadCamera) -> Option<Measured> {
        let lift = camera.lift(point.place);
        let place = point.place + lift * self.pitch();
        let (sin, cos) = math::sin_cos(self.heading());
        let turned = |v: Vector| Vector::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y);
        let own = turned(place.coords);
        let Foot { along, left, normal, slopes } = curve.foot(Point::new(own.x, self.offset() + own.y))?;
        let edge = self.edge();
        // The nearest line: left edge, right edge, or centre, which may be a pair of lines.
        let (line, per_edge) = match left / edge {
            share if share > 0.5 => (edge, 1.0),
            share if share < -0.5 => (-edge, -1.0),
            _ => (left.clamp(-PAIR, PAIR), 0.0),
        };
        let mut slope = State::zeros();
        slope[OFFSET] = -normal.y;
        slope[HEADING] = -normal.dot(&Vector::new(-own.y, own.x));
        (0..KNOTS).for_each(|knot| slope[BENDS + knot] = -slopes[knot]);
        slope[EDGE] = per_edge;
        slope[PITCH] = -normal.dot(&turned(lift));
        let rough = ROUGH * along * along;
        let (blur, pixel) = (BLUR.0, BLUR.1 * point.pixel);
        let sigma = (blur * blur + pixel * pixel + rough * rough).sqrt();
        Some(Measured { residual: left - line, slope, sigma, along })
    }
}

/// One number for each state.
fn deviations([offset, heading, bend, edge, pitch]: [f64; 5]) -> [f64; STATES] {
    std::array::from_fn(|index| match index {
        OFFSET => offset,
        HEADING => heading,
        EDGE => edge,
        PITCH => pitch,
        _ => bend,
    })
}
