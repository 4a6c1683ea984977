use nalgebra::{Matrix3, Vector3};

use super::LocaliserParameters;
use super::map::LocalisationMap;
use crate::geometry::{Pose, Vector, angle_difference, direction, math, normalize_angle};
use crate::io::LidarScan;
use crate::scan::filter::GRAZING;
use crate::world::space::Scanner;

/// A possible pose of the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hypothesis {
    /// Pose in the world.
    pub pose: Pose,
    /// Covariance of x, y and heading (m, rad).
    pub covariance: Matrix3<f64>,
    /// Probability among all hypotheses.
    pub probability: f64,
    /// Logarithm of its weight.
    pub(super) log_weight: f64,
    /// Fraction of beams as expected.
    pub explained: f64,
}

/// Buffers for one expected scan.
#[derive(Debug, Clone)]
pub(super) struct Bench {
    scanner: Scanner,
    /// Expected ranges (m) of the scan's beams, and of further ones between them.
    expected: Vec<f64>,
    /// Number of beams of the scan.
    beams: usize,
    /// Number of expected beams for each beam of the scan.
    finer: usize,
    /// Whether the beams cover the full circle once.
    is_whole: bool,
}

/// Number of beams over the full circle from which on neighbours show on what surface a beam ends. Of fewer
/// ones, neighbours end at other things: a beam would lack its normal nearly everywhere, and count as beside
/// an edge, where anything between its neighbours' ranges is as expected.
const FINE: f64 = 180.0;

impl Bench {
    pub(super) fn new(map: &LocalisationMap, scan: &LidarScan) -> Self {
        let (beams, turn) = (scan.ranges.len(), std::f64::consts::TAU);
        let spacing = scan.angle_increment.abs();
        let finer = (FINE * (spacing / turn).min(1.0 / beams as f64)).ceil().max(1.0) as usize;
        let is_whole = (spacing * beams as f64 - turn).abs() < 1e-6;
        Self { scanner: map.scanner(scan, finer), expected: vec![0.0; beams * finer], beams, finer, is_whole }
    }

    /// Whether it is for scans with so many beams.
    pub(super) fn is_for(&self, beams: usize) -> bool {
        self.beams == beams
    }
}

/// Evidence of a scan about a pose close to the expected one.
#[derive(Debug, Clone, Copy)]
struct Evidence {
    information: Matrix3<f64>,
    residual: Vector3<f64>,
    log_likelihood: f64,
    explained: f64,
}

/// Number of beams that count as one, because beams are not independent.
const BEAMS_AS_ONE: f64 = 4.0;
/// Fraction of beams that may measure anything.
const OUTLIERS: f64 = 0.1;
/// Difference from the expected range beyond which a beam is an outlier, at first (m): poses are that far
/// off.
const FIRST_GATE: f64 = 0.25;
/// The same at last, in standard deviations of a range. Far out, since a narrow gate about a wrong pose
/// selects the beams that agree with it.
const GATE: f64 = 6.0;
/// Exponent of the likelihood; a pose error affects all beams.
const TEMPER: f64 = 0.1;
/// Minimum standard deviation of a motion (m, rad), for rounding.
const LEAST_MOTION_ERROR: f64 = 1e-5;
/// Maximum standard deviation of a known pose (m).
pub(super) const KNOWN: f64 = 0.03;
/// Lengths by which a pose is moved that is not known (m).
const SLIDES: [f64; 4] = [0.08, 0.04, 0.02, 0.01];
/// Number of times that it is moved by a length, at most.
const MOST_SLIDES: usize = 10;
/// Difference below which two hypotheses are the same (m, rad).
const SAME: (f64, f64) = (0.06, 0.06);

impl Hypothesis {
    pub(super) fn new(pose: Pose, spread: f64) -> Self {
        let variance = spread * spread;
        Self {
            pose,
            covariance: Matrix3::from_diagonal(&Vector3::new(variance, variance, variance)),
            probability: 1.0,
            log_weight: 0.0,
            explained: 0.0,
        }
    }

    /// Whether two hypotheses are about the same pose.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.pose.distance_to(other.pose.position()) <= SAME.0
            && angle_difference(self.pose.heading, other.pose.heading).abs() <= SAME.1
    }

    /// Standard deviation of the position, along the worse axis (m).
    pub fn deviation(&self) -> f64 {
        self.covariance[(0, 0)].max(self.covariance[(1, 1)]).max(0.0).sqrt()
    }

    /// Whether the position is known in all directions.
    pub(super) fn is_known(&self) -> bool {
        self.deviation() <= KNOWN
    }

    /// Moves with the robot, by its motion in its own frame.
    pub(super) fn predict(&mut self, motion: &Pose, parameters: &LocaliserParameters) {
        let before = self.pose;
        self.pose = before.compose(motion);
        let (dx, dy) = (self.pose.x - before.x, self.pose.y - before.y);
        let mut carried = Matrix3::identity();
        carried[(0, 2)] = -dy;
        carried[(1, 2)] = dx;
        let errors = MotionErrors::of(motion, parameters);
        self.covariance = carried * self.covariance * carried.transpose();
        // Wheel size errors are the same at each step, so unobserved errors add up linearly.
        for (axis, error) in errors.constant.into_iter().enumerate() {
            let before = self.covariance[(axis, axis)].max(0.0).sqrt();
            self.covariance[(axis, axis)] += error * (2.0 * before + error);
        }
        // Slip differs from step to step, so its variances add up.
        for (axis, variance) in errors.slip.into_iter().enumerate() {
            self.covariance[(axis, axis)] += variance;
        }
    }

    /// Matches the pose to a scan in a number of Gauss-Newton steps, near the pose by odometry. Returns the
    /// logarithm of the scan's likelihood.
    ///
    /// Edges of surfaces have no normal, so that these steps leave the pose where it is along a single wall.
    /// It is then moved along the axis that is known least to where the scan is more likely: otherwise, of
    /// poses that the world does not distinguish, those would seem more probable that a search has hit
    /// better. How probable a pose is by odometry counts there too, so that noise moves none along a wall.
    pub(super) fn match_scan(
        &mut self,
        map: &LocalisationMap,
        scan: &LidarScan,
        bench: &mut Bench,
        parameters: &LocaliserParameters,
        steps: usize,
    ) -> f64 {
        let predicted = self.pose;
        let Some(known) = self.covariance.try_inverse() else { return f64::NEG_INFINITY };
        let mut information = known;
        // Outliers are excluded step by step.
        let narrowest = GATE * parameters.lidar_error();
        let mut gate = narrowest.max(FIRST_GATE);
        for _ in 0..steps {
            let found = evidence(map, scan, bench, &self.pose, parameters, gate);
            information = known + found.information;
            let Some(solver) = information.cholesky() else { break };
            let step = solver.solve(&(known * strayed(&predicted, &self.pose) + found.residual));
            self.pose = Pose::new(
                self.pose.x + step.x.clamp(-0.1, 0.1),
                self.pose.y + step.y.clamp(-0.1, 0.1),
                normalize_angle(self.pose.heading + step.z.clamp(-0.1, 0.1)),
            );
            gate = (0.6 * gate).max(narrowest);
        }
        if let Some(covariance) = information.try_inverse() {
            self.covariance = covariance;
        }
        let mut found = evidence(map, scan, bench, &self.pose, parameters, gate);
        if !self.is_known() {
            // How much less probable a pose is by odometry.
            let unlikely = |pose: &Pose| {
                let strayed = strayed(&predicted, pose);
                0.5 * (strayed.transpose() * known * strayed).x
            };
            let axes = self.covariance.symmetric_eigen();
            let axis = axes.eigenvectors.column(axes.eigenvalues.imax()).into_owned();
            for step in SLIDES.into_iter().flat_map(|step| [step, -step]) {
                for _ in 0..MOST_SLIDES {
                    let pose = slid(&self.pose, &(axis * step));
                    let other = evidence(map, scan, bench, &pose, parameters, gate);
                    let gain = other.log_likelihood - found.log_likelihood;
                    if gain <= unlikely(&pose) - unlikely(&self.pose) {
                        break;
                    }
                    (self.pose, found) = (pose, other);
                }
            }
        }
        self.explained = found.explained;
        found.log_likelihood
    }
}

/// What a pose is off the predicted one: x, y and heading.
fn strayed(predicted: &Pose, pose: &Pose) -> Vector3<f64> {
    let turned = angle_difference(predicted.heading, pose.heading);
    Vector3::new(predicted.x - pose.x, predicted.y - pose.y, turned)
}

/// A pose, moved by a change of x, y and heading.
fn slid(pose: &Pose, change: &Vector3<f64>) -> Pose {
    Pose::new(pose.x + change.x, pose.y + change.y, normalize_angle(pose.heading + change.z))
}

/// Errors of a motion by odometry, of x, y and heading.
#[derive(Debug, Clone, Copy)]
struct MotionErrors {
    /// Standard deviations of errors that are the same at each step (m, rad).
    constant: [f64; 3],
    /// Variances by slip (m², rad²).
    slip: [f64; 3],
}

impl MotionErrors {
    /// Errors of a motion in the robot's own frame.
    fn of(motion: &Pose, parameters: &LocaliserParameters) -> Self {
        let (errors, track) = (&parameters.odometry, parameters.track);
        let (distance, turned) = (math::hypot(motion.x, motion.y), motion.heading.abs());
        let along = errors.wheel_scale * distance + LEAST_MOTION_ERROR;
        let turn = math::hypot(errors.wheel_scale, errors.track) * turned
            + errors.wheel_mismatch / track * distance
            + LEAST_MOTION_ERROR;
        // Distance that both wheels roll together, on an arc or on the spot.
        let rolled = 2.0 * distance.max(0.5 * track * turned);
        let variance = errors.slip * errors.slip * rolled;
        let (moved, rotated) = (0.25 * variance, variance / (track * track));
        Self { constant: [along, along, turn], slip: [moved, moved, rotated] }
    }
}

/// Compares a scan with the expected one at a robot pose.
fn evidence(
    map: &LocalisationMap,
    scan: &LidarScan,
    bench: &mut Bench,
    pose: &Pose,
    parameters: &LocaliserParameters,
    gate: f64,
) -> Evidence {
    let lidar = pose.compose(&scan.mount);
    map.expect(&mut bench.scanner, &lidar, &mut bench.expected);
    let sigma = parameters.lidar_error();
    let blurred = 2.0 * sigma;
    let mut found = Evidence {
        information: Matrix3::zeros(),
        residual: Vector3::zeros(),
        log_likelihood: 0.0,
        explained: 0.0,
    };
    let density = 1.0 / scan.range_max.max(1.0);
    let peak = (1.0 - OUTLIERS) / (blurred * std::f64::consts::TAU.sqrt());
    let mut compared = 0_usize;
    for (beam, &range) in scan.ranges.iter().enumerate().filter(|(_, range)| !range.is_nan()) {
        compared += 1;
        let normal = normal(scan, bench, beam, &lidar);
        let off = off(scan, bench, beam, normal.is_some());
        let scaled = off / blurred;
        let likely = if scaled.abs() < 8.0 { peak * math::exp(-0.5 * scaled * scaled) } else { 0.0 };
        found.log_likelihood += math::ln(likely + OUTLIERS * density);
        found.explained += f64::from(u8::from(off.abs() < 4.0 * sigma + 0.01));
        let Some(normal) = normal.filter(|_| range.is_finite() && off.abs() <= gate) else { continue };
        let ray = direction(lidar.heading + scan.angle(beam));
        let facing = normal.dot(&ray);
        if facing.abs() < GRAZING {
            continue;
        }
        // Distance of the measured point behind the expected surface.
        let behind = off * facing;
        let arm = lidar.position() + ray * range - pose.position();
        let swing = normal.y * arm.x - normal.x * arm.y;
        let by_pose = Vector3::new(normal.x, normal.y, swing);
        let error = sigma * facing.abs();
        let weight = 1.0 / (error * error * BEAMS_AS_ONE);
        found.information += by_pose * by_pose.transpose() * weight;
        found.residual -= by_pose * (behind * weight);
    }
    found.log_likelihood *= TEMPER;
    found.explained /= compared.max(1) as f64;
    found
}

/// Difference of a range from the expected one (m). No echo counts as the maximum range, so that noise at
/// that limit makes no difference. Beside an edge, a beam may hit either side: any range between the two is
/// as expected.
fn off(scan: &LidarScan, bench: &Bench, beam: usize, is_smooth: bool) -> f64 {
    let within = |range: f64| range.min(scan.range_max);
    let (range, at) = (within(scan.ranges[beam]), beam * bench.finer);
    if is_smooth {
        return range - within(bench.expected[at]);
    }
    let beside = [at.checked_sub(1), Some(at), Some(at + 1)].into_iter().flatten();
    let sides = beside.filter_map(|at| bench.expected.get(at)).map(|&range| within(range));
    let (low, high) =
        sides.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), side| (low.min(side), high.max(side)));
    range - range.clamp(low, high)
}

/// Normal of the expected surface at a beam, from its neighbours; `None` at edges and corners.
fn normal(scan: &LidarScan, bench: &Bench, beam: usize, lidar: &Pose) -> Option<Vector> {
    let (beams, spacing) = (bench.expected.len(), scan.angle_increment / bench.finer as f64);
    let hit = |at: usize| {
        let (range, angle) = (bench.expected[at], scan.angle_min + spacing * at as f64);
        range.is_finite().then(|| direction(lidar.heading + angle) * range)
    };
    let at = beam * bench.finer;
    let (before, after) = ((at + beams - 1) % beams, (at + 1) % beams);
    if (at == 0 || at + 1 == beams) && !bench.is_whole {
        return None;
    }
    let (a, b, c) = (hit(before)?, hit(at)?, hit(after)?);
    let along = c - a;
    let length = along.norm();
    if length < 1e-9 {
        return None;
    }
    let normal = Vector::new(-along.y, along.x) / length;
    // The three points lie on one straight surface.
    ((b - a).dot(&normal).abs() < 0.05 * length + 0.001).then_some(normal)
}
