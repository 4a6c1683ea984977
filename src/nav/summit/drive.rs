use std::f64::consts::FRAC_PI_2;

use super::parameters::{CAUTION, SummitParameters};
use super::reckoning::Reckoning;
use super::sight_map::SightMap;
use crate::geometry::{Point, Pose, Twist, direction, math, normalize_angle, way_length};
use crate::world::BitGrid;

/// A way that a [`SummitSearch`](super::SummitSearch) drives.
#[derive(Debug, Clone)]
pub(super) struct Drive {
    way: Vec<Point>,
    /// Whether it leads back, so that the robot need not turn round: belts slide in turns.
    backwards: bool,
    /// The point that was passed last.
    passed: usize,
    /// The least distance to the end so far, and since when.
    nearest: (f64, f64),
    /// Where it could not turn, and 1 forwards, -1 backwards, while it drives straight on from there.
    freeing: Option<(Point, f64)>,
    /// Where the robot can drive for all that it knows.
    safe: BitGrid,
    /// How well it knew its place when it set off (m).
    doubt: f64,
}

/// What comes of a step on a way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step {
    /// On, at a speed.
    Go(Twist),
    /// It is at the end.
    Arrived,
    /// It could not turn at a place, and has driven straight on from there.
    Freed {
        /// The place.
        from: Point,
    },
    /// It does not get on, or the ground is too steep.
    NoWay {
        /// The place that it does not get to.
        ahead: Point,
        /// 1 forwards, -1 backwards.
        sign: f64,
    },
}

/// Metres ahead on its way that the robot steers to.
const AHEAD: f64 = 0.18;
/// Metres to the end of a way at which it has arrived.
pub(super) const ARRIVED: f64 = 0.04;
/// Radians beyond which it turns on the spot.
const ASIDE: f64 = 0.9;
/// Seconds without getting nearer after which it does not get on.
const PATIENCE: f64 = 8.0;
/// Growth of the doubt about its place at which it looks around again (m).
const MOST_DOUBT: f64 = 0.15;
/// Radians above the slope limit at which it backs off.
const TOO_STEEP: f64 = 0.1;

impl Drive {
    pub(super) fn along(way: &[Point], safe: BitGrid, reckoning: &Reckoning, time: f64) -> Self {
        let pose = reckoning.pose;
        let ahead = way.iter().find(|point| pose.distance_to(**point) > AHEAD).or(way.last());
        let bearing = ahead.map_or(0.0, |&point| pose.bearing_to(point));
        Self {
            way: way.to_vec(),
            backwards: bearing.abs() > FRAC_PI_2,
            passed: 0,
            nearest: (f64::INFINITY, time),
            freeing: None,
            safe,
            doubt: reckoning.doubt,
        }
    }

    pub(super) fn way(&self) -> &[Point] {
        &self.way
    }

    /// The next speed for a pose, and the angle by which the robot is tilted.
    pub(super) fn step(
        &mut self,
        time: f64,
        reckoning: &Reckoning,
        tilt: f64,
        parameters: &SummitParameters,
        map: &SightMap,
    ) -> Step {
        let pose = reckoning.pose;
        let SummitParameters { speed, turn_rate, climber, .. } = *parameters;
        let Some(&end) = self.way.last() else { return Step::Arrived };
        let rest = pose.distance_to(end);
        if rest < ARRIVED {
            return Step::Arrived;
        }
        if rest < self.nearest.0 - 0.02 {
            self.nearest = (rest, time);
        }
        if self.is_in_doubt(reckoning, parameters) {
            return Step::Arrived;
        }
        let sign = if self.backwards { -1.0 } else { 1.0 };
        let lost = time - self.nearest.1 > PATIENCE + 4.0 * way_length(&self.way) / speed;
        if tilt > climber.slope + TOO_STEEP || lost {
            return Step::NoWay { ahead: ahead_of(pose, sign), sign };
        }
        if reckoning.is_locked() {
            let (from, sign) = self.freeing.unwrap_or_else(|| (pose.position(), along_way(&self.way, pose)));
            let is_safe = |sign: f64| {
                let cell = map.cell_at(ahead_of(pose, sign));
                cell.is_some_and(|cell| self.safe.is_free(cell))
            };
            let sign = if !is_safe(sign) && is_safe(-sign) { -sign } else { sign };
            self.freeing = Some((from, sign));
            return Step::Go(Twist::new(sign * speed, 0.0));
        }
        if let Some((from, _)) = self.freeing {
            return Step::Freed { from };
        }
        while self.passed + 1 < self.way.len() && pose.distance_to(self.way[self.passed]) < AHEAD {
            self.passed += 1;
        }
        let aside = pose.bearing_to(self.way[self.passed]);
        let bearing = if self.backwards { normalize_angle(aside + std::f64::consts::PI) } else { aside };
        // Beside the end it would turn round to it, and slide downhill.
        let is_past = self.passed + 1 == self.way.len() && bearing.abs() > FRAC_PI_2;
        if is_past && rest < AHEAD {
            return Step::Arrived;
        }
        let turn = (2.0 * bearing).clamp(-turn_rate, turn_rate);
        let fast = speed.min(0.03 + 0.8 * rest);
        let ahead = if bearing.abs() > ASIDE { 0.0 } else { sign * fast * math::cos(bearing) };
        Step::Go(Twist::new(ahead, turn))
    }

    /// Whether it has to look where it is: belts may have slipped far, or towards the fence by more than it
    /// keeps away from that in any case.
    fn is_in_doubt(&self, reckoning: &Reckoning, parameters: &SummitParameters) -> bool {
        let holds = |doubt: f64| parameters.holds(reckoning.pose.position(), doubt);
        let grown = reckoning.doubt - self.doubt;
        grown > MOST_DOUBT || grown > CAUTION && holds(self.doubt) && !holds(reckoning.doubt)
    }
}

/// The place that the robot comes to next, forwards (1) or backwards (-1).
fn ahead_of(pose: Pose, sign: f64) -> Point {
    pose.position() + direction(pose.heading) * (sign * AHEAD)
}

/// 1 if the way is nearer ahead of the robot than behind it, or else -1.
fn along_way(way: &[Point], pose: Pose) -> f64 {
    let away = |sign: f64| {
        let place = ahead_of(pose, sign);
        way.iter().map(|point| (point - place).norm_squared()).fold(f64::INFINITY, f64::min)
    };
    if away(1.0) <= away(-1.0) { 1.0 } else { -1.0 }
}

/// The beginning of a way.
pub(super) fn cut(way: &[Point], most: f64) -> &[Point] {
    let mut left = most;
    let steps = way.windows(2).take_while(|pair| {
        left -= (pair[1] - pair[0]).norm();
        left > 0.0
    });
    let points = steps.count() + 1;
    &way[..points.min(way.len())]
}
