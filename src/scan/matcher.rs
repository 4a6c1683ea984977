use nalgebra::{Matrix5, Vector2, Vector5};

use super::reference::{Evidence, OVERLAP_GATE, Reference};
use crate::geometry::{Point, Pose, math, normalize_angle};
use crate::kinematics::{DISTANCE_ERROR, SCALE_ERROR, TURN_ERROR};

/// Corrects odometry by scan matching.
///
/// The first scan, and others on the way, are kept as references with their poses. Each new scan is
/// registered with the nearest references, points against the lines between adjacent reference points:
/// point-to-line ICP (A. Censi, "An ICP variant using a point-to-line metric", ICRA 2008), with
/// correspondences by bearing as in polar scan matching. Errors grow with the number of chained references,
/// not with the distance, and vanish on return to a known place.
///
/// Match and odometry are fused by their covariances: that of odometry grows with the motion, that of the
/// match depends on the directions in which the visible surfaces constrain the scan. In a bare corridor or a
/// round room, odometry decides.
///
/// ```
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::scan::ScanMatcher;
/// // A room of 3 m by 2 m, scanned from a pose inside it with one beam per degree.
/// let seen_from = |pose: Pose| -> Vec<Point> {
///     let hit = |degree: i32| {
///         let (sin, cos) = (pose.heading + f64::from(degree).to_radians()).sin_cos();
///         let x = if cos > 0.0 { (1.5 - pose.x) / cos } else { (-1.5 - pose.x) / cos };
///         let y = if sin > 0.0 { (1.0 - pose.y) / sin } else { (-1.0 - pose.y) / sin };
///         pose.to_local(pose.position() + roverlab::geometry::Vector::new(cos, sin) * x.min(y))
///     };
///     (-180..180).map(hit).collect()
/// };
/// let mut matcher = ScanMatcher::new();
/// // Odometry turns 3 degrees too far per metre.
/// for step in 0..30 {
///     let (way, turn) = (0.02 * f64::from(step), 0.001 * f64::from(step));
///     let scan = seen_from(Pose::new(way, 0.0, 0.0));
///     let pose = matcher.update(Pose::new(way, 0.0, turn), &scan);
///     matcher.learn(&scan);
///     assert!(step < 10 || pose.heading < 0.5 * turn, "{pose:?} after {step} steps");
/// }
/// ```
#[derive(Debug, Clone)]
pub struct ScanMatcher {
    references: Vec<Reference>,
    /// Active references, and the position where they were selected.
    active: Vec<usize>,
    chosen_at: Point,
    /// Fraction of the last scan's points with correspondences.
    overlap: f64,
    /// Odometry at the last scan, and its corrected pose.
    odometry: Pose,
    pose: Pose,
    /// Fractions by which odometry underestimates distances and turns, due to wheel size and track.
    scale_errors: Vector2<f64>,
    /// Covariance of the corrected pose (m, rad) and the scale errors.
    covariance: Matrix5<f64>,
}

/// Maximum distance of an active reference (m).
const REFERENCE_REACH: f64 = 0.8;
/// Maximum number of active references.
const ACTIVE_REFERENCES: usize = 3;
/// Distance driven after which the references are chosen anew, unless the present ones overlap little with
/// the scan earlier; also the minimum distance between them (m).
const CHOICE_SPACING: f64 = 0.1;
/// Overlap with every reference below which a scan becomes a reference (fraction).
const MIN_OVERLAP: f64 = 0.6;
/// Maximum number of references kept.
const MAX_REFERENCES: usize = 10_000;
/// Overlap below which a match is rejected (fraction).
const MIN_MATCH: f64 = 0.3;
/// Number of ICP iterations.
const ITERATIONS: usize = 6;
/// Maximum distance of a correspondence in the first iteration (m).
const COARSE_GATE: f64 = 0.10;
/// Initial standard deviation of the track (fraction).
const TRACK_ERROR: f64 = 0.005;
/// Variance of the heading due to slip, per metre (rad²).
const SLIP_PER_METRE: f64 = 6e-5;
/// Variance of the heading due to slip, per radian turned (rad²).
const SLIP_PER_RADIAN: f64 = 2.5e-6;
/// Minimum variance of a step, so that no direction counts as exactly known.
const LEAST_VARIANCE: f64 = 1e-10;

/// Result of a registration.
#[derive(Debug, Clone, Copy)]
struct Match {
    pose: Pose,
    scale_errors: Vector2<f64>,
    covariance: Matrix5<f64>,
    /// Fraction of points with correspondences in one reference.
    overlap: f64,
}

impl Default for ScanMatcher {
    fn default() -> Self {
        Self::new()
    }
}

impl ScanMatcher {
    /// A matcher without references; the corrected frame initially equals that of odometry.
    pub fn new() -> Self {
        // The wheel size affects both scales, the track only turns.
        let wheels = SCALE_ERROR * SCALE_ERROR;
        let mut covariance = Matrix5::zeros();
        covariance.fixed_view_mut::<2, 2>(3, 3).fill(wheels);
        covariance[(3, 3)] += LEAST_VARIANCE;
        covariance[(4, 4)] += TRACK_ERROR * TRACK_ERROR;
        Self {
            references: Vec::new(),
            active: Vec::new(),
            chosen_at: Point::origin(),
            overlap: 0.0,
            odometry: Pose::default(),
            pose: Pose::default(),
            scale_errors: Vector2::zeros(),
            covariance,
        }
    }

    /// Corrected pose for a pose by odometry, from the last match.
    pub fn corrected(&self, odometry: Pose) -> Pose {
        self.pose.compose(&self.odometry.inverse().compose(&odometry))
    }

    /// Number of references.
    pub fn references(&self) -> usize {
        self.references.len()
    }

    /// Matches a scan made at `odometry`, given as points in the robot frame in order of bearing, and returns
    /// the corrected pose. Use unfiltered points: a filter carries odometry errors over from earlier scans.
    pub fn update(&mut self, odometry: Pose, points: &[Point]) -> Pose {
        let predicted = self.predict(odometry);
        if self.active.is_empty() {
            return predicted;
        }
        let matched = self.lay_over(predicted, points);
        self.overlap = matched.overlap;
        if matched.overlap >= MIN_MATCH {
            self.pose = matched.pose;
            self.scale_errors = matched.scale_errors;
            self.covariance = matched.covariance;
        }
        self.pose
    }

    /// Takes the best available view from the present pose. If earlier references have too little in common
    /// with it, it becomes a reference.
    pub fn learn(&mut self, points: &[Point]) {
        if self.references.is_empty() {
            self.add_reference(points);
            return;
        }
        let far = self.pose.distance_to(self.chosen_at) > CHOICE_SPACING;
        if self.active.is_empty() || far || self.overlap < MIN_OVERLAP {
            self.choose_references(points);
        }
    }

    /// Replaces all references by the expected view at a pose in a known world.
    pub(crate) fn know(&mut self, pose: Pose, points: &[Point]) {
        self.references.clear();
        self.references.push(Reference::new(pose, points));
        self.active.clear();
        self.active.push(0);
        self.chosen_at = pose.position();
    }

    /// Standard deviation of the position: the larger one of those along x and y (m).
    pub(crate) fn deviation(&self) -> f64 {
        self.covariance[(0, 0)].max(self.covariance[(1, 1)]).max(0.0).sqrt()
    }

    /// Advances pose and covariance by odometry.
    fn predict(&mut self, odometry: Pose) -> Pose {
        let measured = self.odometry.inverse().compose(&odometry);
        self.odometry = odometry;
        let (far, round) = (1.0 + self.scale_errors.x, 1.0 + self.scale_errors.y);
        let motion = Pose::new(far * measured.x, far * measured.y, round * measured.heading);
        let before = self.pose;
        self.pose = before.compose(&motion);
        let (dx, dy) = (self.pose.x - before.x, self.pose.y - before.y);
        let distance = math::hypot(motion.x, motion.y);
        let turn = motion.heading.abs();
        let mut carried = Matrix5::identity();
        carried[(0, 2)] = -dy;
        carried[(1, 2)] = dx;
        carried[(0, 3)] = dx;
        carried[(1, 3)] = dy;
        carried[(2, 4)] = motion.heading;
        let square = |x: f64| x * x;
        let position = square(DISTANCE_ERROR * distance) + LEAST_VARIANCE;
        let heading =
            square(TURN_ERROR * turn) + SLIP_PER_METRE * distance + SLIP_PER_RADIAN * turn + LEAST_VARIANCE;
        let added = Vector5::new(position, position, heading, 0.0, 0.0);
        self.covariance = carried * self.covariance * carried.transpose() + Matrix5::from_diagonal(&added);
        self.pose
    }

    /// Registers a scan with the active references, starting from its predicted pose.
    fn lay_over(&self, predicted: Pose, points: &[Point]) -> Match {
        let known = self.covariance.try_inverse().unwrap_or_else(Matrix5::zeros);
        let mut pose = predicted;
        let mut scale_errors = self.scale_errors;
        let mut information = known;
        let mut matched = 0;
        for iteration in 0..ITERATIONS {
            let share = iteration as f64 / (ITERATIONS - 1) as f64;
            let found = self.evidence(pose, points, COARSE_GATE + (OVERLAP_GATE - COARSE_GATE) * share);
            matched = found.matched;
            information = known;
            let mut of_pose = information.fixed_view_mut::<3, 3>(0, 0);
            of_pose += found.information;
            let strayed = Vector5::new(
                predicted.x - pose.x,
                predicted.y - pose.y,
                normalize_angle(predicted.heading - pose.heading),
                self.scale_errors.x - scale_errors.x,
                self.scale_errors.y - scale_errors.y,
            );
            let residual = known * strayed + found.residual.push(0.0).push(0.0);
            let Some(step) = information.cholesky().map(|solver| solver.solve(&residual)) else { break };
            pose.x += step.x;
            pose.y += step.y;
            pose.heading = normalize_angle(pose.heading + step.z);
            scale_errors += step.fixed_rows::<2>(3);
        }
        let covariance = information.try_inverse().unwrap_or_else(Matrix5::zeros);
        let overlap = matched as f64 / points.len().max(1) as f64;
        Match { pose, scale_errors, covariance, overlap }
    }

    /// Mean evidence of the active references; `matched` is that of the best one.
    fn evidence(&self, pose: Pose, points: &[Point], gate: f64) -> Evidence {
        let mut sum = Evidence::default();
        for &index in &self.active {
            let found = self.references[index].evidence(pose, points, gate);
            sum.information += found.information;
            sum.residual += found.residual;
            sum.matched = sum.matched.max(found.matched);
        }
        let part = 1.0 / self.active.len().max(1) as f64;
        Evidence { information: sum.information * part, residual: sum.residual * part, ..sum }
    }

    /// Selects the nearby references with the largest overlap; if none has enough, the scan becomes a
    /// reference.
    fn choose_references(&mut self, points: &[Point]) {
        let pose = self.pose;
        self.chosen_at = pose.position();
        let mut candidates: Vec<(usize, f64)> = self
            .references
            .iter()
            .enumerate()
            .filter(|(_, r)| r.pose.distance_to(pose.position()) <= REFERENCE_REACH)
            .map(|(index, reference)| (index, reference.overlap(pose, points)))
            .filter(|&(_, overlap)| overlap >= MIN_MATCH)
            .collect();
        candidates.sort_by(|a, b| b.1.total_cmp(&a.1));
        candidates.truncate(ACTIVE_REFERENCES);
        self.active = candidates.iter().map(|&(index, _)| index).collect();
        let best = candidates.first().map_or(0.0, |&(_, overlap)| overlap);
        let crowded = self.references.iter().any(|r| r.pose.distance_to(pose.position()) < CHOICE_SPACING);
        if best < MIN_OVERLAP && !crowded && self.references.len() < MAX_REFERENCES {
            self.add_reference(points);
        }
    }

    fn add_reference(&mut self, points: &[Point]) {
        self.active.truncate(ACTIVE_REFERENCES - 1);
        self.active.push(self.references.len());
        self.references.push(Reference::new(self.pose, points));
    }
}
