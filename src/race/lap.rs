//! The corridor of a driven lap.

use super::corridor::{Corridor, CrossSection};
use super::error::LineError;
use super::lane_model::LaneParameters;
use super::map::SHORTEST_LAP;
use super::round::BESIDE;
use super::spline::ClosedSpline;
use crate::geometry::{Point, Pose, math};

/// Number of stations to either side within which the width of a track is about constant.
const ALIKE: usize = 10;

/// The corridor around a lap driven along the centre line, between the cones beside it.
pub(super) fn around_lap(cones: &[Point], lap: &[Point], p: &LaneParameters) -> Result<Corridor, LineError> {
    let stations: Vec<Pose> = ClosedSpline::through(lap)?
        .resample(1.0)
        .iter()
        .map(|place| {
            let heading = math::atan2(place.tangent.y, place.tangent.x);
            Pose::new(place.position.x, place.position.y, heading)
        })
        .collect();
    let n = stations.len();
    let edges = p.half_width[0] - p.loose..p.half_width[1] + p.loose;
    let beside = |side: f64| -> Vec<Option<f64>> {
        let near = |pose: &Pose| {
            let local = cones.iter().map(|cone| pose.to_local(*cone)).filter(|local| local.x.abs() < 0.8);
            let asides = local.map(|local| side * local.y).filter(|aside| edges.contains(aside));
            asides.min_by(f64::total_cmp)
        };
        stations.iter().map(near).collect()
    };
    let sides = [beside(1.0), beside(-1.0)];
    let usual = |at: usize| {
        let around = (at + n - ALIKE..=at + n + ALIKE).flat_map(|k| [sides[0][k % n], sides[1][k % n]]);
        let mut asides: Vec<f64> = around.flatten().collect();
        asides.sort_by(f64::total_cmp);
        asides.get(asides.len() / 2).copied().unwrap_or(p.usual)
    };
    let rows: Vec<(Point, f64, f64)> = (0..n)
        .map(|at| {
            let usual = usual(at);
            let [left, right] = [0, 1].map(|side| between(&sides[side], at, usual, p));
            // Without one edge, it is as far from the other as it usually is.
            let [left, right] = match (left, right) {
                (Some(left), Some(right)) => [left, right],
                (Some(left), None) => [left, (2.0 * usual - left).max(0.5)],
                (None, Some(right)) => [(2.0 * usual - right).max(0.5), right],
                (None, None) => [usual; 2],
            };
            (stations[at].position(), left, right)
        })
        .collect();
    Corridor::closed(&rows)
}

/// The distance of an edge at a station of a lap, between the cones before and behind it that are about as
/// far off as is usual.
fn between(asides: &[Option<f64>], at: usize, usual: f64, p: &LaneParameters) -> Option<f64> {
    let (n, far) = (asides.len(), (p.spacing as usize).min(asides.len()));
    let good = |k: usize| asides[k % n].filter(|aside| (aside - usual).abs() < p.loose);
    let ahead = (0..=far).find_map(|k| good(at + k).map(|aside| (k as f64, aside)));
    let back = (0..=far).find_map(|k| good(at + n - k).map(|aside| (k as f64, aside)));
    match (back, ahead) {
        (Some((before, one)), Some((behind, other))) => {
            let share = before / (before + behind).max(1e-6);
            Some(one + (other - one) * share)
        }
        (one, other) => one.or(other).map(|(_, aside)| aside),
    }
}

/// Number of rounds in which kinks are removed from a line.
const ROUNDS: usize = 4;

/// Whether a corridor is a loop that follows a driven lap everywhere, and nothing else.
pub(super) fn holds(corridor: &Corridor, lap: &[Point]) -> bool {
    let stations = corridor.stations();
    let near = |a: Point, b: Point, most: f64| (a - b).norm_squared() < most * most;
    let inside = |place: &Point| stations.iter().any(|station| near(station.position, *place, BESIDE));
    let driven =
        |station: &CrossSection| lap.iter().any(|place| near(station.position, *place, BESIDE + 1.0));
    corridor.is_closed()
        && corridor.length() > SHORTEST_LAP
        && lap.iter().all(inside)
        && stations.iter().all(driven)
}

/// Removes kinks of a loop, caused by narrow places: no car steers so fast, and centimetres suffice.
pub(super) fn without_kinks(points: &mut [Point]) {
    let n = points.len();
    // Towards the midpoints of the neighbours, and then outwards by as much, to preserve the size of bends.
    for share in [0.5, -0.51].repeat(ROUNDS) {
        let old = points.to_vec();
        for (i, point) in points.iter_mut().enumerate() {
            let middle = nalgebra::center(&old[(i + n - 1) % n], &old[(i + 1) % n]);
            *point += (middle - old[i]) * share;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::race::{TrackOptions, generate};

    #[test]
    fn a_lap_has_its_corridor() {
        let generated = generate(5, &TrackOptions::drawn(5)).unwrap();
        let lap: Vec<Point> =
            generated.corridor.stations().iter().step_by(2).map(|s| s.aside(0.15)).collect();
        let mut places: Vec<Point> = generated.track.cones.iter().map(|cone| cone.position).collect();
        // Every ninth one is missing.
        let mut index = 0;
        places.retain(|_| {
            index += 1;
            index % 9 != 4
        });
        let found = around_lap(&places, &lap, &LaneParameters::default()).unwrap();
        let wrong = |a: f64, b: f64| (a - b).abs();
        for station in found.stations() {
            let truth = generated.corridor.stations().iter().min_by(|a, b| {
                let squared = |s: &crate::race::CrossSection| (s.position - station.position).norm_squared();
                squared(a).total_cmp(&squared(b))
            });
            let truth = truth.unwrap();
            let widths = [station.left + station.right, truth.left + truth.right];
            assert!(wrong(widths[0], widths[1]) < 0.9, "{station:?} {truth:?}");
        }
    }
}
