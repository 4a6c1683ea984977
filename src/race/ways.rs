//! Rough paths ahead of a car, near which its lane may lie.

use super::lane_model::Lane;
use crate::geometry::{Point, Pose, direction, math};

/// Distance between stations beyond the known lane, from the car to the first station beside a row, and
/// within which paths are neighbours (m).
const STEP: f64 = 1.0;
/// Distance from the car within which the path begins (m).
const AWAY: f64 = 4.0;
/// Number of points of a lane that suffice to continue along it.
const ENOUGH: usize = 3;

/// A path some metres to the right (or left, if negative) of a row of cones in order along the lane. `None`
/// without two consecutive cones, the later one ahead of the car or well away from it.
pub(super) fn beside_row(row: &[Point], right: f64, car: Pose, reach: f64) -> Option<Vec<Pose>> {
    let beside = |pair: &[Point]| {
        let leg = pair[1] - pair[0];
        let middle = nalgebra::center(&pair[0], &pair[1]);
        let leg = Pose::new(middle.x, middle.y, math::atan2(leg.y, leg.x));
        leg.compose(&Pose::new(0.0, -right, 0.0))
    };
    let poses: Vec<Pose> = row.windows(2).map(beside).collect();
    let begin = nearest(poses.iter().map(Pose::position), car.position())?;
    // Points beside or just behind the car would turn the path around.
    let is_ahead = |pose: &Pose| {
        let local = car.to_local(pose.position());
        local.x > STEP || local.coords.norm() > AWAY
    };
    let ahead: Vec<Pose> = poses[begin..].iter().copied().filter(is_ahead).collect();
    prolonged(ahead, car, reach)
}

/// The path along the previous lane; `None` if that ends beside the car.
pub(super) fn along_lane(lane: &Lane, car: Pose, reach: f64) -> Option<Vec<Pose>> {
    let begin = nearest(lane.points.iter().copied(), car.position())? + 1;
    let ahead = lane.points.get(begin..).filter(|ahead| ahead.len() >= ENOUGH)?;
    let pose = |pair: &[Point]| {
        let leg = pair[1] - pair[0];
        Pose::new(pair[1].x, pair[1].y, math::atan2(leg.y, leg.x))
    };
    prolonged(ahead.windows(2).map(pose).collect(), car, reach)
}

/// The path straight on.
pub(super) fn straight_on(car: Pose, reach: f64) -> Option<Vec<Pose>> {
    prolonged(vec![car.compose(&Pose::new(STEP, 0.0, 0.0))], car, reach)
}

/// Cuts or extends a path to a length, measured from the car (m).
fn prolonged(way: Vec<Pose>, car: Pose, reach: f64) -> Option<Vec<Pose>> {
    let last = *way.last()?;
    let (mut from, mut length) = (car.position(), 0.0);
    let mut stations: Vec<Pose> = Vec::with_capacity(way.len());
    for pose in way {
        let leg = pose.position() - from;
        if length + leg.norm() >= reach {
            let end = from + leg * ((reach - length) / leg.norm());
            stations.push(Pose::new(end.x, end.y, pose.heading));
            return Some(stations);
        }
        (from, length) = (pose.position(), length + leg.norm());
        stations.push(pose);
    }
    let ahead = direction(last.heading);
    let mut beyond = STEP;
    while length + beyond < reach {
        let place = last.position() + ahead * beyond;
        stations.push(Pose::new(place.x, place.y, last.heading));
        beyond += STEP;
    }
    Some(stations)
}

fn nearest(places: impl Iterator<Item = Point>, place: Point) -> Option<usize> {
    let squared = places.map(|other| (other - place).norm_squared());
    squared.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
}

/// Removes paths that coincide with an earlier one.
pub(super) fn distinct(ways: Vec<Vec<Pose>>) -> Vec<Vec<Pose>> {
    let mut kept: Vec<Vec<Pose>> = Vec::with_capacity(ways.len());
    for way in ways {
        if !kept.iter().any(|other| leads_along(&way, other)) {
            kept.push(way);
        }
    }
    kept
}

/// Whether a path coincides with another one.
fn leads_along(way: &[Pose], other: &[Pose]) -> bool {
    let is_beside =
        |place: &Pose| other.iter().any(|pose| (pose.position() - place.position()).norm() < STEP);
    way.iter().all(is_beside)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Length of a path from the car (m).
    fn length(way: &[Pose], car: Pose) -> f64 {
        let stations: Vec<Pose> = [&[car], way].concat();
        stations.windows(2).map(|pair| (pair[1].position() - pair[0].position()).norm()).sum()
    }

    #[test]
    fn ways_reach_as_far_as_they_should() {
        let car = Pose::new(2.0, 1.0, 0.3);
        let row: Vec<Point> =
            (0..6).map(|k| car.to_world(Point::new(3.0 * f64::from(k) - 4.0, 1.8))).collect();
        let lane = Lane { points: row.clone(), edges: [Vec::new(), Vec::new()], half_width: 1.8 };
        let wide: Vec<Point> = [-2.0, 7.0, 17.0, 27.0].map(|x| car.to_world(Point::new(x, 1.8))).to_vec();
        let ways = [
            straight_on(car, 17.5),
            beside_row(&row, 1.8, car, 17.5),
            beside_row(&wide, 1.8, car, 17.5),
            along_lane(&lane, car, 17.5),
        ];
        for way in ways.iter().flatten() {
            assert!((16.4..17.6).contains(&length(way, car)), "{} {way:?}", length(way, car));
        }
        assert_eq!(ways.iter().flatten().count(), 4);
        for pose in ways[1].as_ref().unwrap() {
            let local = car.to_local(pose.position());
            assert!(local.x > 1.0 && local.y.abs() < 1e-9 && (pose.heading - 0.3).abs() < 1e-9, "{local}");
        }
    }

    #[test]
    fn there_is_no_way_beside_nothing() {
        let car = Pose::default();
        assert!(beside_row(&[], 1.8, car, 17.5).is_none());
        assert!(beside_row(&[Point::new(3.0, 1.8)], 1.8, car, 17.5).is_none());
        assert!(beside_row(&[Point::new(-3.0, 1.8), Point::new(-1.0, 1.8)], 1.8, car, 17.5).is_none());
        assert!(along_lane(&Lane::unknown(1.8), car, 17.5).is_none());
    }

    #[test]
    fn one_of_two_ways_that_are_alike_is_kept() {
        let [car, other] = [Pose::default(), Pose::new(0.0, 0.0, 0.5)];
        let beside = Pose::new(0.0, 0.3, 0.0);
        let ways = [car, beside, other].map(|pose| straight_on(pose, 10.0).unwrap());
        assert_eq!(distinct(ways.to_vec()).len(), 2);
    }
}
