use nalgebra::{SMatrix, SVector};

use super::relief::{Plane, Relief};
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
    /// Standard deviation of the place along the axis of which the ground tells least (m). It is no less than
    /// that with which the robot knew its place when it saw that ground.
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
    let relief = Relief::of(map);
    let along = ALONG.max(doubt);
    let prior = [along, along, UPWARDS, ABOUT, tilt, tilt];
    let fits = SLIPPED.iter().filter_map(|slipped| {
        let shift = fit(&relief, robot, points, &prior, (before - robot) * *slipped)?;
        Some((lies(&relief, robot, points, &shift) - UNLIKELY * slipped, shift))
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
fn fit(
    relief: &Relief<'_>,
    robot: Point3,
    points: &[Point3],
    prior: &[f64; 6],
    guess: Vector3,
) -> Option<Shift> {
    let guess = Six::from([guess.x, guess.y, guess.z, 0.0, 0.0, 0.0]);
    let (mut fit, mut doubt) = (guess, f64::INFINITY);
    for outlier in OUTLIERS {
        let equations = Equations::of(relief, robot, points, &fit, outlier)?.expecting(prior, fit - guess);
        let Some(factors) = equations.normal.cholesky() else { break };
        fit += factors.solve(&equations.right);
        doubt = equations.doubt().map_or(prior[0], |doubt| doubt.min(prior[0]));
    }
    Some(Shift {
        place: Vector::new(fit[0], fit[1]),
        up: fit[2],
        turn: fit[3],
        tilt: Vector::new(fit[4], fit[5]),
        doubt,
    })
}

/// The parts of a [`Shift`] in their order.
type Six = SVector<f64, 6>;

/// Weighted least squares of how much heights are off.
#[derive(Default)]
struct Equations {
    normal: SMatrix<f64, 6, 6>,
    right: Six,
    /// The part of the normal matrix that is due to the map's noise.
    noise: SMatrix<f64, 6, 6>,
    /// Sum of the weights, and of those times the squared doubt of the ground.
    weight: f64,
    doubt: f64,
}

impl Equations {
    /// Those of points after a shift; `None` if too few of them are within the map. A point counts half at
    /// so many metres from the map.
    fn of(relief: &Relief<'_>, robot: Point3, points: &[Point3], shift: &Six, outlier: f64) -> Option<Self> {
        let mut equations = Self::default();
        let mut count = 0;
        for point in points {
            let arm = point - robot;
            let moved = arm.xy() + Vector::new(-arm.y, arm.x) * shift[3];
            let at = robot.xy() + moved + Vector::new(shift[0], shift[1]);
            let Some(ground) = relief.at(at) else { continue };
            let z = point.z + shift[2] + shift[4] * arm.x + shift[5] * arm.y;
            equations.add(arm, &ground, ground.height(at) - z, outlier);
            count += 1;
        }
        (count >= ENOUGH).then_some(equations)
    }

    fn add(&mut self, arm: Vector3, ground: &Plane, error: f64, outlier: f64) {
        let Plane { rise, noise, doubt, .. } = *ground;
        let turn = rise.dot(&Vector::new(-arm.y, arm.x));
        // By how much the error falls for each part of the shift.
        let row = Six::from([-rise.x, -rise.y, 1.0, -turn, arm.x, arm.y]);
        let weight = 1.0 / (outlier * outlier + error * error);
        self.normal += row * row.transpose() * weight;
        self.right += row * (error * weight);
        for part in [[1.0, 0.0, -arm.y], [0.0, 1.0, arm.x]] {
            let row = Six::from([part[0], part[1], 0.0, part[2], 0.0, 0.0]);
            self.noise += row * row.transpose() * (weight * noise);
        }
        self.weight += weight;
        self.doubt += weight * doubt * doubt;
    }

    /// Adds how large the parts of the shift are expected to be, as standard deviations, beside how large
    /// they are.
    fn expecting(mut self, prior: &[f64; 6], shift: Six) -> Self {
        for (index, expected) in prior.iter().enumerate() {
            // Neighbouring points err together.
            let weight = PRIOR / (expected * expected);
            self.normal[(index, index)] += weight;
            self.right[index] -= shift[index] * weight;
        }
        self
    }

    /// Standard deviation of the place along the axis of which the ground tells least (m). The map's noise
    /// looks like slopes by which the robot could tell its place: `None` if there are no more than that.
    fn doubt(&self) -> Option<f64> {
        let covariance = (self.normal - self.noise).cholesky()?.inverse() * PRIOR;
        let variance = covariance.fixed_view::<2, 2>(0, 0).symmetric_eigenvalues().max();
        Some((variance + self.doubt / self.weight).sqrt())
    }
}

/// The share of the ground within the map that lies on it.
fn lies(relief: &Relief<'_>, robot: Point3, points: &[Point3], shift: &Shift) -> f64 {
    let (mut on, mut all) = (0.0, 0.0);
    for point in points {
        let arm = point - robot;
        let moved = arm.xy() + Vector::new(-arm.y, arm.x) * shift.turn;
        let at = robot.xy() + moved + shift.place;
        let Some(ground) = relief.at(at) else { continue };
        let z = point.z + shift.up + shift.tilt.dot(&arm.xy());
        // Points are the farther apart the farther they are away.
        let share = arm.xy().norm();
        all += share;
        if (ground.height(at) - z).abs() < 2.0 * OUTLIER {
            on += share;
        }
    }
    on / f64::max(all, f64::MIN_POSITIVE)
}

/// The share of the ground that lies on the map after a fit which is right.
const MOST: f64 = 0.7;
/// The number of neighbouring points that say no more than one of them.
const PRIOR: f64 = 20.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::math;
    use crate::nav::SummitParameters;
    use crate::random::Stream;
    use crate::world::RobotSpec;

    /// How well a robot knows its place after a look at ground that it has mapped with some noise, where it
    /// knew its place to within `mapped`, and now to within 0.3 m.
    fn doubt(ground: impl Fn(f64, f64) -> f64, mapped: f64) -> f64 {
        let parameters =
            SummitParameters { extent: 1.5, ..SummitParameters::of(&RobotSpec::blizzard()).unwrap() };
        let mut map = SightMap::new(&parameters, 0.35);
        let mut stream = Stream::new(1);
        let mut points = Vec::new();
        for look in 0..2 {
            for _ in 0..20_000 {
                let [x, y] = [0, 1].map(|_| stream.between(-1.2, 1.2));
                let seen = Point3::new(x, y, ground(x, y) + stream.between(-0.02, 0.02));
                if look == 0 {
                    map.stand(seen, mapped);
                } else {
                    points.push(seen);
                }
            }
        }
        let robot = Point3::new(0.0, 0.0, ground(0.0, 0.0));
        align(&map, robot, robot, &points, 0.01, 0.3).unwrap().doubt
    }

    /// Noise of a map is nothing to tell a place by.
    #[test]
    fn a_plane_does_not_tell_the_place() {
        for slope in [0.0, 0.15, 0.3] {
            let doubt = doubt(|x, _| slope * x, 0.0);
            assert!(doubt > 0.2, "{slope}: {doubt}");
        }
    }

    #[test]
    fn hills_tell_the_place() {
        let hills = |x: f64, y: f64| 0.1 * math::sin(3.0 * x) * math::cos(2.0 * y);
        let found = doubt(hills, 0.0);
        assert!(found < 0.03, "{found}");
    }

    /// A place is known no better than that from which the ground was mapped.
    #[test]
    fn doubt_of_the_ground_stays() {
        let hills = |x: f64, y: f64| 0.1 * math::sin(3.0 * x) * math::cos(2.0 * y);
        let found = doubt(hills, 0.2);
        assert!((0.2..0.22).contains(&found), "{found}");
    }
}
