use std::ops::Range;

use super::ScanFeaturesParameters;
use super::clusters::{Cluster, Hit, clusters};
use super::split_merge::{ALIKE, Part, straight_parts};
use crate::geometry::{FittedLine, Point, angle_difference};
use crate::io::{LidarScan, Result};

/// A straight wall in a scan, in the robot frame.
#[derive(Debug, Clone, PartialEq)]
pub struct ScanWall {
    /// Fitted line, directed counter-clockwise about the robot.
    pub line: FittedLine,
    /// Visible ends: projections of the first and the last point onto the line.
    pub ends: [Point; 2],
    /// Beams that hit it; the end is below the start if they cross the scan's end.
    pub beams: Range<usize>,
}

/// Corner of two walls, in the robot frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanCorner {
    /// Intersection of the walls' lines (m).
    pub position: Point,
    /// Angle between the walls on the robot's side (rad): below pi for a concave corner (a peak of the scan),
    /// above pi for a convex one (a dip).
    pub angle: f64,
}

/// A small object in front of its background, in the robot frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanObject {
    /// Centre of the fitted circle (m).
    pub centre: Point,
    /// Radius of the fitted circle (m).
    pub radius: f64,
    /// Number of beams that hit it.
    pub points: usize,
}

/// Features of a scan.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ScanFeatures {
    /// Straight walls, in scan order.
    pub walls: Vec<ScanWall>,
    /// Corners, in scan order.
    pub corners: Vec<ScanCorner>,
    /// Objects, in scan order.
    pub objects: Vec<ScanObject>,
}

/// Extracts walls, corners and objects from a scan (book, chapter 4).
///
/// The scan is split where adjacent beams hit different surfaces. A small part in front of its neighbours is
/// an object; in the other parts, walls are found by split-and-merge, and corners where walls meet. Typically
/// O(n log n) for n beams.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::io::Lidar;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::scan::{ScanFeaturesParameters, extract_features};
/// use roverlab::world::{RobotSpec, Scene, World};
/// # fn main() -> roverlab::io::Result<()> {
/// let scene = Scene::with_robot(World::walled(2.0, 1.5), RobotSpec::s4(), Pose::new(0.8, 0.6, 0.3));
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let features = extract_features(&simulation.robot(0)?.scan()?, &ScanFeaturesParameters::default())?;
/// assert_eq!((features.walls.len(), features.corners.len(), features.objects.len()), (4, 4, 0));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If a parameter is out of range.
pub fn extract_features(scan: &LidarScan, parameters: &ScanFeaturesParameters) -> Result<ScanFeatures> {
    parameters.validate()?;
    let mut features = ScanFeatures::default();
    if scan.ranges.is_empty() {
        return Ok(features);
    }
    for cluster in clusters(scan, parameters) {
        if let Some(object) = object(&cluster, scan, parameters) {
            features.objects.push(object);
            continue;
        }
        let parts = straight_parts(&cluster.hits, parameters);
        features.walls.extend(parts.iter().map(|part| wall(&cluster.hits, part)));
    }
    // In a distant corner, adjacent beams may be so far apart that the scan is split there.
    let corners = features.walls.windows(2).filter_map(|two| corner(&two[0], &two[1], parameters));
    features.corners = corners.collect();
    close_round(&mut features, parameters);
    Ok(features)
}

fn wall(hits: &[Hit], part: &Part) -> ScanWall {
    let (first, last) = (hits[part.first], hits[part.end - 1]);
    ScanWall {
        line: part.line,
        ends: [first, last].map(|hit| part.line.foot(hit.point)),
        beams: first.beam..last.beam + 1,
    }
}

/// The corner of two consecutive walls (counter-clockwise), if it lies near their ends.
fn corner(one: &ScanWall, other: &ScanWall, parameters: &ScanFeaturesParameters) -> Option<ScanCorner> {
    let turn = angle_difference(other.line.angle(), one.line.angle());
    let position = one.line.crossing(&other.line)?;
    let near = |end: Point| (position - end).norm() < parameters.corner_gap;
    (turn.abs() > ALIKE && near(one.ends[1]) && near(other.ends[0]))
        .then_some(ScanCorner { position, angle: std::f64::consts::PI - turn })
}

/// Closes an unsplit scan: its first and last wall may meet or be the same.
fn close_round(features: &mut ScanFeatures, parameters: &ScanFeaturesParameters) {
    let [first, .., last] = features.walls.as_slice() else { return };
    let gap = (first.ends[0] - last.ends[1]).norm();
    if gap > 2.0 * parameters.corner_gap {
        return;
    }
    let alike = angle_difference(first.line.angle(), last.line.angle()).abs() < 0.1
        && last.line.distance_to(first.line.middle).abs() < parameters.tolerance();
    if alike {
        // The same wall, cut where the scan begins.
        let ends = [last.ends[0], first.ends[1]];
        let points = first.line.points + last.line.points;
        let Some(line) = FittedLine::through(last.ends.into_iter().chain(first.ends)) else { return };
        let line = FittedLine { points, rms: first.line.rms.max(last.line.rms), ..line };
        let joined = ScanWall { line, ends, beams: last.beams.start..first.beams.end };
        features.walls.pop();
        features.walls[0] = joined;
    } else if let Some(corner) = corner(last, first, parameters) {
        let known = features.corners.iter().any(|other| (other.position - corner.position).norm() < 1e-9);
        if !known {
            features.corners.push(corner);
        }
    }
}

/// The object that a cluster represents, if it is one.
fn object(cluster: &Cluster, scan: &LidarScan, parameters: &ScanFeaturesParameters) -> Option<ScanObject> {
    if cluster.stands_before != [true; 2] {
        return None;
    }
    let hits = &cluster.hits;
    let (first, last) = (hits[0].point, hits[hits.len() - 1].point);
    let range = hits.iter().map(|hit| hit.range).sum::<f64>() / hits.len() as f64;
    // The beams next to the outermost ones pass it.
    let seen = (last - first).norm() + range * scan.angle_increment.abs();
    let deepest = hits.iter().map(|hit| hit.range).fold(0.0, f64::max);
    let nearest = hits.iter().map(|hit| hit.range).fold(f64::INFINITY, f64::min);
    let depth = deepest - nearest;
    if seen > parameters.largest_object || depth > parameters.largest_object {
        return None;
    }
    let radius = 0.5 * seen;
    let middle: nalgebra::Vector2<f64> =
        hits.iter().map(|hit| hit.point.coords).sum::<nalgebra::Vector2<f64>>() / hits.len() as f64;
    let eye = scan.mount.position().coords;
    let away = (middle - eye).normalize();
    // The visible front of a disc lies pi/4 of the radius before its centre, on average.
    let centre = Point::from(middle + away * (radius * std::f64::consts::FRAC_PI_4));
    Some(ScanObject { centre, radius, points: hits.len() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Pose, units};
    use crate::io::Lidar;
    use crate::io::sim::{SimOptions, Simulation};
    use crate::world::{ObjectKind, RobotSpec, Scene, World};
    use proptest::prelude::*;

    fn features(world: &World, pose: Pose, noise: f64, seed: u64) -> ScanFeatures {
        let scene = Scene::with_robot(world.clone(), RobotSpec::s4(), pose);
        let simulation = Simulation::new(&scene, SimOptions::with_noise(noise, seed)).unwrap();
        let scan = simulation.robot(0).unwrap().scan().unwrap();
        extract_features(&scan, &ScanFeaturesParameters::default()).unwrap()
    }

    /// Distance from the true position to the nearest detection, in the world frame (m).
    fn off(pose: Pose, seen: impl Iterator<Item = Point>, real: Point) -> f64 {
        seen.map(|point| (pose.to_world(point) - real).norm()).fold(f64::INFINITY, f64::min)
    }

    /// A square with a convex corner.
    fn notched() -> World {
        let mut world = World::empty(3.0, 3.0);
        let corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (1.8, 3.0), (1.8, 1.8), (0.0, 1.8)];
        world.add_loop(&corners.map(|(x, y)| Point::new(x, y)));
        world
    }

    /// Number of true corners detected within 5 cm, and number of false detections.
    fn told(pose: Pose, found: &ScanFeatures, places: &[(f64, f64)]) -> (usize, usize) {
        let near = |corner: &ScanCorner, place: &(f64, f64)| {
            (pose.to_world(corner.position) - Point::new(place.0, place.1)).norm() < 0.05
        };
        let right =
            places.iter().filter(|place| found.corners.iter().any(|corner| near(corner, place))).count();
        let wrong =
            found.corners.iter().filter(|corner| !places.iter().any(|place| near(corner, place))).count();
        (right, wrong)
    }

    #[test]
    fn the_corners_of_a_notched_room_are_found_under_noise() {
        let (world, mut right, mut wrong) = (notched(), 0, 0);
        let places = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (1.8, 3.0), (1.8, 1.8), (0.0, 1.8)];
        for seed in 0..20 {
            // From here, all six walls are visible.
            let pose = Pose::new(2.3, 0.9, 0.3 * seed as f64);
            let found = features(&world, pose, 1.0, seed);
            assert!(found.objects.is_empty(), "{seed}");
            let told = told(pose, &found, &places);
            (right, wrong) = (right + told.0, wrong + told.1);
        }
        assert!(right >= 110 && wrong <= 10, "{right} of 120 corners, {wrong} that are none");
    }

    #[test]
    fn cans_are_objects() {
        let mut world = World::walled(3.0, 3.0);
        let can = std::sync::Arc::new(ObjectKind::predefined("can").unwrap());
        let places = [Point::new(0.9, 1.5), Point::new(1.9, 2.1)];
        for place in places {
            world.objects.push(crate::world::Object::new(can.clone(), Pose::new(place.x, place.y, 0.0)));
        }
        let (mut right, mut wrong) = (0, 0);
        for seed in 0..20 {
            let pose = Pose::new(1.5, 1.4, 0.5 * seed as f64);
            let found = features(&world, pose, 1.0, seed);
            assert_eq!(found.objects.len(), 2, "{seed}: {:?}", found.objects);
            for place in places {
                let off = off(pose, found.objects.iter().map(|object| object.centre), place);
                assert!(off < 0.025, "{seed}: {off}");
            }
            assert!(found.objects.iter().all(|object| (object.radius - 0.033).abs() < 0.015));
            let told = told(pose, &found, &[(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)]);
            (right, wrong) = (right + told.0, wrong + told.1);
        }
        assert!(right >= 74 && wrong <= 8, "{right} of 80 corners, {wrong} that are none");
    }

    /// Number of walls detected in the notched room, and maximum distance of their ends from true walls (m).
    fn walls_and_widest_gap(pose: Pose, seed: u64) -> (usize, f64) {
        let (world, mut widest) = (notched(), 0.0_f64);
        let found = features(&world, pose, 1.0, seed);
        for place in found.walls.iter().flat_map(|wall| wall.ends).map(|end| pose.to_world(end)) {
            let gaps = world.walls.iter().map(|wall| wall.line.distance_to(place));
            widest = widest.max(gaps.fold(f64::INFINITY, f64::min));
        }
        (found.walls.len(), widest)
    }

    #[test]
    fn a_wall_seen_aslant_may_end_some_deviations_too_early() {
        let pose = Pose::new(2.148_350_379_165_891_8, 0.4, 2.243_341_181_737_291_5);
        let (_, gap) = walls_and_widest_gap(pose, 14_271_856_299_766_098_168);
        assert!(gap < 0.05, "{gap}");
    }

    proptest! {
        #![proptest_config(crate::testing::cases(32))]
        #[test]
        fn walls_lie_where_walls_are(x in 0.4..2.6f64, y in 0.4..1.4f64, heading in -3.1..3.1f64, seed: u64) {
            let (walls, gap) = walls_and_widest_gap(Pose::new(x, y, heading), seed);
            prop_assert!(walls >= 4);
            // Six standard deviations of a range: on a slanted wall, a single reading determines the end.
            prop_assert!(gap < 0.06, "{}", gap);
        }

        #[test]
        fn nothing_panics(ranges in prop::collection::vec(prop_oneof![0.0..9.0f64, Just(f64::INFINITY)], 0..400)) {
            let angle_increment = units::from_deg(360.0) / ranges.len().max(1) as f64;
            let scan = LidarScan { angle_min: -3.0, angle_increment, range_max: 9.0, ranges, ..LidarScan::default() };
            prop_assert!(extract_features(&scan, &ScanFeaturesParameters::default()).is_ok());
        }
    }

    #[test]
    fn wrong_parameters_are_refused() {
        let good = ScanFeaturesParameters::default();
        for bad in [
            ScanFeaturesParameters { least_wall: 0.0, ..good },
            ScanFeaturesParameters { range_error: f64::NAN, ..good },
            ScanFeaturesParameters { least_points: 1, ..good },
        ] {
            assert!(extract_features(&LidarScan::default(), &bad).is_err());
        }
        let nothing =
            LidarScan { ranges: vec![f64::INFINITY; 90], angle_increment: 0.07, ..LidarScan::default() };
        assert_eq!(extract_features(&nothing, &good).unwrap(), ScanFeatures::default());
    }
}
