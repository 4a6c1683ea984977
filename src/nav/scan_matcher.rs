use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use crate::geometry::{Point, Pose, Vector, cross, direction, math, normalize_angle};

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
#[derive(Debug, Clone, Default)]
pub struct ScanMatcher {
    references: Vec<Reference>,
    /// The reference that scans are matched against at present.
    current: usize,
    /// The pose by odometry of the last scan, and its corrected pose.
    odometry: Pose,
    pose: Pose,
    /// The covariance of the corrected pose: metres and radians squared.
    covariance: Matrix3<f64>,
}

/// A scan that later ones are matched against.
#[derive(Debug, Clone)]
struct Reference {
    pose: Pose,
    /// Where each beam hit, in the robot's frame, in the order of bearing; `None` where nothing was seen.
    hits: Vec<Option<Hit>>,
}

#[derive(Debug, Clone, Copy)]
struct Hit {
    point: Point,
    range: f64,
    /// The unit normal of the surface, towards the viewer; `None` where the neighbours lie on no common line.
    normal: Option<Vector>,
}

/// The result of laying a scan over a reference.
#[derive(Debug, Clone, Copy)]
struct Match {
    pose: Pose,
    covariance: Matrix3<f64>,
    /// The share of points that found a counterpart.
    overlap: f64,
}

/// Gauss-Newton's equations for a pose, from the points that have counterparts.
#[derive(Debug, Clone, Default)]
struct Evidence {
    information: Matrix3<f64>,
    residual: Vector3<f64>,
    matched: usize,
}

/// Bearings that a reference is divided into.
const BINS: usize = 360;
/// Farther from its reference than this, in metres, a scan becomes a reference itself.
const REFERENCE_SPACING: f64 = 0.5;
/// So it does when less than this share of its points matches.
const MIN_OVERLAP: f64 = 0.6;
/// References that are kept at most.
const MAX_REFERENCES: usize = 10_000;
/// A match that moves the predicted pose by more than this, in metres, is not believed.
const MAX_CORRECTION: f64 = 0.05;
/// A match below this share is not believed.
const MIN_MATCH: f64 = 0.3;
const ITERATIONS: usize = 6;
/// Points farther from the reference's surface than this, in metres, have no counterpart: first and last iteration.
const COARSE_GATE: f64 = 0.10;
const FINE_GATE: f64 = 0.03;
/// Standard deviation of one matched point, in metres.
const POINT_NOISE: f64 = 0.01;
/// How many points count as one: consecutive filtered scans share their noise, and surfaces are not quite straight.
const POINTS_PER_FACT: f64 = 10.0;
/// Odometry's error as a part of the distance driven and of the angle turned in one step.
const DISTANCE_ERROR: f64 = 0.03;
const TURN_ERROR: f64 = 0.01;
/// The variance that slip adds to the heading: radians squared per metre and per radian.
const SLIP_PER_METRE: f64 = 6e-5;
const SLIP_PER_RADIAN: f64 = 2.5e-6;
/// The least variance of a step, so that no direction ever counts as exactly known.
const LEAST_VARIANCE: f64 = 1e-10;
/// How far, in metres, neighbours reach that a line is fitted to, and how many they are on either side.
const LINE_REACH: f64 = 0.06;
const MIN_NEIGHBOURS: usize = 2;
const MAX_NEIGHBOURS: usize = 25;
/// Neighbouring beams that hit farther apart than this, in metres and as a part of the range, see two surfaces.
const EDGE_GAP: f64 = 0.02;
const EDGE_SLANT: f64 = 0.1;
/// How far neighbours may lie from their line: as a part of its length, and in metres.
const FLATNESS: f64 = 0.05;
const ROUGHNESS: f64 = 0.003;

impl ScanMatcher {
    /// A matcher without references, whose corrected frame is odometry's own.
    pub fn new() -> Self {
        Self::default()
    }

    /// The corrected pose for a pose by odometry, by the last match.
    pub fn corrected(&self, odometry: Pose) -> Pose {
        self.pose.compose(&self.odometry.inverse().compose(&odometry))
    }

    /// How many scans are kept as references.
    pub fn references(&self) -> usize {
        self.references.len()
    }

    /// Matches a scan, given as points in the robot's frame in order of bearing, that was made at `odometry`, and
    /// returns the corrected pose.
    pub fn update(&mut self, odometry: Pose, points: &[Point]) -> Pose {
        let predicted = self.predict(odometry);
        let Some(reference) = self.references.get(self.current) else {
            self.references.push(Reference::new(predicted, points));
            return predicted;
        };
        let matched = reference.lay_over(predicted, &self.covariance, points);
        let strayed = predicted.distance_to(matched.pose.position());
        if matched.overlap >= MIN_MATCH && strayed < MAX_CORRECTION {
            self.pose = matched.pose;
            self.covariance = matched.covariance;
        }
        let distance = reference.pose.distance_to(self.pose.position());
        if distance > REFERENCE_SPACING || matched.overlap < MIN_OVERLAP {
            self.change_reference(points);
        }
        self.pose
    }

    /// Moves pose and covariance on by odometry.
    fn predict(&mut self, odometry: Pose) -> Pose {
        let motion = self.odometry.inverse().compose(&odometry);
        let before = self.pose;
        self.pose = before.compose(&motion);
        self.odometry = odometry;
        let (dx, dy) = (self.pose.x - before.x, self.pose.y - before.y);
        let distance = math::hypot(motion.x, motion.y);
        let turn = motion.heading.abs();
        let carried = Matrix3::new(1.0, 0.0, -dy, 0.0, 1.0, dx, 0.0, 0.0, 1.0);
        let position = (DISTANCE_ERROR * distance) * (DISTANCE_ERROR * distance) + LEAST_VARIANCE;
        let heading = (TURN_ERROR * turn) * (TURN_ERROR * turn)
            + SLIP_PER_METRE * distance
            + SLIP_PER_RADIAN * turn
            + LEAST_VARIANCE;
        self.covariance = carried * self.covariance * carried.transpose()
            + Matrix3::from_diagonal(&Vector3::new(position, position, heading));
        self.pose
    }

    /// Goes over to the earlier reference near by that shares most with a scan, or makes the scan one.
    fn change_reference(&mut self, points: &[Point]) {
        let pose = self.pose;
        let near = |r: &Reference| r.pose.distance_to(pose.position()) <= REFERENCE_SPACING;
        let candidates = self.references.iter().enumerate().filter(|(_, r)| near(r));
        let best = candidates
            .map(|(index, reference)| (index, reference.overlap(pose, points)))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        match best {
            Some((index, share)) if share >= MIN_OVERLAP => self.current = index,
            _ if self.references.len() == MAX_REFERENCES => {}
            _ => {
                self.current = self.references.len();
                self.references.push(Reference::new(pose, points));
            }
        }
    }
}

impl Reference {
    fn new(pose: Pose, points: &[Point]) -> Self {
        let mut hits: Vec<Option<Hit>> = vec![None; BINS];
        for (i, &point) in points.iter().enumerate() {
            let range = point.coords.norm();
            let bin = bin_of(point);
            if hits[bin].is_none_or(|hit| range < hit.range) {
                hits[bin] = Some(Hit { point, range, normal: normal_at(points, i) });
            }
        }
        Self { pose, hits }
    }

    /// Moves a scan from its predicted pose to where it fits this reference best.
    fn lay_over(&self, predicted: Pose, covariance: &Matrix3<f64>, points: &[Point]) -> Match {
        let to_local = self.rotation().transpose();
        let prior = self.pose.inverse().compose(&predicted);
        let known =
            (to_local * covariance * to_local.transpose()).try_inverse().unwrap_or_else(Matrix3::zeros);
        let mut relative = prior;
        let mut found = Evidence::default();
        let mut information = known;
        for iteration in 0..ITERATIONS {
            let share = iteration as f64 / (ITERATIONS - 1) as f64;
            let gate = COARSE_GATE + (FINE_GATE - COARSE_GATE) * share;
            found = self.evidence(relative, points, gate);
            information = known + found.information;
            let strayed = Vector3::new(
                prior.x - relative.x,
                prior.y - relative.y,
                normalize_angle(prior.heading - relative.heading),
            );
            let Some(solver) = information.cholesky() else { break };
            let step = solver.solve(&(known * strayed + found.residual));
            relative.x += step.x;
            relative.y += step.y;
            relative.heading = normalize_angle(relative.heading + step.z);
        }
        let rotation = self.rotation();
        let covariance = information.try_inverse().unwrap_or_else(Matrix3::zeros);
        Match {
            pose: self.pose.compose(&relative),
            covariance: rotation * covariance * rotation.transpose(),
            overlap: found.matched as f64 / points.len().max(1) as f64,
        }
    }

    /// The rotation from this reference's frame to the world's, for pose covariances.
    fn rotation(&self) -> Matrix3<f64> {
        let d = direction(self.pose.heading);
        Matrix3::new(d.x, -d.y, 0.0, d.y, d.x, 0.0, 0.0, 0.0, 1.0)
    }

    /// The share of a scan's points that have counterparts at a pose.
    fn overlap(&self, pose: Pose, points: &[Point]) -> f64 {
        let relative = self.pose.inverse().compose(&pose);
        let found = self.evidence(relative, points, FINE_GATE);
        found.matched as f64 / points.len().max(1) as f64
    }

    /// What the counterparts of a scan's points say about its pose relative to this reference.
    fn evidence(&self, relative: Pose, points: &[Point], gate: f64) -> Evidence {
        let mut evidence = Evidence::default();
        let along = direction(relative.heading);
        for point in points {
            let turned =
                Vector::new(along.x * point.x - along.y * point.y, along.y * point.x + along.x * point.y);
            let placed = Point::new(relative.x + turned.x, relative.y + turned.y);
            let Some((normal, error)) = self.counterpart(placed, relative.position(), gate) else { continue };
            evidence.matched += 1;
            // Large errors count less, so that what has no true counterpart does not pull.
            let deviations = error / POINT_NOISE;
            let robust = 1.0 / (1.0 + 0.25 * deviations * deviations);
            let weight = robust / (POINT_NOISE * POINT_NOISE * POINTS_PER_FACT);
            let gradient = Vector3::new(normal.x, normal.y, cross(turned, normal));
            evidence.information += gradient * gradient.transpose() * weight;
            evidence.residual -= gradient * (weight * error);
        }
        evidence
    }

    /// The surface's normal and the signed distance to it, where a point has a counterpart.
    ///
    /// A surface has only one visible side: from `viewer` behind it, a thin wall's other face is seen.
    fn counterpart(&self, point: Point, viewer: Point, gate: f64) -> Option<(Vector, f64)> {
        let bin = bin_of(point);
        let range = point.coords.norm();
        // Near surfaces spread over many bins: the best of the neighbours is the nearest point.
        let candidates = [bin, (bin + 1) % BINS, (bin + BINS - 1) % BINS];
        let hit = candidates
            .iter()
            .filter_map(|&b| self.hits[b])
            .min_by(|a, b| (a.range - range).abs().total_cmp(&(b.range - range).abs()))?;
        let normal = hit.normal?;
        if (viewer - hit.point).dot(&normal) <= 0.0 {
            return None;
        }
        let error = (point - hit.point).dot(&normal);
        let apart = (point - hit.point).norm_squared();
        let spread = 3.0 * range * TAU / BINS as f64 + gate;
        (error.abs() < gate && apart < spread * spread).then_some((normal, error))
    }
}

fn bin_of(point: Point) -> usize {
    let turn = math::atan2(point.y, point.x) / TAU;
    ((turn * BINS as f64).round() as i64).rem_euclid(BINS as i64) as usize
}

/// The normal, towards the viewer at the origin, of the line that a point and its neighbours lie on, if they do. Near surfaces are seen by many beams a few
/// millimetres apart, so the neighbours reach as far as [`LINE_REACH`], not a fixed number of beams.
fn normal_at(points: &[Point], index: usize) -> Option<Vector> {
    let centre = points[index];
    let mut sums = LineSums::default();
    sums.add(centre.coords);
    let sides = [1, points.len() - 1].map(|stride| sums.add_side(points, index, stride));
    if sides.contains(&0) {
        return None;
    }
    sums.normal()
}

/// Sums for a least-squares line.
#[derive(Debug, Clone, Copy, Default)]
struct LineSums {
    count: f64,
    sum: Vector,
    squares: Vector,
    product: f64,
}

impl LineSums {
    fn add(&mut self, p: Vector) {
        self.count += 1.0;
        self.sum += p;
        self.squares += p.component_mul(&p);
        self.product += p.x * p.y;
    }

    /// Adds the neighbours on one side that belong to the same surface, and returns how many they are.
    fn add_side(&mut self, points: &[Point], index: usize, stride: usize) -> usize {
        let centre = points[index];
        let mut last = centre;
        let mut at = index;
        let mut added = 0;
        while added < MAX_NEIGHBOURS {
            at = (at + stride) % points.len();
            let next = points[at];
            let range = last.coords.norm();
            // Beams on one surface are about a beam's width apart; across an edge they are much farther.
            if (next - last).norm() > EDGE_GAP + EDGE_SLANT * range {
                break;
            }
            if added >= MIN_NEIGHBOURS && (next - centre).norm() > LINE_REACH {
                break;
            }
            self.add(next.coords);
            last = next;
            added += 1;
        }
        added
    }

    /// The normal of the line through the points, if they lie close to one.
    fn normal(&self) -> Option<Vector> {
        let mean = self.sum / self.count;
        let xx = self.squares.x / self.count - mean.x * mean.x;
        let yy = self.squares.y / self.count - mean.y * mean.y;
        let xy = self.product / self.count - mean.x * mean.y;
        let half_difference = 0.5 * (xx - yy);
        let spread = math::hypot(half_difference, xy);
        let across = (0.5 * (xx + yy) - spread).max(0.0);
        let along = 0.5 * (xx + yy) + spread;
        if across.sqrt() > FLATNESS * along.sqrt() + ROUGHNESS || along.sqrt() < 2.0 * ROUGHNESS {
            return None;
        }
        let angle = 0.5 * math::atan2(xy, half_difference);
        let tangent = direction(angle);
        let normal = Vector::new(-tangent.y, tangent.x);
        Some(if mean.dot(&normal) < 0.0 { normal } else { -normal })
    }
}
