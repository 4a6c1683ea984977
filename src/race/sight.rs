use std::f64::consts::FRAC_PI_4;

use super::cone::ConeColour;
use crate::geometry::{Point, direction, math};
use crate::io::LidarScan;

/// A detection in a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConeSighting {
    /// Centre, in the robot frame (m).
    pub position: Point,
    /// Distance from its first to its last point (m).
    pub size: f64,
    /// Fraction of the expected beams that hit it, 0 to 1; 0 if its colour shows that it is [most likely no
    /// cone](super::CameraSight::fuse).
    pub confidence: f64,
    /// Distance from the sensor (m).
    pub range: f64,
    /// Possible error of its position (m).
    pub error: f64,
    /// Its colour, if visible.
    pub colour: ConeColour,
}

impl ConeSighting {
    /// Width that no cone has (m).
    pub const WIDEST_CONE: f64 = 0.45;

    /// Whether it is small enough for a cone.
    pub fn is_cone(&self) -> bool {
        self.size < Self::WIDEST_CONE
    }
}

/// Error of a cone's position in a scan (m).
const ERROR: f64 = 0.03;
/// Distance within which a beam hits only the car itself (m).
const BLIND: f64 = 0.05;
/// Maximum distance between two points of one thing (m).
const STEP: f64 = 0.3;

/// Objects in a scan: runs of beams with adjacent ends, where single beams may miss. O(n).
///
/// Objects that appear small because something nearer hides a part of them are omitted: they may be a part of
/// anything, such as the side of a car, but look like cones.
///
/// ```
/// use roverlab::race::sightings;
/// use roverlab::io::LidarScan;
/// let mut ranges = vec![f64::INFINITY; 181];
/// ranges[89..92].copy_from_slice(&[5.01, 4.94, 5.01]);
/// let step = 1.0_f64.to_radians();
/// let scan = LidarScan { angle_min: -90.0 * step, angle_increment: step, range_max: 20.0, ranges, ..LidarScan::default() };
/// let found = sightings(&scan);
/// assert!(found.len() == 1 && found[0].is_cone() && (found[0].position.x - 5.05).abs() < 0.02);
/// ```
pub fn sightings(scan: &LidarScan) -> Vec<ConeSighting> {
    runs(scan).iter().filter_map(|run| finish(scan, run)).collect()
}

/// The points of things that are too large for cones, such as other cars, in the robot's frame.
pub(super) fn bodies(scan: &LidarScan) -> Vec<Vec<Point>> {
    let place = |&beam: &usize| {
        scan.mount.to_world(Point::origin() + direction(scan.angle(beam)) * scan.ranges[beam])
    };
    let things = runs(scan).into_iter().map(|run| run.iter().map(place).collect::<Vec<Point>>());
    let is_large = |thing: &Vec<Point>| {
        let ends = thing.first().zip(thing.last());
        ends.is_some_and(|(first, last)| (last - first).norm() >= ConeSighting::WIDEST_CONE)
    };
    things.filter(is_large).collect()
}

/// Runs of beams with adjacent ends.
fn runs(scan: &LidarScan) -> Vec<Vec<usize>> {
    let mut found = Vec::new();
    let mut run: Vec<usize> = Vec::new();
    let mut misses = 0;
    for (beam, &range) in scan.ranges.iter().enumerate() {
        if !(range.is_finite() && range > BLIND) {
            misses += 1;
            continue;
        }
        let near = run.last().is_some_and(|&last| (scan.ranges[last] - range).abs() < STEP && misses <= 1);
        if !near {
            found.push(std::mem::take(&mut run));
        }
        run.push(beam);
        misses = 0;
    }
    found.push(run);
    found
}

fn finish(scan: &LidarScan, run: &[usize]) -> Option<ConeSighting> {
    let (&first, &last) = (run.first()?, run.last()?);
    let count = run.len() as f64;
    let angle = run.iter().map(|&beam| scan.angle(beam)).sum::<f64>() / count;
    let mean = run.iter().map(|&beam| scan.ranges[beam]).sum::<f64>() / count;
    let place = |beam: usize| direction(scan.angle(beam)) * scan.ranges[beam];
    let size = (place(last) - place(first)).norm();
    let before = first.checked_sub(1).is_some_and(|beside| is_nearer(scan, beside, first));
    if size < ConeSighting::WIDEST_CONE && (before || is_nearer(scan, last + 1, last)) {
        return None;
    }
    // Beams meet a disc at a quarter of pi of its radius before its middle, in the mean; half way up, as
    // here.
    let radius = ConeColour::Unknown.radius_half_way_up();
    let range = mean + FRAC_PI_4 * radius;
    let half = math::asin((radius / range).min(1.0));
    let expected = (2.0 * half / scan.angle_increment.abs().max(1e-9)).floor().max(1.0);
    let local = Point::origin() + direction(angle) * range;
    Some(ConeSighting {
        position: scan.mount.to_world(local),
        size,
        confidence: (count / expected).min(1.0),
        range,
        error: ERROR,
        colour: ConeColour::Unknown,
    })
}

/// Whether a beam ends before another one.
fn is_nearer(scan: &LidarScan, beam: usize, other: usize) -> bool {
    scan.ranges.get(beam).is_some_and(|range| *range > BLIND && *range < scan.ranges[other])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn scan_of(discs: &[Point]) -> LidarScan {
        let radius = ConeColour::Unknown.radius_half_way_up();
        let step = std::f64::consts::PI / 900.0;
        let ranges = (0..901)
            .map(|beam| {
                let ray = direction(-0.5 * std::f64::consts::PI + step * f64::from(beam));
                let hits = discs.iter().filter_map(|disc| {
                    let along = disc.coords.dot(&ray);
                    let aside = disc.coords.norm_squared() - along * along;
                    let deep = radius * radius - aside;
                    (deep >= 0.0 && along > 0.0).then(|| along - deep.sqrt())
                });
                hits.fold(f64::INFINITY, f64::min)
            })
            .collect();
        let angle_min = -0.5 * std::f64::consts::PI;
        LidarScan { angle_min, angle_increment: step, range_max: 25.0, ranges, ..LidarScan::default() }
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn a_cone_is_found_where_it_stands(x in 0.5..14.0f64, y in -8.0..8.0f64) {
            let found = sightings(&scan_of(&[Point::new(x, y)]));
            prop_assert_eq!(found.len(), 1);
            prop_assert!((found[0].position - Point::new(x, y)).norm() < 0.03, "{:?}", found);
            prop_assert!(found[0].is_cone() && found[0].confidence > 0.4);
        }
    }

    #[test]
    fn the_side_of_a_car_is_no_row_of_cones() {
        // From the corner at (6, 0.7) on, hits on the side are increasingly far apart.
        let step = 0.01;
        let wall = |beam: i32| {
            let ray = direction(step * f64::from(beam));
            let (rear, side) = (6.0 / ray.x, 0.7 / ray.y);
            if (-0.7..0.7).contains(&(rear * ray.y)) {
                rear
            } else if side * ray.x > 6.0 && side * ray.x < 9.0 {
                side
            } else {
                f64::INFINITY
            }
        };
        let ranges: Vec<f64> = (-50..50).map(wall).collect();
        let scan = LidarScan {
            angle_min: -0.5,
            angle_increment: step,
            range_max: 25.0,
            ranges,
            ..LidarScan::default()
        };
        let found = sightings(&scan);
        assert!(found.len() == 1 && !found[0].is_cone(), "{found:?}");
    }

    #[test]
    fn neighbours_are_told_apart() {
        let found = sightings(&scan_of(&[Point::new(5.0, 0.0), Point::new(5.0, 0.4), Point::new(9.0, 0.3)]));
        assert_eq!(found.len(), 3);
        // The third one is in the shadow of the first.
        let found = sightings(&scan_of(&[Point::new(5.0, 0.0), Point::new(5.0, 0.4), Point::new(9.0, 0.1)]));
        assert_eq!(found.len(), 2);
        assert!(sightings(&LidarScan::default()).is_empty());
    }
}
