use super::lane_model::FARTHEST;
use super::profile::SpeedProfile;
use super::tyres::Tyres;
use crate::ParameterError;
use crate::geometry::{Point, Pose, Twist, angle_difference, cross, math, units};
use crate::parameter::{require, require_finite, require_positive, require_up_to};
use crate::world::CarDynamics;

/// Parameters of [`LineTracker`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineTrackerParameters {
    /// Distance from the rear axle to the point of the car that is kept on the line (m).
    pub ahead: f64,
    /// Distance over which an error decays at standstill (m).
    pub length: f64,
    /// Increase of that distance with the speed (s).
    pub length_by_speed: f64,
    /// Lag of the steering (s).
    pub steering_lag: f64,
    /// Lag of the speed (s).
    pub speed_lag: f64,
    /// Speed demand per remaining longitudinal acceleration of the tyres (s). The inverse gain of the car's
    /// own controller never spins a wheel; with twice that, a car that slides only slightly is not slowed
    /// down.
    pub speed_time: f64,
    /// Speed demand that compensates the drag of cornering tyres (s): the inverse of that gain.
    pub drag_time: f64,
    /// Tyre model for the response to steering at speed.
    pub tyres: Tyres,
    /// Gain of the yaw rate error: curvature per curvature.
    pub yaw: f64,
    /// Fraction of the predicted sideslip rotation that is steered in advance.
    pub swing: f64,
    /// Maximum commanded curvature (1/m).
    pub curvature: f64,
}

impl Default for LineTrackerParameters {
    fn default() -> Self {
        Self {
            ahead: 0.9,
            length: 1.7,
            length_by_speed: 0.16,
            steering_lag: 0.11,
            speed_lag: 0.12,
            speed_time: 0.16,
            drag_time: 0.083,
            tyres: Tyres::default(),
            yaw: 1.0,
            swing: 0.5,
            curvature: 0.42,
        }
    }
}

impl LineTrackerParameters {
    /// Parameters for a car whose tyres do not slip.
    pub fn rolling() -> Self {
        Self {
            length: 2.0,
            length_by_speed: 0.22,
            steering_lag: 0.1,
            speed_lag: 0.08,
            speed_time: 0.15,
            drag_time: 0.0,
            tyres: Tyres::ROLLING,
            yaw: 0.0,
            swing: 0.0,
            ..Self::default()
        }
    }
}

impl LineTrackerParameters {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require("ahead", self.ahead, self.ahead.abs() <= FARTHEST, "-1000 to 1000 m")?;
        require_up_to("length", self.length, FARTHEST)?;
        for (name, value) in [
            ("length by speed", self.length_by_speed),
            ("steering lag", self.steering_lag),
            ("speed lag", self.speed_lag),
            ("speed time", self.speed_time),
            ("drag time", self.drag_time),
            ("yaw", self.yaw),
            ("swing", self.swing),
        ] {
            require(name, value, (0.0..=FARTHEST).contains(&value), "0 to 1000")?;
        }
        require_positive("greatest curvature", self.curvature)?;
        self.tyres.validate().map_err(|error| error.of("tyres"))
    }
}

/// A line with its speed profile, and the car's position along it.
///
/// ```
/// use roverlab::geometry::{Point, Pose, Twist};
/// use roverlab::race::{CarLimits, LineTracker, LineTrackerParameters, SpeedProfile};
/// let line: Vec<Point> = (0..100).map(|k| Point::new(f64::from(k), 0.0)).collect();
/// let profile = SpeedProfile::open(&line, &CarLimits::circle(10.0, 5.0, 8.0, 30.0), 5.0, 5.0)?;
/// let mut tracker = LineTracker::new(line, profile, false, LineTrackerParameters::rolling())?;
/// let car = Pose::new(10.0, 0.5, 0.0);
/// let (twist, aside) = tracker.step(car, Twist::new(8.0, 0.0)).expect("the line goes on");
/// assert!((aside - 0.5).abs() < 1e-9 && twist.angular < 0.0, "half a metre to the left, so steer right");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct LineTracker {
    parameters: LineTrackerParameters,
    points: Vec<Point>,
    profile: SpeedProfile,
    closed: bool,
    nearest: usize,
    started: bool,
    /// Whether the car has reached the line. An open line may begin beside the car.
    reached: bool,
}

/// Distance from a line within which a car is on it (m).
const ON_LINE: f64 = 0.3;
/// Maximum error that counts, as a fraction of the distance over which errors decay: larger ones are
/// approached at 14 degrees.
const SLANTED: f64 = 0.4;
/// Metres per second at which a car feels its way where nothing is known, or comes to its line if it stands.
pub(super) const CRAWL: f64 = 1.0;
/// Maximum fraction of the grip used to return to a line. With all of it, a fast car whose line moves
/// sideways would steer until its tyres slip, and weave.
const BACK: f64 = 0.6;
/// Distance before and after a point over which the turn of the nose is measured (m).
const SWINGS: f64 = 1.0;

impl LineTracker {
    /// A line from points, with the profile of the same points.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range, there are fewer than two points, the profile has another number of
    /// speeds, curvatures or lengths, a length is not positive, or a number is not finite.
    pub fn new(
        points: Vec<Point>,
        profile: SpeedProfile,
        closed: bool,
        parameters: LineTrackerParameters,
    ) -> Result<Self, ParameterError> {
        parameters.validate()?;
        let SpeedProfile { speeds, curvatures, lengths, .. } = &profile;
        let found = points.len();
        let fits = [speeds, curvatures, lengths].iter().all(|values| values.len() == found);
        let expected = "2 or more, as many as the profile has";
        require("points of the line", found as f64, found >= 2 && fits, expected)?;
        for coordinate in points.iter().flat_map(|point| [point.x, point.y]) {
            require_finite("coordinate of the line", coordinate)?;
        }
        for (name, values) in [("speed on the line", speeds), ("curvature of the line", curvatures)] {
            values.iter().try_for_each(|value| require_finite(name, *value))?;
        }
        // An open line may end where it begins.
        let pieces = if closed { found } else { found - 1 };
        lengths[..pieces].iter().try_for_each(|length| require_positive("length of the line", *length))?;
        Ok(Self { parameters, points, profile, closed, nearest: 0, started: false, reached: !closed })
    }

    /// Replaces the line by another one with as many points, slightly displaced, and continues at the same
    /// point.
    pub(super) fn shift(&mut self, points: Vec<Point>, profile: SpeedProfile) {
        debug_assert_eq!(points.len(), self.points.len(), "the number of points must not change");
        (self.points, self.profile) = (points, profile);
    }

    /// Index of the point before the car.
    pub(super) fn passed(&self) -> usize {
        self.nearest
    }

    /// Whether the line is a loop.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Points of the line.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Speeds and curvatures at the points.
    pub fn profile(&self) -> &SpeedProfile {
        &self.profile
    }

    fn next(&self, i: usize) -> usize {
        let n = self.points.len();
        if self.closed { (i + 1) % n } else { (i + 1).min(n - 1) }
    }

    /// Velocity command that keeps a car on the line: the curvature ahead, plus feedback that reduces errors
    /// of position and heading within some metres, corrected for tyre slip. Also returns the lateral offset
    /// from the line, positive to its left (m).
    ///
    /// `None` beyond the end of an open line, and if the inputs are not finite or implausibly large, as from
    /// failed odometry.
    pub fn step(&mut self, rear: Pose, moving: Twist) -> Option<(Twist, f64)> {
        let is_car = |value: f64| value.abs() < units::FARTHEST;
        if ![rear.x, rear.y, rear.heading, moving.linear, moving.angular].into_iter().all(is_car) {
            return None;
        }
        let p = self.parameters;
        let speed = moving.linear;
        let place = rear.to_world(Point::new(p.ahead, 0.0));
        self.locate(place);
        let (i, j) = (self.nearest, self.next(self.nearest));
        if i == j {
            return None;
        }
        let chord = self.points[j] - self.points[i];
        let along = chord / chord.norm().max(1e-9);
        let share = ((place - self.points[i]).dot(&along) / chord.norm().max(1e-9)).clamp(0.0, 1.0);
        let aside = cross(along, place - self.points[i]);
        let curvature_here = self.at(&self.profile.curvatures, i, share, 0.0);
        // The rear axle curves as the point ahead of it did some time ago.
        let bent = self.at(&self.profile.curvatures, i, share, -p.ahead);
        // The chord's heading is that of its midpoint; the tracked point of the car does not move along the
        // car's axis.
        let heading = math::atan2(along.y, along.x) + curvature_here * (share - 0.5) * chord.norm();
        let slip = math::asin((p.ahead * bent).clamp(-0.9, 0.9));
        // With slip, the nose points into the bend.
        let push = self.profile.along(i, j);
        let inwards = p.tyres.slips(speed * speed * bent, push)[1];
        let turned = angle_difference(rear.heading, heading - slip + inwards);
        let beyond = speed.max(0.0) * p.steering_lag - p.ahead;
        let curvature = self.at(&self.profile.curvatures, i, share, beyond);
        let length = p.length + p.length_by_speed * speed.abs();
        let swing =
            if speed > CarDynamics::SLIPS { p.swing * self.swing(i, share, beyond, push) } else { 0.0 };
        // Without a bound, the car would drive straight across to a line far to the side.
        let most = (SLANTED * length).min(BACK * p.tyres.grip * length * length / (speed * speed));
        let back = aside.clamp(-most, most);
        let wanted = curvature + swing - back / (length * length) - 1.6 * math::sin(turned) / length;
        // The rear axle drives a tighter bend than the point ahead of it.
        let inside = (1.0 - (p.ahead * wanted) * (p.ahead * wanted)).max(0.5).sqrt();
        // Near the limit, tyres respond less to additional steering, also to that of the feedback.
        let tyres = p.tyres.steering(wanted, speed * speed * wanted, push) - wanted;
        // They also respond late: a car that does not turn yet is steered more.
        let late = if speed > CarDynamics::SLIPS { p.yaw * (wanted - moving.angular / speed) } else { 0.0 };
        let curvature = (wanted / inside + tyres + late).clamp(-p.curvature, p.curvature);
        let planned = self.at(&self.profile.speeds, i, share, (speed.max(0.0) + 0.5) * p.speed_lag);
        let most = self.left_along(wanted, moving) * p.speed_time;
        let planned = planned + p.drag_time * p.tyres.drag(curvature_here, speed * speed * curvature_here);
        self.reached |= aside.abs() < ON_LINE;
        // Beside its line, it gains no speed: there may be no room for that.
        let planned = if self.reached { planned } else { planned.min(speed.max(CRAWL)) };
        let speed = planned.min(speed.max(0.0) + most);
        Some((Twist::new(speed, speed * curvature), aside))
    }

    /// Longitudinal acceleration left by the tyres, besides the present and the desired lateral acceleration
    /// (m/s²). Motors take no more, so that a car can return to its line. Brakes may, because there is no
    /// other way to slow down.
    fn left_along(&self, wanted: f64, moving: Twist) -> f64 {
        let (tyres, speed) = (&self.parameters.tyres, moving.linear);
        if speed <= CarDynamics::SLIPS {
            return tyres.grip;
        }
        let across = (speed * moving.angular).abs().max(speed * speed * wanted.abs());
        tyres.left_along(wanted, across)
    }

    /// Slowest speed command that brakes no harder than the tyres allow besides the bend of a command (m/s).
    pub(super) fn slowest(&self, command: Twist, moving: Twist) -> f64 {
        let bend = command.angular / command.linear.max(1e-6);
        moving.linear - self.left_along(bend, moving) * self.parameters.speed_time
    }

    /// Planned speed at the point of the line nearest to a place (m/s).
    pub(super) fn speed_at(&self, place: Point) -> f64 {
        let squared = |i: &usize| (self.points[*i] - place).norm_squared();
        let nearest = (0..self.points.len()).min_by(|a, b| squared(a).total_cmp(&squared(b)));
        nearest.map_or(0.0, |nearest| self.profile.speeds[nearest])
    }

    /// Additional yaw rotation along the line (1/m): with increasing slip, the nose turns into the bend.
    fn swing(&self, piece: usize, share: f64, beyond: f64, push: f64) -> f64 {
        let inwards = |beyond: f64| {
            let [bend, speed] = [&self.profile.curvatures, &self.profile.speeds]
                .map(|values| self.at(values, piece, share, beyond));
            self.parameters.tyres.slips(speed * speed * bend, push)[1]
        };
        (inwards(beyond + SWINGS) - inwards(beyond - SWINGS)) / (2.0 * SWINGS)
    }

    /// Distance along the line from the car to an object within `aside` metres of the line; `None` if there
    /// is none within `farthest` metres.
    pub fn distance_to(&self, thing: Point, aside: f64, farthest: f64) -> Option<f64> {
        let (mut i, mut passed) = (self.nearest, 0.0);
        // After a lap, all points have been compared.
        for _ in 0..self.points.len() {
            if passed >= farthest || farthest.is_nan() {
                return None;
            }
            if (self.points[i] - thing).norm_squared() < aside * aside {
                return Some(passed);
            }
            let next = self.next(i);
            if next == i {
                return None;
            }
            passed += self.profile.lengths[i];
            i = next;
        }
        None
    }

    /// Advances to the point of the line before the car, near the previous one.
    fn locate(&mut self, place: Point) {
        let n = self.points.len();
        let squared = |i: usize| (self.points[i] - place).norm_squared();
        if !self.started {
            self.started = true;
            self.nearest = (0..n).min_by(|&a, &b| squared(a).total_cmp(&squared(b))).unwrap_or(0);
        }
        for _ in 0..n {
            let (i, j) = (self.nearest, self.next(self.nearest));
            let chord = self.points[j] - self.points[i];
            if i == j || (place - self.points[j]).dot(&chord) < 0.0 {
                break;
            }
            self.nearest = j;
        }
    }

    fn previous(&self, i: usize) -> usize {
        let n = self.points.len();
        if self.closed { (i + n - 1) % n } else { i.saturating_sub(1) }
    }

    /// A value along the line, at a distance (m, may be negative) from a fraction of a piece; at most a lap
    /// away, so that short pieces and a fast car take no longer.
    fn at(&self, values: &[f64], piece: usize, share: f64, beyond: f64) -> f64 {
        let (mut i, mut left) = (piece, beyond + share * self.profile.lengths[piece]);
        for _ in 0..self.points.len() {
            if left >= 0.0 {
                break;
            }
            let before = self.previous(i);
            if before == i {
                return values[i];
            }
            i = before;
            left += self.profile.lengths[i];
        }
        for _ in 0..self.points.len() {
            if left <= self.profile.lengths[i] {
                break;
            }
            left -= self.profile.lengths[i];
            let next = self.next(i);
            if next == i || (!self.closed && self.next(next) == next) {
                return values[next];
            }
            i = next;
        }
        let share = (left / self.profile.lengths[i]).clamp(0.0, 1.0);
        values[i] + (values[self.next(i)] - values[i]) * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::race::CarLimits;

    #[test]
    fn what_is_no_number_leads_nowhere() {
        let points: Vec<Point> = (0..40).map(|k| Point::new(0.5 * f64::from(k), 0.0)).collect();
        let limits = CarLimits::circle(5.0, 3.0, 5.0, 10.0);
        let profile = SpeedProfile::open(&points, &limits, 5.0, 2.0).unwrap();
        let mut tracker = LineTracker::new(points, profile, false, LineTrackerParameters::rolling()).unwrap();
        for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
            assert_eq!(tracker.step(Pose::new(1.0, wrong, 0.0), Twist::new(3.0, 0.0)), None);
            assert_eq!(tracker.step(Pose::new(1.0, 0.0, 0.0), Twist::new(wrong, 0.0)), None);
        }
        assert!(tracker.step(Pose::new(1.0, 0.0, 0.0), Twist::new(3.0, 0.0)).is_some());
    }

    #[test]
    fn a_profile_of_other_points_is_refused() {
        let points: Vec<Point> =
            (0..12).map(|k| Point::origin() + crate::geometry::direction(0.5 * f64::from(k)) * 5.0).collect();
        let profile = SpeedProfile::closed(&points, &CarLimits::circle(5.0, 3.0, 5.0, 10.0)).unwrap();
        let error = |change: &dyn Fn(&mut SpeedProfile)| {
            let mut profile = profile.clone();
            change(&mut profile);
            LineTracker::new(points.clone(), profile, true, LineTrackerParameters::rolling()).err()
        };
        assert_eq!(error(&|_| ()), None);
        let name = |change: &dyn Fn(&mut SpeedProfile)| error(change).unwrap().name().to_owned();
        assert_eq!(name(&|profile| profile.lengths.clear()), "points of the line");
        assert_eq!(name(&|profile| profile.lengths[3] = 0.0), "length of the line");
        assert_eq!(name(&|profile| profile.curvatures[3] = f64::NAN), "curvature of the line");
    }

    #[test]
    fn a_look_ahead_ends_after_a_lap() {
        let points: Vec<Point> =
            (0..12).map(|k| Point::origin() + crate::geometry::direction(0.5 * f64::from(k)) * 5.0).collect();
        let mut profile = SpeedProfile::closed(&points, &CarLimits::circle(5.0, 3.0, 5.0, 10.0)).unwrap();
        profile.lengths.fill(1e-300);
        let mut tracker = LineTracker::new(points, profile, true, LineTrackerParameters::rolling()).unwrap();
        assert_eq!(tracker.distance_to(Point::new(100.0, 0.0), 1.0, 1e300), None);
        assert!(tracker.step(Pose::new(5.0, 0.0, 1.6), Twist::new(5.0, 0.0)).is_some());
    }

    #[test]
    fn a_line_far_beside_is_come_to_at_a_slant() {
        let points: Vec<Point> = (0..400).map(|k| Point::new(0.5 * f64::from(k), 0.0)).collect();
        let limits = CarLimits::circle(5.0, 3.0, 5.0, 10.0);
        let profile = SpeedProfile::open(&points, &limits, 10.0, 2.0).unwrap();
        let mut tracker = LineTracker::new(points, profile, false, LineTrackerParameters::rolling()).unwrap();
        let (mut rear, mut moving) = (Pose::new(0.0, 5.0, 0.0), Twist::new(8.0, 0.0));
        let mut steepest = 0.0_f64;
        while rear.x < 100.0 {
            (moving, _) = tracker.step(rear, moving).unwrap();
            rear = rear.compose(&Pose::new(0.02 * moving.linear, 0.0, 0.02 * moving.angular));
            steepest = steepest.max(rear.heading.abs());
        }
        assert!(steepest < 0.3 && rear.y.abs() < 0.05, "{steepest} {rear:?}");
    }
}
