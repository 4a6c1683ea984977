use super::error::LineError;
use super::grip::GripLimit;
use super::racing_line::curvature;
use super::tyres::Tyres;
use crate::ParameterError;
use crate::geometry::{Point, units};
use crate::parameter::{require, require_positive};
use crate::world::{DriveSpec, RobotSpec};

/// Limits of a car's tyres and motors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarLimits {
    /// Grip limit of the tyres.
    pub grip: GripLimit,
    /// Maximum acceleration of the motors (m/s²).
    pub drive: f64,
    /// Maximum deceleration of the brakes (m/s²).
    pub brake: f64,
    /// Maximum speed (m/s).
    pub top_speed: f64,
    /// Maximum rate of change of the curvature, given by the steering (1/m per second); infinity for no
    /// limit.
    pub turning: f64,
}

impl CarLimits {
    /// A car with a friction circle: equal grip in all directions (m/s²).
    pub const fn circle(grip: f64, drive: f64, brake: f64, top_speed: f64) -> Self {
        let grip = GripLimit::Ellipse { across: grip, turned: 0.0, along: grip };
        Self { grip, drive, brake, top_speed, turning: f64::INFINITY }
    }

    /// Steady-state limits of a car with [`CarDynamics`](crate::world::CarDynamics); `None` without them.
    ///
    /// ```
    /// use roverlab::{race::CarLimits, world::RobotSpec};
    /// let limits = CarLimits::of(&RobotSpec::race_car()).unwrap();
    /// assert_eq!((limits.top_speed, limits.brake), (30.0, 11.0));
    /// ```
    pub fn of(car: &RobotSpec) -> Option<Self> {
        let DriveSpec::Ackermann { wheelbase, max_steering, dynamics: Some(dynamics), .. } = car.drive else {
            return None;
        };
        let tyres = Tyres {
            grip: dynamics.grip,
            stiffness: dynamics.stiffness * units::GRAVITY,
            front: dynamics.balance,
            wheelbase,
            lock: max_steering,
        };
        Some(Self {
            grip: GripLimit::Balance(tyres),
            drive: car.motor.max_acceleration,
            brake: dynamics.brake,
            top_speed: car.drive.top_speed(),
            turning: f64::INFINITY,
        })
    }

    /// Checks the limits.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        self.grip.validate()?;
        require("turning", self.turning, self.turning > 0.0, "a positive number")?;
        require_positive("drive", self.drive)?;
        require_positive("brake", self.brake)?;
        require_positive("top speed", self.top_speed)
    }
}

/// Speeds along a line.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedProfile {
    /// Speed at each point (m/s).
    pub speeds: Vec<f64>,
    /// Curvature at each point, positive to the left (1/m).
    pub curvatures: Vec<f64>,
    /// Distance from each point to the next (m).
    pub lengths: Vec<f64>,
    /// Time for the whole line (s).
    pub lap_time: f64,
}

impl SpeedProfile {
    /// Quasi-steady-state optimum on a closed line: a point mass within the grip limit at each moment. The
    /// speeds of bends are limited forwards by the motors and backwards by the brakes. O(n).
    ///
    /// ```
    /// use roverlab::race::{CarLimits, SpeedProfile};
    /// use roverlab::geometry::{Point, direction};
    /// let limits = CarLimits::circle(10.0, 5.0, 8.0, 30.0);
    /// let circle: Vec<_> = (0..100).map(|i| Point::origin() + direction(f64::from(i) * 0.0628318) * 9.0).collect();
    /// let profile = SpeedProfile::closed(&circle, &limits)?;
    /// // The root of grip times radius.
    /// assert!((profile.speeds[50] - 90.0_f64.sqrt()).abs() < 0.01);
    /// # Ok::<(), roverlab::race::LineError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If there are fewer than four points, points coincide, or a limit is out of range.
    pub fn closed(points: &[Point], limits: &CarLimits) -> Result<Self, LineError> {
        let n = points.len();
        if n < 4 {
            return Err(LineError::TooFew { found: n, needed: 4 });
        }
        let curvatures: Vec<f64> =
            (0..n).map(|i| curvature([points[(i + n - 1) % n], points[i], points[(i + 1) % n]])).collect();
        Self::of(points, curvatures, limits, true)
    }

    /// The same for an open line, from a speed at the first point to at most another one at the last (m/s).
    ///
    /// # Errors
    ///
    /// As for [`closed`](Self::closed), but from three points on.
    pub fn open(points: &[Point], limits: &CarLimits, first: f64, last: f64) -> Result<Self, LineError> {
        let n = points.len();
        if n < 3 {
            return Err(LineError::TooFew { found: n, needed: 3 });
        }
        let curvatures: Vec<f64> = (0..n)
            .map(|i| {
                let middle = i.clamp(1, n - 2);
                curvature([points[middle - 1], points[middle], points[middle + 1]])
            })
            .collect();
        let mut profile = Self::of(points, curvatures, limits, false)?;
        profile.speeds[0] = profile.speeds[0].min(first.max(0.0));
        profile.speeds[n - 1] = profile.speeds[n - 1].min(last.max(0.0));
        profile.limit(limits, false);
        Ok(profile)
    }

    fn of(
        points: &[Point],
        curvatures: Vec<f64>,
        limits: &CarLimits,
        closed: bool,
    ) -> Result<Self, LineError> {
        limits.validate()?;
        let n = points.len();
        let lengths: Vec<f64> = (0..n).map(|i| (points[(i + 1) % n] - points[i]).norm()).collect();
        let lengths_used = if closed { &lengths[..] } else { &lengths[..n - 1] };
        if let Some(index) = lengths_used.iter().position(|&length| !(length > 1e-9 && length.is_finite())) {
            return Err(LineError::Degenerate { index });
        }
        let speed = |i: usize| {
            let around = if closed {
                [(i + n - 1) % n, (i + 1) % n]
            } else {
                [i.saturating_sub(1), (i + 1).min(n - 1)]
            };
            let change = (curvatures[around[1]] - curvatures[around[0]]).abs();
            let turns = limits.turning * (lengths[around[0]] + lengths[i]) / change.max(1e-9);
            let holds =
                (limits.grip.across(curvatures[i], limits.drive) / curvatures[i].abs().max(1e-9)).sqrt();
            holds.min(turns).min(limits.top_speed)
        };
        let speeds = (0..n).map(speed).collect();
        let mut profile = Self { speeds, curvatures, lengths, lap_time: 0.0 };
        profile.limit(limits, closed);
        Ok(profile)
    }

    fn limit(&mut self, limits: &CarLimits, closed: bool) {
        let n = self.speeds.len();
        let forwards = |bend, across| limits.grip.forwards(bend, across, limits.drive);
        let backwards = |bend, across| limits.grip.backwards(bend, across, limits.brake);
        // Twice around, so that the start is consistent with the end.
        let steps = if closed { 2 * n } else { n - 1 };
        for k in 0..steps {
            let i = k % n;
            self.pass(forwards, i, (i + 1) % n, i);
        }
        for k in 0..steps {
            let i = steps - 1 - k;
            self.pass(backwards, (i + 1) % n, i % n, i % n);
        }
        let count = if closed { n } else { n - 1 };
        self.lap_time = (0..count)
            .map(|i| 2.0 * self.lengths[i] / (self.speeds[i] + self.speeds[(i + 1) % n]).max(1e-6))
            .sum();
    }

    /// Longitudinal acceleration from a point to the next one (m/s²).
    pub(super) fn along(&self, from: usize, to: usize) -> f64 {
        let (before, after) = (self.speeds[from], self.speeds[to]);
        (after * after - before * before) / (2.0 * self.lengths[from].max(1e-9))
    }

    /// Limits the speed at `to` by the maximum acceleration from `from`, by Heun's method; `most` gives the
    /// acceleration for a curvature and a lateral acceleration.
    fn pass(&mut self, most: impl Fn(f64, f64) -> f64, from: usize, to: usize, length: usize) {
        let length = self.lengths[length];
        let bends = [from, to].map(|i| self.curvatures[i].abs());
        let squared = self.speeds[from] * self.speeds[from];
        let begin = most(bends[0], squared * bends[0]);
        let guess = (squared + 2.0 * length * begin).min(self.speeds[to] * self.speeds[to]);
        let end = most(bends[1], guess * bends[1]);
        let reached = (squared + length * (begin + end)).sqrt();
        self.speeds[to] = self.speeds[to].min(reached);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::direction;
    use crate::race::ClosedSpline;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    const LIMITS: CarLimits = CarLimits::circle(12.0, 6.0, 11.0, 25.0);

    fn ellipse(n: u32, a: f64, b: f64) -> Vec<Point> {
        (0..n)
            .map(|i| {
                let unit = direction(TAU * f64::from(i) / f64::from(n));
                Point::new(a * unit.x, b * unit.y)
            })
            .collect()
    }

    proptest! {
        #![proptest_config(crate::testing::cases(40))]
        #[test]
        fn the_tyres_hold_everywhere(a in 8.0..60.0f64, b in 8.0..60.0f64) {
            let points: Vec<Point> =
                ClosedSpline::through(&ellipse(80, a, b)).unwrap().resample(0.5).iter().map(|p| p.position).collect();
            let profile = SpeedProfile::closed(&points, &LIMITS).unwrap();
            let n = points.len();
            for i in 0..n {
                let (v, w) = (profile.speeds[i], profile.speeds[(i + 1) % n]);
                let along = (w * w - v * v) / (2.0 * profile.lengths[i]);
                let across = v * v * profile.curvatures[i];
                prop_assert!((-11.0 - 1e-6..=6.0 + 1e-6).contains(&along) && v <= 25.0);
                prop_assert!(crate::geometry::math::hypot(along, across) < 12.0 * 1.1, "{i}: {along} {across}");
            }
        }

        #[test]
        fn finer_steps_change_little(a in 8.0..60.0f64, b in 8.0..60.0f64) {
            let spline = ClosedSpline::through(&ellipse(80, a, b)).unwrap();
            let time = |step| {
                let points: Vec<Point> = spline.resample(step).iter().map(|p| p.position).collect();
                SpeedProfile::closed(&points, &LIMITS).unwrap().lap_time
            };
            prop_assert!((time(1.0) / time(0.05) - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn a_strip_from_standing_to_standing() {
        let strip: Vec<Point> = (0..=150).map(|i| Point::new(0.5 * f64::from(i), 0.0)).collect();
        let limits = CarLimits { top_speed: 100.0, ..LIMITS };
        let profile = SpeedProfile::open(&strip, &limits, 0.0, 0.0).unwrap();
        // Acceleration 6, deceleration 11 m/s²: v² (1/12 + 1/22) = 75.
        let top = (75.0_f64 / (1.0 / 12.0 + 1.0 / 22.0)).sqrt();
        let reached = profile.speeds.iter().copied().fold(0.0, f64::max);
        assert!((reached - top).abs() < 0.2 && profile.speeds[0] == 0.0 && profile.speeds[150] == 0.0);
        assert!((profile.lap_time - (top / 6.0 + top / 11.0)).abs() < 0.1);
    }

    #[test]
    fn tighter_circles_are_slower_in_the_balance() {
        use crate::race::{GripLimit, Tyres};
        let limits = CarLimits { grip: GripLimit::Balance(Tyres::default()), ..LIMITS };
        let speeds = [5.0, 9.0, 20.0, 40.0]
            .map(|radius| SpeedProfile::closed(&ellipse(120, radius, radius), &limits).unwrap().speeds[60]);
        assert!(speeds.windows(2).all(|pair| pair[0] < pair[1]), "{speeds:?}");
        // Less than with tyres without an axle that saturates first.
        assert!(speeds[1] < 0.96 * (12.0 * 9.0_f64).sqrt() && speeds[1] > 0.85 * (12.0 * 9.0_f64).sqrt());
    }

    #[test]
    fn the_steering_keeps_up_with_the_bends() {
        // A straight that abruptly becomes a circle.
        let mut points: Vec<Point> = (0..40).map(|i| Point::new(0.5 * f64::from(i), 0.0)).collect();
        let circle = (0..30).map(|i| direction(0.05 * f64::from(i) - TAU / 4.0) * 10.0);
        points.extend(circle.map(|arm| Point::new(20.0, 10.0) + arm));
        let limits = CarLimits { turning: 0.5, ..LIMITS };
        let [free, slow] =
            [LIMITS, limits].map(|limits| SpeedProfile::open(&points, &limits, 20.0, 20.0).unwrap());
        // The curvature becomes 0.1 within a metre.
        assert!(slow.speeds[39] < 6.5 && free.speeds[39] > 10.0, "{} {}", slow.speeds[39], free.speeds[39]);
        assert!((slow.speeds[65] / free.speeds[65] - 1.0).abs() < 0.02);
        let error = SpeedProfile::closed(&points, &CarLimits { turning: f64::NAN, ..LIMITS }).unwrap_err();
        assert_eq!(error.to_string(), "turning is NaN; expected a positive number");
    }

    #[test]
    fn what_is_no_car() {
        let points = ellipse(20, 9.0, 9.0);
        let limits = CarLimits::circle(f64::NAN, 6.0, 11.0, 25.0);
        let error = SpeedProfile::closed(&points, &limits).unwrap_err();
        assert_eq!(error.to_string(), "grip across is NaN; expected a positive, finite number");
    }
}
