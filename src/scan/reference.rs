use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use super::filter::{RANGE_ERROR, SURFACE_STEP};
use crate::geometry::{Point, Pose, Vector, cross, direction, math};

/// A scan that later ones are matched against.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    pub(super) pose: Pose,
    /// Hits in the robot frame, by bearing; `None` without an echo.
    hits: Vec<Option<Hit>>,
    /// Distance between neighbouring beams (bearing intervals).
    spacing: usize,
}

#[derive(Debug, Clone, Copy)]
struct Hit {
    point: Point,
    range: f64,
    /// Unit normal of the surface, towards the viewer; `None` if the neighbours are not collinear.
    normal: Option<Vector>,
}

/// Gauss-Newton equations for a pose, from the points with correspondences.
#[derive(Debug, Clone, Default)]
pub(super) struct Evidence {
    pub(super) information: Matrix3<f64>,
    pub(super) residual: Vector3<f64>,
    pub(super) matched: usize,
}

/// Points farther from a surface than this, in metres, do not count as shared, and have no counterpart in the
/// last round.
pub(super) const OVERLAP_GATE: f64 = 0.03;
/// Number of bearing intervals of a reference.
const BINS: usize = 360;
/// Distance between neighbouring hits on one surface, relative to that on a surface at a right angle to the
/// beams: they are slanted by up to 60 degrees.
const SLANT: f64 = 2.0;
/// Number of matched points that count as one independent measurement. Scans matched against one reference
/// share its errors, tens of them in succession; counted individually, they would outweigh odometry where
/// surfaces constrain the pose weakly, as in a round room. By experiment: 2 lets spirals turn the pose by
/// degrees, 200 lets odometry drift through.
const POINTS_PER_FACT: f64 = 40.0;
/// Extent of the neighbours used for a line (m).
const LINE_REACH: f64 = 0.06;
/// Minimum number of neighbours on either side.
const MIN_NEIGHBOURS: usize = 2;
/// Maximum number of neighbours on either side.
const MAX_NEIGHBOURS: usize = 25;
/// Maximum deviation of neighbours from their line (fraction of its length).
const FLATNESS: f64 = 0.05;
/// Further deviation allowed, for short lines (m).
const ROUGHNESS: f64 = 0.003;

impl Reference {
    pub(super) fn new(pose: Pose, points: &[Point]) -> Self {
        let mut hits: Vec<Option<Hit>> = vec![None; BINS];
        let spacing = spacing(points);
        let step = SURFACE_STEP.max(SLANT * TAU * spacing as f64 / BINS as f64);
        for (i, &point) in points.iter().enumerate() {
            let range = point.coords.norm();
            let bin = bin_of(point);
            if hits[bin].is_none_or(|hit| range < hit.range) {
                hits[bin] = Some(Hit { point, range, normal: normal_at(points, i, step) });
            }
        }
        Self { pose, hits, spacing }
    }

    /// Rotation from this reference's frame to the world, for pose covariances.
    fn rotation(&self) -> Matrix3<f64> {
        let d = direction(self.pose.heading);
        Matrix3::new(d.x, -d.y, 0.0, d.y, d.x, 0.0, 0.0, 0.0, 1.0)
    }

    /// Fraction of a scan's points with correspondences, for a scan made at `pose`.
    pub(super) fn overlap(&self, pose: Pose, points: &[Point]) -> f64 {
        let found = self.evidence(pose, points, OVERLAP_GATE);
        found.matched as f64 / points.len().max(1) as f64
    }

    /// Evidence of a scan's correspondences about its pose.
    pub(super) fn evidence(&self, pose: Pose, points: &[Point], gate: f64) -> Evidence {
        let relative = self.pose.inverse().compose(&pose);
        let local = self.local_evidence(relative, points, gate);
        let rotation = self.rotation();
        Evidence {
            information: rotation * local.information * rotation.transpose(),
            residual: rotation * local.residual,
            matched: local.matched,
        }
    }

    /// The same in this reference's frame.
    fn local_evidence(&self, relative: Pose, points: &[Point], gate: f64) -> Evidence {
        let mut evidence = Evidence::default();
        let along = direction(relative.heading);
        for point in points {
            let turned =
                Vector::new(along.x * point.x - along.y * point.y, along.y * point.x + along.x * point.y);
            let placed = Point::new(relative.x + turned.x, relative.y + turned.y);
            let Some((normal, error)) = self.counterpart(placed, relative.position(), gate) else { continue };
            evidence.matched += 1;
            // Large errors count less, so that what has no true counterpart does not pull.
            let deviations = error / RANGE_ERROR;
            let robust = 1.0 / (1.0 + 0.25 * deviations * deviations);
            let weight = robust / (RANGE_ERROR * RANGE_ERROR * POINTS_PER_FACT);
            let gradient = Vector3::new(normal.x, normal.y, cross(turned, normal));
            evidence.information += gradient * gradient.transpose() * weight;
            evidence.residual -= gradient * (weight * error);
        }
        evidence
    }

    /// Surface normal and signed distance, if a point has a correspondence.
    ///
    /// A surface has one visible side: a viewer behind a thin wall sees its other face.
    fn counterpart(&self, point: Point, viewer: Point, gate: f64) -> Option<(Vector, f64)> {
        let bin = bin_of(point);
        let range = point.coords.norm();
        // Near surfaces spread over many bins: the best of the neighbours is the closest point.
        let candidates = (0..=self.spacing).flat_map(|aside| [bin + aside, bin + BINS - aside]);
        let hit = candidates
            .filter_map(|bin| self.hits[bin % BINS])
            .min_by(|a, b| (a.range - range).abs().total_cmp(&(b.range - range).abs()))?;
        let normal = hit.normal?;
        if (viewer - hit.point).dot(&normal) <= 0.0 {
            return None;
        }
        let error = (point - hit.point).dot(&normal);
        let apart = (point - hit.point).norm_squared();
        let spread = 3.0 * range * TAU / BINS as f64 * self.spacing as f64 + gate;
        (error.abs() < gate && apart < spread * spread).then_some((normal, error))
    }
}

/// Distance between neighbouring beams: the median of that of points next to each other (bearing intervals).
fn spacing(points: &[Point]) -> usize {
    let bins: Vec<usize> = points.iter().map(|&point| bin_of(point)).collect();
    let apart = |two: &[usize]| (two[0].abs_diff(two[1])).min(BINS - two[0].abs_diff(two[1]));
    let mut spacings: Vec<usize> = bins.windows(2).map(apart).collect();
    if spacings.is_empty() {
        return 1;
    }
    let middle = spacings.len() / 2;
    (*spacings.select_nth_unstable(middle).1).max(1)
}

fn bin_of(point: Point) -> usize {
    let turn = math::atan2(point.y, point.x) / TAU;
    ((turn * BINS as f64).round() as i64).rem_euclid(BINS as i64) as usize
}

/// Normal, towards the viewer at the origin, of the line through a point and its neighbours, if they are
/// collinear. Many beams hit a near surface a few millimetres apart, so the neighbourhood is [`LINE_REACH`]
/// wide rather than a number of beams. Hits next to each other on one surface are at most the part `step` of
/// their range apart.
fn normal_at(points: &[Point], index: usize, step: f64) -> Option<Vector> {
    let centre = points[index];
    let mut sums = LineSums::default();
    sums.add(centre.coords);
    let sides = [1, points.len() - 1].map(|stride| sums.add_side(points, index, stride, step));
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

    /// Adds the neighbours on one side that belong to the same surface; returns their number.
    fn add_side(&mut self, points: &[Point], index: usize, stride: usize, step: f64) -> usize {
        let centre = points[index];
        let mut last = centre;
        let mut at = index;
        let mut added = 0;
        while added < MAX_NEIGHBOURS {
            at = (at + stride) % points.len();
            let next = points[at];
            let range = last.coords.norm();
            // Beams on one surface are about a beam's width apart; across an edge they are much farther.
            if (next - last).norm() > OVERLAP_GATE + step * range {
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

    /// Normal of the line through the points, if they are nearly collinear.
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
