use nalgebra::{SMatrix, SVector};

use super::sight_map::SightMap;
use crate::geometry::{Point3, Vector, Vector3};

/// How a look has to be moved to lie on the map: along both axes, upwards, about the upright axis, and by how
/// much it rises in a metre along both axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Shift {
    pub(super) place: Vector,
    pub(super) up: f64,
    pub(super) turn: f64,
    pub(super) tilt: Vector,
    /// Standard deviation of the place along the axis of which the ground tells least (m).
    pub(super) doubt: f64,
}

/// Metres from the map at which a point counts half, by rounds of the fit: many count at first, so that a
/// look finds its place from afar.
const OUTLIERS: [f64; 14] =
    [0.15, 0.15, 0.1, 0.1, 0.06, 0.06, 0.04, 0.04, OUTLIER, OUTLIER, OUTLIER, OUTLIER, OUTLIER, OUTLIER];
/// Distance at which a point counts half in the last rounds, which find the exact place (m).
const OUTLIER: f64 = 0.02;
/// The fewest points that count.
const ENOUGH: usize = 100;
/// How far dead reckoning is off at least, as a standard deviation (m): a cell of the map.
const ALONG: f64 = 0.05;
/// How far it may be off upwards (m).
const UPWARDS: f64 = 0.1;
/// How far it may be off about the upright axis (rad): the unit's error.
const ABOUT: f64 = 0.01;
/// Shares of its way since the last look by which a robot may have slipped back, the likeliest first.
const SLIPPED: [f64; 6] = [0.0, 0.25, 0.5, 0.75, 1.0, 1.25];
/// By how much more of the ground has to lie on the map for all of its way to be believed to be slip.
const UNLIKELY: f64 = 0.05;

/// Fits points around a robot to the map. `before` is where it looked last: belts may slip on the way from
/// there. `tilt` is by how much the look may be tilted, in radians, and `doubt` by how much the robot may be
/// elsewhere, in metres. `None` if they do not lie on the map.
pub(super) fn align(
    map: &SightMap,
    robot: Point3,
    before: Point3,
    points: &[Point3],
    tilt: f64,
    doubt: f64,
) -> Option<Shift> {
    let along = ALONG.max(doubt);
    let prior = [along, along, UPWARDS, ABOUT, tilt, tilt];
    let fits = SLIPPED.iter().filter_map(|slipped| {
        let shift = fit(map, robot, points, &prior, (before - robot) * *slipped)?;
        Some((lies(map, robot, points, &shift) - UNLIKELY * slipped, shift))
    });
    let mut fits = fits.peekable();
    if fits.peek().is_none() {
        // So little of it has been seen before that it may lie anywhere.
        return Some(Shift { doubt: f64::INFINITY, ..Shift::default() });
    }
    fits.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(share, _)| *share > MOST).map(|(_, shift)| shift)
}

/// The least squares of the heights, with little weight for outliers, from a first guess on. `None` if too
/// few of the points are within the map.
fn fit(map: &SightMap, robot: Point3, points: &[Point3], prior: &[f64; 6], guess: Vector3) -> Option<Shift> {
    let guess = SVector::<f64, 6>::from([guess.x, guess.y, guess.z, 0.0, 0.0, 0.0]);
    let mut fit = guess;
    let mut doubt = f64::INFINITY;
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
            return None;
        }
        for (index, expected) in prior.iter().enumerate() {
            // Neighbouring points err together.
            let weight = PRIOR / (expected * expected);
            normal[(index, index)] += weight;
            right[index] -= (fit[index] - guess[index]) * weight;
        }
        let Some(factors) = normal.cholesky() else { break };
        fit += factors.solve(&right);
        let covariance = factors.inverse() * PRIOR;
        doubt = covariance.fixed_view::<2, 2>(0, 0).symmetric_eigenvalues().max().sqrt();
    }
    Some(Shift {
        place: Vector::new(fit[0], fit[1]),
        up: fit[2],
        turn: fit[3],
        tilt: Vector::new(fit[4], fit[5]),
        doubt,
    })
}

/// The share of the ground within the map that lies on it.
fn lies(map: &SightMap, robot: Point3, points: &[Point3], shift: &Shift) -> f64 {
    let (mut on, mut all) = (0.0, 0.0);
    for point in points {
        let arm = point - robot;
        let moved = arm.xy() + Vector::new(-arm.y, arm.x) * shift.turn;
        let Some((height, _)) = map.surface(robot.xy() + moved + shift.place) else { continue };
        let z = point.z + shift.up + shift.tilt.dot(&arm.xy());
        // Points are the farther apart the farther they are away.
        let share = arm.xy().norm();
        all += share;
        if (height - z).abs() < 2.0 * OUTLIER {
            on += share;
        }
    }
    on / f64::max(all, f64::MIN_POSITIVE)
}

/// The share of the ground that lies on the map after a fit which is right.
const MOST: f64 = 0.7;
/// The number of neighbouring points that say no more than one of them.
const PRIOR: f64 = 20.0;
