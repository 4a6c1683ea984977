//! The lane ahead of a car that knows only some of its cones: one side may be missing, gaps may be wide, and
//! false cones may stand around.

use super::cone::Cone;
use super::fit::Fitter;
use super::lane_model::{Lane, LaneParameters, Way};
use super::rows::{Passage, RowParameters, rows};
use super::ways::{along_lane, beside_row, distinct, straight_on};
use crate::geometry::{Point, Pose, Vector};

#[cfg(test)]
mod tests;

/// Finds the most likely lane among cones, some of which may be missing or false. A lane is a curve with
/// edges at half its width on both sides, whose curvature changes slowly, and which keeps clear of all cones.
/// Known colours are used.
///
/// First, the cones are read as rows, in up to four ways. Then a lane is fitted beside each row, along the
/// previous lane and straight on, by least squares with cones weighted by the probability that they belong to
/// an edge. The most likely result is returned.
///
/// `behind` are previous poses, oldest first; `car` is the pose of the point that is to stay in the middle;
/// `before` is the previous lane. The lane begins up to [`LaneParameters::spacing`] behind the car, where
/// `behind` does, and ends just beyond the last cone of its edges. `None` without a cone at an edge, or if a
/// parameter is out of range. O(n²) for n cones.
///
/// ```
/// use roverlab::race::{Cone, Lane, LaneParameters, lane};
/// use roverlab::geometry::{Point, Pose};
/// let edge = |y: f64| (0..6).map(move |k| Cone::unknown(Point::new(3.0 * f64::from(k), y)));
/// let cones: Vec<Cone> = edge(1.6).chain(edge(-1.8)).collect();
/// let unknown = Lane { points: Vec::new(), edges: [Vec::new(), Vec::new()], half_width: 1.9 };
/// let found = lane(&cones, &[], Pose::default(), &unknown, &LaneParameters::default()).expect("a lane");
/// assert_eq!((found.edges[0].len(), found.edges[1].len()), (6, 6));
/// assert!(found.points[8..].iter().all(|point| (point.y + 0.1).abs() < 0.1));
/// ```
pub fn lane(
    cones: &[Cone],
    behind: &[Pose],
    car: Pose,
    before: &Lane,
    parameters: &LaneParameters,
) -> Option<Lane> {
    lane_where(cones, &Way { behind, car, earlier: &[], others: &[] }, before, parameters)
}

/// The same for a car whose earlier path is known.
pub(super) fn lane_where(
    cones: &[Cone],
    way: &Way,
    before: &Lane,
    parameters: &LaneParameters,
) -> Option<Lane> {
    if parameters.validate().is_err() || before.half_width <= 0.0 {
        return None;
    }
    let car = way.car;
    let reach = parameters.ahead + parameters.spacing;
    let near: Vec<usize> =
        (0..cones.len()).filter(|&cone| (cones[cone].position - car.position()).norm() < reach).collect();
    let cones: Vec<Cone> = near.iter().map(|&cone| cones[cone]).collect();
    let mut found = lane_between(&cones, way, before, parameters)?;
    for cone in found.edges.iter_mut().flatten() {
        *cone = near[*cone];
    }
    Some(found)
}

/// The same among nearby cones only.
fn lane_between(cones: &[Cone], way: &Way, before: &Lane, parameters: &LaneParameters) -> Option<Lane> {
    // Poses far behind do not constrain the lane here, and a curve from there would bend too slowly.
    let is_far = |pose: &Pose| (pose.position() - way.car.position()).norm() > parameters.spacing;
    let first = way.behind.iter().rposition(is_far).map_or(0, |far| far + 1);
    let stations: Vec<Pose> = way.behind[first..].iter().copied().chain([way.car]).collect();
    let earlier: Vec<Passage> = way.earlier.iter().map(|pose| (*pose).into()).collect();
    let fitter = Fitter { cones, way, earlier: &earlier, before, parameters };
    let fits = ways(cones, &stations, &earlier, before, parameters)
        .into_iter()
        .filter_map(|ahead| fitter.fit(&[&stations[..], &ahead].concat(), stations.len() - 1));
    let best = fits.filter(|fit| fit.worth.is_finite()).max_by(|a, b| a.worth.total_cmp(&b.worth))?;
    let mut points = even(&best.middle);
    let places: Vec<Point> =
        cones.iter().map(|cone| cone.position).chain(way.others.iter().copied()).collect();
    keep_clear(&mut points, &places, parameters.clearance + 0.5 * parameters.loose);
    let found = Lane { points, edges: best.edges, half_width: best.half_width };
    found.edges.iter().any(|edge| !edge.is_empty()).then_some(found)
}

/// Candidate paths ahead: beside the rows of each reading, along the previous lane, and straight on.
fn ways(
    cones: &[Cone],
    stations: &[Pose],
    earlier: &[Passage],
    before: &Lane,
    p: &LaneParameters,
) -> Vec<Vec<Pose>> {
    let Some(&car) = stations.last() else { return Vec::new() };
    let (half_width, narrowest) = (before.half_width, p.half_width[0]);
    let along_rows =
        RowParameters { reach: p.spacing, half_width, narrowest, loose: p.loose, sharpest: p.sharpest };
    let mut ways = Vec::new();
    for rows in rows(cones, stations, earlier, &along_rows) {
        for (row, right) in rows.edges.iter().zip([half_width, -half_width]) {
            let places: Vec<Point> = row.iter().map(|&cone| cones[cone].position).collect();
            ways.extend(beside_row(&places, right, car, p.ahead));
        }
    }
    ways.extend(along_lane(before, car, p.ahead));
    ways.extend(straight_on(car, p.ahead));
    distinct(ways)
}

/// Points at equal steps of about a metre along a chain, smoothed.
fn even(chain: &[Point]) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::new();
    let mut left = 0.0;
    for pair in chain.windows(2) {
        let leg = pair[1] - pair[0];
        let length = leg.norm();
        while left < length {
            points.push(pair[0] + leg * (left / length));
            left += 1.0;
        }
        left -= length;
    }
    (0..3).for_each(|_| smooth(&mut points));
    points
}

/// Moves points towards the midpoints of their neighbours, and then outwards by as much, to preserve the size
/// of bends.
fn smooth(points: &mut [Point]) {
    for share in [0.5, -0.52] {
        let old = points.to_vec();
        for i in 1..old.len().saturating_sub(1) {
            points[i] += (nalgebra::center(&old[i - 1], &old[i + 1]) - old[i]) * share;
        }
    }
}

/// Number of rounds in which points are moved away from cones.
const PUSHES: usize = 8;

/// Moves points away from obstacles closer than `room`, as far as those on the other side permit.
fn keep_clear(points: &mut [Point], places: &[Point], room: f64) {
    for _ in 0..PUSHES {
        for point in points.iter_mut() {
            let push = |place: &Point| {
                let away = *point - place;
                let distance = away.norm().max(1e-6);
                away * (0.5 * (room - distance).max(0.0) / distance)
            };
            let pushes: Vector = places.iter().map(push).sum();
            *point += pushes;
        }
        smooth(points);
    }
}
