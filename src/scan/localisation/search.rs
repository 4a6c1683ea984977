use std::f64::consts::TAU;

use super::LocaliserParameters;
use super::map::{LocalisationMap, scanner_of};
use crate::geometry::{Pose, angle_difference, normalize_angle};
use crate::io::LidarScan;

/// A pose of the robot that a scan may have been taken from, and how well it explains it: the share of its beams.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    pub(super) pose: Pose,
    pub(super) score: f64,
}

/// How many beams of a scan are compared.
const COMPARED: usize = 72;

/// Poses all over the world that explain a scan best, no two of them near each other.
///
/// From each place of the grid one scan is drawn; turned step by step it stands for all headings.
pub(super) fn search(
    map: &LocalisationMap,
    scan: &LidarScan,
    parameters: &LocaliserParameters,
) -> Vec<Candidate> {
    let beams = scan.ranges.len();
    let increment = scan.angle_increment;
    if beams == 0 || increment.abs() < 1e-9 {
        return Vec::new();
    }
    // A scan all round from the place, whatever part of it the robot's lidar sees.
    let round = (TAU / increment.abs()).round().max(1.0) as usize;
    let full = LidarScan {
        angle_min: 0.0,
        angle_increment: TAU / round as f64,
        ranges: vec![0.0; round],
        ..scan.clone()
    };
    let mut scanner = scanner_of(&full);
    let mut expected = vec![0.0; round];
    let headings = (TAU / parameters.grid.1).ceil().max(8.0) as usize;
    let every = beams.div_ceil(COMPARED);
    let seen: Vec<(f64, f64)> =
        (0..beams).step_by(every).map(|beam| (scan.angle(beam), scan.ranges[beam])).collect();
    let mut candidates = Vec::new();
    for place in map.free_places(parameters.grid.0, parameters.radius) {
        map.expect(&mut scanner, &Pose::new(place.x, place.y, 0.0), &mut expected);
        for step in 0..headings {
            let heading = TAU * step as f64 / headings as f64;
            let score = score(&seen, &expected, heading, parameters);
            // The scanner is there; the robot is where its mount says.
            let pose = Pose::new(place.x, place.y, normalize_angle(heading)).compose(&scan.mount.inverse());
            candidates.push(Candidate { pose, score });
        }
    }
    best(candidates, parameters)
}

/// The share of beams whose ranges are as expected, as far as that can be told from a grid.
fn score(seen: &[(f64, f64)], expected: &[f64], heading: f64, parameters: &LocaliserParameters) -> f64 {
    let beams = expected.len();
    let per_radian = beams as f64 / TAU;
    let near = parameters.grid.0 + 3.0 * parameters.range_error;
    let mut sum = 0.0;
    for &(angle, range) in seen {
        let beam = (((angle + heading) * per_radian).round() as i64).rem_euclid(beams as i64) as usize;
        let other = expected[beam];
        // Far away a small turn makes a large difference.
        let tolerance = near + 0.3 * parameters.grid.1 * range.min(10.0);
        let off = if range.is_finite() && other.is_finite() {
            (range - other).abs() / tolerance
        } else if range.is_finite() == other.is_finite() {
            0.0
        } else {
            2.0
        };
        sum += (1.0 - off * off).max(0.0);
    }
    sum / seen.len().max(1) as f64
}

/// The best candidates, of those close together the best alone.
fn best(mut candidates: Vec<Candidate>, parameters: &LocaliserParameters) -> Vec<Candidate> {
    candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
    let (near, alike) = (1.5 * parameters.grid.0, 2.5 * parameters.grid.1);
    let mut chosen: Vec<Candidate> = Vec::new();
    for candidate in candidates {
        let is_new = chosen.iter().all(|other| {
            other.pose.distance_to(candidate.pose.position()) > near
                || angle_difference(other.pose.heading, candidate.pose.heading).abs() > alike
        });
        if is_new {
            chosen.push(candidate);
        }
        if chosen.len() >= parameters.candidates {
            break;
        }
    }
    chosen
}
