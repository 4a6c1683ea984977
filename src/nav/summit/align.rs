use nalgebra::{SMatrix, SVector};

use super::sight_map::SightMap;
use crate::geometry::{Point3, Vector};

/// How a look has to be moved to lie on the map: along both axes, upwards, about the upright axis, and by how much it rises in a
/// metre along both axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Shift {
    pub(super) place: Vector,
    pub(super) up: f64,
    pub(super) turn: f64,
    pub(super) tilt: Vector,
}

/// Metres from the map at which a point counts half, by rounds of the fit: many count at first, so that a look finds its place
/// from afar.
const OUTLIERS: [f64; 14] =
    [0.15, 0.15, 0.1, 0.1, 0.06, 0.06, 0.04, 0.04, OUTLIER, OUTLIER, OUTLIER, OUTLIER, OUTLIER, OUTLIER];
const OUTLIER: f64 = 0.02;
/// The fewest points that count.
const ENOUGH: usize = 100;
/// How far dead reckoning may be off, as standard deviations: along both axes, upwards, about the upright axis.
const EXPECTED: [f64; 4] = [0.3, 0.3, 0.1, 0.05];

/// Fits points around a robot to the map by least squares on their heights, with little weight for outliers. `tilt` is by how
/// much the look may be tilted, in radians. `None` if they do not lie on it.
pub(super) fn align(map: &SightMap, robot: Point3, points: &[Point3], tilt: f64) -> Option<Shift> {
    let prior = [EXPECTED[0], EXPECTED[1], EXPECTED[2], EXPECTED[3], tilt, tilt];
    let mut fit = SVector::<f64, 6>::zeros();
    for outlier in OUTLIERS {
        let mut normal = SMatrix::<f64, 6, 6>::zeros();
        let mut right = SVector::<f64, 6>::zeros();
        let mut count = 0;
        for point in points {
            let arm = point - robot;
            let moved = arm.xy() + Vector::new(-arm.y, arm.x) * fit[3];
            let at = robot.xy() + moved + Vector::new(fit[0], fit[1]);
            let Some((height, rise)) = map.surface(at) else { continue };
            let z = point.z + fit[2] + fit[4] * arm.x + fit[5] * arm.y;
            let error = height - z;
            let turn = rise.dot(&Vector::new(-arm.y, arm.x));
            // By how much the error falls for each part of the shift.
            let row = SVector::<f64, 6>::from([-rise.x, -rise.y, 1.0, -turn, arm.x, arm.y]);
            let weight = 1.0 / (outlier * outlier + error * error);
            normal += row * row.transpose() * weight;
            right += row * (error * weight);
            count += 1;
        }
        if count < ENOUGH {
            // So little of it has been seen before that it may lie anywhere.
            return Some(Shift::default());
        }
        for (index, expected) in prior.iter().enumerate() {
            // Neighbouring points err together.
            let weight = PRIOR / (expected * expected);
            normal[(index, index)] += weight;
            right[index] -= fit[index] * weight;
        }
        let Some(step) = normal.cholesky().map(|factors| factors.solve(&right)) else { break };
        fit += step;
    }
    let shift = Shift {
        place: Vector::new(fit[0], fit[1]),
        up: fit[2],
        turn: fit[3],
        tilt: Vector::new(fit[4], fit[5]),
    };
    (lies(map, robot, points, &shift) > MOST).then_some(shift)
}

/// The share of the points within the map that lie on it.
fn lies(map: &SightMap, robot: Point3, points: &[Point3], shift: &Shift) -> f64 {
    let (mut on, mut count) = (0_u32, 0_u32);
    for point in points {
        let arm = point - robot;
        let moved = arm.xy() + Vector::new(-arm.y, arm.x) * shift.turn;
        let Some((height, _)) = map.surface(robot.xy() + moved + shift.place) else { continue };
        let z = point.z + shift.up + shift.tilt.dot(&arm.xy());
        on += u32::from((height - z).abs() < 2.0 * OUTLIER);
        count += 1;
    }
    f64::from(on) / f64::from(count.max(1))
}

/// The share of points that lie on the map after a fit which is right.
const MOST: f64 = 0.7;
/// The number of neighbouring points that say no more than one of them.
const PRIOR: f64 = 20.0;
