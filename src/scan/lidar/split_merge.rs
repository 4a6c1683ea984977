use super::ScanFeaturesParameters;
use super::clusters::Hit;
use crate::geometry::{FittedLine, Point, angle_difference};

/// A range of a cluster's hits with the line through them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    pub(super) first: usize,
    /// One past the last hit.
    pub(super) end: usize,
    pub(super) line: FittedLine,
}

/// Number of hits averaged before distances from a line are compared, so that one noisy hit splits no wall.
const SMOOTHING: usize = 3;
/// Walls whose directions differ by less than this, in radians, may be one, and make no corner.
pub(super) const ALIKE: f64 = 0.12;

/// Straight parts of a cluster by split-and-merge (T. Pavlidis and S. L. Horowitz, "Segmentation of plane
/// curves", 1974; the fastest and best for scans in the comparison of V. Nguyen et al., 2007).
///
/// A part is split at its farthest point from the chord while that distance exceeds the tolerance. Neighbours
/// that one line fits are merged. At a joint, points go to the line that fits them better.
pub(super) fn straight_parts(hits: &[Hit], parameters: &ScanFeaturesParameters) -> Vec<Part> {
    let mut parts = Vec::new();
    split(hits, 0, hits.len(), parameters, &mut parts);
    merge(hits, parameters, &mut parts);
    share_joints(hits, parameters, &mut parts);
    parts.retain(|part| {
        let long =
            part.end - part.first >= parameters.least_points && part.line.length >= parameters.least_wall;
        // Where two walls meet, a few points of both may resemble a third one, but fit a line less well.
        long && part.line.rms <= parameters.straightness()
    });
    parts
}

fn fit(hits: &[Hit], first: usize, end: usize) -> Option<FittedLine> {
    FittedLine::through(hits[first..end].iter().map(|hit| hit.point))
}

fn split(hits: &[Hit], first: usize, end: usize, parameters: &ScanFeaturesParameters, parts: &mut Vec<Part>) {
    // With an explicit stack, because a scan may have any number of beams.
    let mut stack = vec![(first, end)];
    while let Some((first, end)) = stack.pop() {
        if end - first < 3 {
            continue;
        }
        match farthest(hits, first, end) {
            Some((at, distance)) if distance > parameters.tolerance() => {
                stack.push((at, end));
                stack.push((first, at + 1));
            }
            _ => parts.extend(fit(hits, first, end).map(|line| Part { first, end, line })),
        }
    }
}

/// The hit farthest from the chord, and its distance.
fn farthest(hits: &[Hit], first: usize, end: usize) -> Option<(usize, f64)> {
    let mean = |range: std::ops::Range<usize>| -> Point {
        let count = range.len().max(1) as f64;
        let sum: nalgebra::Vector2<f64> = hits[range].iter().map(|hit| hit.point.coords).sum();
        Point::from(sum / count)
    };
    let few = SMOOTHING.min(end - first);
    let (a, b) = (mean(first..first + few), mean(end - few..end));
    let chord = FittedLine::through([a, b].into_iter())?;
    let half = SMOOTHING / 2;
    (first + 1..end - 1)
        .map(|at| {
            let around = at.saturating_sub(half).max(first)..(at + half + 1).min(end);
            (at, chord.distance_to(mean(around)).abs())
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Moves each joint to where both lines together fit best. With noise, the farthest point is rarely the
/// corner, and one point of the other wall rotates a short line.
fn share_joints(hits: &[Hit], parameters: &ScanFeaturesParameters, parts: &mut [Part]) {
    /// Number of hits on either side of a joint that may change over.
    const REACH: usize = 6;
    let misfit = |line: &FittedLine| line.rms * line.rms * line.points as f64;
    for at in 1..parts.len() {
        let (one, other) = (parts[at - 1], parts[at]);
        if other.first.abs_diff(one.end) > 1 {
            continue;
        }
        let least = parameters.least_points;
        let joints = (one.first + least).max(one.end.saturating_sub(REACH))
            ..=other.end.saturating_sub(least).min(one.end + REACH);
        let both = |joint: usize| Some((fit(hits, one.first, joint)?, fit(hits, joint, other.end)?, joint));
        let best = joints
            .filter_map(both)
            .min_by(|a, b| (misfit(&a.0) + misfit(&a.1)).total_cmp(&(misfit(&b.0) + misfit(&b.1))));
        if let Some((line, next, joint)) = best {
            parts[at - 1] = Part { end: joint, line, ..one };
            parts[at] = Part { first: joint, line: next, ..other };
        }
    }
}

fn merge(hits: &[Hit], parameters: &ScanFeaturesParameters, parts: &mut Vec<Part>) {
    let mut merged: Vec<Part> = Vec::with_capacity(parts.len());
    for &part in &*parts {
        let joint = merged.last().and_then(|last| {
            let alike = angle_difference(last.line.angle(), part.line.angle()).abs() < ALIKE;
            let short = last.line.length.min(part.line.length) < parameters.least_wall;
            let line = fit(hits, last.first, part.end)?;
            let fits = line.rms < 1.25 * parameters.range_error + 0.002;
            ((alike || short) && fits).then_some(Part { first: last.first, end: part.end, line })
        });
        match (joint, merged.last_mut()) {
            (Some(joint), Some(last)) => *last = joint,
            _ => merged.push(part),
        }
    }
    *parts = merged;
}
