use super::ScanFeaturesParameters;
use crate::geometry::{Point, direction, math};
use crate::io::LidarScan;
use crate::kinematics::OUTLIER;
use crate::scan::filter::GRAZING;

/// A beam with an echo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    pub(super) beam: usize,
    pub(super) range: f64,
    /// Position in the robot frame (m).
    pub(super) point: Point,
}

/// Hits of adjacent beams on what appears to be one surface, in order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cluster {
    pub(super) hits: Vec<Hit>,
    /// Whether the adjacent beams on either side hit something farther away, or nothing.
    pub(super) stands_before: [bool; 2],
}

/// Splits a scan where adjacent beams hit different surfaces (G. A. Borges and M.-J. Aldon, "Line extraction
/// in 2D range images for mobile robotics", 2004). In a full-turn scan, a cluster across the scan's ends
/// stays whole.
pub(super) fn clusters(scan: &LidarScan, parameters: &ScanFeaturesParameters) -> Vec<Cluster> {
    let beams = scan.ranges.len();
    let all_round = (scan.angle_increment.abs() * beams as f64 - std::f64::consts::TAU).abs() < 1e-6;
    let breaks: Vec<bool> = (0..beams)
        .map(|beam| (beam == 0 && !all_round) || is_break(scan, (beam + beams - 1) % beams, beam, parameters))
        .collect();
    // Begin at a break, so that no cluster crosses the end.
    let Some(first) = breaks.iter().position(|&is_break| is_break) else {
        let hits = (0..beams).filter_map(|beam| hit(scan, beam)).collect();
        return vec![Cluster { hits, stands_before: [false; 2] }];
    };
    let mut clusters: Vec<Cluster> = Vec::new();
    for step in 0..beams {
        let beam = (first + step) % beams;
        if breaks[beam] || clusters.is_empty() {
            clusters.push(Cluster { hits: Vec::new(), stands_before: [false; 2] });
        }
        if let (Some(cluster), Some(hit)) = (clusters.last_mut(), hit(scan, beam)) {
            cluster.hits.push(hit);
        }
    }
    clusters.retain(|cluster| !cluster.hits.is_empty());
    for cluster in &mut clusters {
        cluster.stands_before = sides(scan, cluster, all_round);
    }
    clusters
}

fn hit(scan: &LidarScan, beam: usize) -> Option<Hit> {
    let range = scan.ranges[beam];
    let angle = scan.mount.heading + scan.angle(beam);
    let point = scan.mount.position() + direction(angle) * range;
    range.is_finite().then_some(Hit { beam, range, point })
}

/// Whether two adjacent beams hit different surfaces, or only one of them has an echo.
fn is_break(scan: &LidarScan, one: usize, other: usize, parameters: &ScanFeaturesParameters) -> bool {
    let (a, b) = (scan.ranges[one], scan.ranges[other]);
    match (a.is_finite(), b.is_finite()) {
        (true, true) => {}
        (false, false) => return false,
        _ => return true,
    }
    let step = scan.angle_increment.abs();
    let slope = math::sin(step) / math::sin((GRAZING - step).max(0.3 * GRAZING));
    (a - b).abs() > a.min(b) * slope.min(1.0) + OUTLIER * parameters.range_error + 0.01
}

/// Whether the neighbours of a cluster are farther away, on either side.
fn sides(scan: &LidarScan, cluster: &Cluster, all_round: bool) -> [bool; 2] {
    let beams = scan.ranges.len();
    let (first, last) = (cluster.hits[0], cluster.hits[cluster.hits.len() - 1]);
    let neighbour = |beam: Option<usize>| beam.map_or(f64::NEG_INFINITY, |beam| scan.ranges[beam]);
    let before = if all_round { Some((first.beam + beams - 1) % beams) } else { first.beam.checked_sub(1) };
    let after = if all_round {
        Some((last.beam + 1) % beams)
    } else {
        Some(last.beam + 1).filter(|&beam| beam < beams)
    };
    [neighbour(before) > first.range, neighbour(after) > last.range]
}
