use nalgebra::{Matrix5, Vector2, Vector5};

use super::reference::{Evidence, OVERLAP_GATE, Reference};
use crate::geometry::{Point, Pose, math, normalize_angle};
use crate::kinematics::{DISTANCE_ERROR, SCALE_ERROR, TURN_ERROR};

/// Corrects odometry by matching scans against earlier ones.
///
/// The first scan, and others on the way, are kept as references with the poses at which they were made. Each new
/// scan is laid over the nearest reference: points against the lines between neighbouring points there
/// (point-to-line ICP after A. Censi, "An ICP variant using a point-to-line metric", ICRA 2008, with correspondences
/// found by bearing as in polar scan matching). Errors then grow with the number of references in a chain, not with
/// the distance driven, and returning to a known place takes them back.
///
/// Match and odometry are weighed by what each knows: odometry by how far the robot has moved, the match by the
/// directions in which the visible surfaces hold the scan. Along a bare corridor or in a round room odometry decides.
#[derive(Debug, Clone)]
pub struct ScanMatcher {
    references: Vec<Reference>,
    /// The references that scans are matched against at present, and where they were chosen.
    active: Vec<usize>,
    chosen_at: Point,
    /// The share of the last scan that found counterparts.
    overlap: f64,
    /// The pose by odometry of the last scan, and its corrected pose.
    odometry: Pose,
    pose: Pose,
    /// By which part of themselves odometry underrates distances and turns: what wheels of other than nominal size
    /// and a track of other than nominal width do.
    scale_errors: Vector2<f64>,
    /// The covariance of corrected pose (metres, radians) and scale errors.
    covariance: Matrix5<f64>,
}

/// References farther away than this, in metres, are not matched against.
const REFERENCE_REACH: f64 = 0.8;
/// How many references a scan is matched against at most.
const ACTIVE_REFERENCES: usize = 3;
/// After so many metres they are chosen anew, or where the present ones share little with the scan; they stand at least as far apart.
const CHOICE_SPACING: f64 = 0.1;
/// A scan of which less than this share matches any reference becomes one itself.
const MIN_OVERLAP: f64 = 0.6;
/// References that are kept at most.
const MAX_REFERENCES: usize = 10_000;
/// A match below this share is not believed.
const MIN_MATCH: f64 = 0.3;
/// Rounds of finding counterparts and solving.
const ITERATIONS: usize = 6;
/// Points farther from the reference's surface than this, in metres, have no counterpart in the first round.
const COARSE_GATE: f64 = 0.10;
/// The same of the track.
const TRACK_ERROR: f64 = 0.005;
/// The variance that slip adds to the heading in a metre, in radians squared.
const SLIP_PER_METRE: f64 = 6e-5;
/// The same in a turn of a radian.
const SLIP_PER_RADIAN: f64 = 2.5e-6;
/// The least variance of a step, so that no direction ever counts as exactly known.
const LEAST_VARIANCE: f64 = 1e-10;

/// The result of laying a scan over the references.
#[derive(Debug, Clone, Copy)]
struct Match {
    pose: Pose,
    scale_errors: Vector2<f64>,
    covariance: Matrix5<f64>,
    /// The share of points that found counterparts in one reference.
    overlap: f64,
}

impl Default for ScanMatcher {
    fn default() -> Self {
        Self::new()
    }
}

impl ScanMatcher {
    /// A matcher without references, whose corrected frame is odometry's own.
    pub fn new() -> Self {
        // Both scales err by the wheels' size; turns also by the track.
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

    /// The corrected pose for a pose by odometry, by the last match.
    pub fn corrected(&self, odometry: Pose) -> Pose {
        self.pose.compose(&self.odometry.inverse().compose(&odometry))
    }

    /// How many scans are kept as references.
    pub fn references(&self) -> usize {
        self.references.len()
    }

    /// Matches a scan that was made at `odometry`, given as points in the robot's frame in order of bearing, and
    /// returns the corrected pose. The points shall be as measured: what a filter carries over from earlier scans
    /// carries odometry's errors with it.
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

    /// Takes in what is seen from the present pose, as clean as it is known: where earlier scans share too little
    /// with it, it becomes a reference for later ones.
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

    /// Takes in what is to be seen from a pose by what is known of the world, in place of all earlier references.
    pub(crate) fn know(&mut self, pose: Pose, points: &[Point]) {
        self.references.clear();
        self.references.push(Reference::new(pose, points));
        self.active.clear();
        self.active.push(0);
        self.chosen_at = pose.position();
    }

    /// Moves pose and covariance on by odometry.
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

    /// Moves a scan from its predicted pose to where it fits the active references best.
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

    /// The average of what the active references say about a pose; `matched` is that of the one that shares most.
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

    /// Makes those references active that are near and share most with a scan; where none shares enough, the scan
    /// becomes a reference itself.
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
