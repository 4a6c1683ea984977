use std::ops::ControlFlow;

use super::follower::PATIENCE;
use crate::ParameterError;
use crate::geometry::{Point, Pose, Vector, angle_difference, direction, normalize_angle};
use crate::io::control::{Behaviour, Command, Decision, Senses, halts};
use crate::io::reading::check_pose;
use crate::io::{Error, Motors, Odometry, Result};
use crate::kinematics::{Omni, PlanarTwist};
use crate::parameter::{require_finite, require_positive};

/// Converts velocities of a robot on four wheels with rollers to motor commands (book, section 7.4: an
/// interface from driving angle to wheel speeds).
///
/// ```
/// use roverlab::drive::OmniDriver;
/// use roverlab::kinematics::{Omni, PlanarTwist};
/// let driver = OmniDriver::new(Omni::mecanum(0.2, 0.15)?, 0.5)?;
/// assert_eq!(driver.command(PlanarTwist::new(0.25, 0.0, 0.0)), [0.5; 4], "half of full speed");
/// let sideways = driver.command(PlanarTwist::new(0.0, 0.25, 0.0));
/// assert_eq!(sideways.iter().sum::<f64>(), 0.0, "two wheels each way");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OmniDriver {
    kinematics: Omni<4>,
    full_speed: f64,
}

impl OmniDriver {
    /// Creates a driver; `full_speed` is the rim speed of the wheels at full motor speed (m/s). Fails unless
    /// it is positive and finite.
    pub fn new(kinematics: Omni<4>, full_speed: f64) -> std::result::Result<Self, ParameterError> {
        require_positive("full speed", full_speed)?;
        Ok(Self { kinematics, full_speed })
    }

    /// Geometry of the drive.
    pub fn kinematics(&self) -> &Omni<4> {
        &self.kinematics
    }

    /// Fractions of the motors' full speed. A twist too fast for a motor is scaled down; its direction stays.
    pub fn command(&self, twist: PlanarTwist) -> [f64; 4] {
        let wheels = self.kinematics.inverse_limited(twist, self.full_speed);
        wheels.map(|speed| (speed / self.full_speed).clamp(-1.0, 1.0))
    }
}

/// Parameters of [`OmniTracker`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OmniParameters {
    /// Speed along the route (m/s).
    pub speed: f64,
    /// Acceleration and deceleration (m/s²).
    pub acceleration: f64,
    /// Rotation about the robot's own axis (rad/s); 0 keeps the heading.
    pub spin: f64,
    /// Position gain (1/s).
    pub position_gain: f64,
    /// Heading gain (1/s).
    pub heading_gain: f64,
    /// Delay of the motors (s), compensated by looking ahead.
    pub lag: f64,
    /// Position error allowed at the end of the route (m).
    pub tolerance: f64,
    /// Heading error allowed there (rad).
    pub heading_tolerance: f64,
    /// Control period (s).
    pub period: f64,
}

impl Default for OmniParameters {
    fn default() -> Self {
        Self {
            speed: 0.2,
            acceleration: 0.3,
            spin: 0.0,
            position_gain: 1.5,
            heading_gain: 1.5,
            lag: 0.2,
            tolerance: 0.001,
            heading_tolerance: 0.003,
            period: 0.02,
        }
    }
}

/// Reference pose and velocity at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OmniReference {
    /// Reference pose.
    pub pose: Pose,
    /// Reference velocity in world coordinates (m/s).
    pub velocity: Vector,
    /// Reference angular velocity (rad/s).
    pub angular: f64,
}

/// Drives a route of straight legs with an independent heading: round a square without turning, or spinning
/// on a straight line (book, section 7.4).
///
/// ```
/// use roverlab::drive::{OmniParameters, OmniTracker};
/// use roverlab::geometry::{Point, Pose};
/// let route = [Point::new(1.0, 0.0), Point::new(1.0, 1.0)];
/// let tracker = OmniTracker::new(Pose::default(), &route, OmniParameters::default())?;
/// let middle = tracker.reference(0.5 * tracker.duration());
/// assert!((middle.pose.position() - Point::new(1.0, 0.0)).norm() < 1e-9 && middle.pose.heading == 0.0);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct OmniTracker {
    start: Pose,
    legs: Vec<Leg>,
    parameters: OmniParameters,
}

/// A straight line from rest to rest.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Leg {
    from: Point,
    along: Vector,
    length: f64,
    begin: f64,
    /// Duration of the acceleration, and of the whole leg (s).
    ramp: f64,
    duration: f64,
}

impl OmniTracker {
    /// Creates a tracker that drives from `start` through the points of `route` and stops at each. Fails for
    /// parameters out of range and a route that is not finite.
    pub fn new(start: Pose, route: &[Point], parameters: OmniParameters) -> Result<Self> {
        for (name, value) in [
            ("speed", parameters.speed),
            ("acceleration", parameters.acceleration),
            ("position gain", parameters.position_gain),
            ("heading gain", parameters.heading_gain),
            ("lag", parameters.lag),
            ("tolerance", parameters.tolerance),
            ("heading tolerance", parameters.heading_tolerance),
            ("control period", parameters.period),
        ] {
            require_positive(name, value)?;
        }
        require_finite("spin", parameters.spin)?;
        if !start.is_finite()
            || !route.iter().all(|point| point.coords.iter().all(|metres| metres.is_finite()))
        {
            return Err(Error::invalid_input("route", "not finite", "finite numbers"));
        }
        let mut legs: Vec<Leg> = Vec::with_capacity(route.len());
        let (mut from, mut begin) = (start.position(), 0.0);
        for &to in route {
            let leg = Leg::new(from, to, begin, &parameters);
            (from, begin) = (to, begin + leg.duration);
            legs.push(leg);
        }
        Ok(Self { start, legs, parameters })
    }

    /// Duration of the route (s).
    pub fn duration(&self) -> f64 {
        self.legs.last().map_or(0.0, |leg| leg.begin + leg.duration)
    }

    /// Reference at a time since the start (s).
    pub fn reference(&self, time: f64) -> OmniReference {
        let end = self.duration();
        let time_on_way = time.clamp(0.0, end);
        let heading = normalize_angle(self.start.heading + self.parameters.spin * time_on_way);
        let angular = if time < 0.0 || time >= end { 0.0 } else { self.parameters.spin };
        let index = self.legs.partition_point(|leg| leg.begin + leg.duration < time_on_way);
        let Some(leg) = self.legs.get(index) else {
            return OmniReference { pose: self.start, velocity: Vector::zeros(), angular: 0.0 };
        };
        let (distance, speed) = leg.at(time_on_way - leg.begin, self.parameters.acceleration);
        let place = leg.from + leg.along * distance;
        OmniReference { pose: Pose::new(place.x, place.y, heading), velocity: leg.along * speed, angular }
    }

    /// The velocity for a robot at a pose and a time (s); `None` at the end of the route. Fails if either is
    /// not finite.
    pub fn step(&self, time: f64, pose: Pose) -> Result<Option<PlanarTwist>> {
        require_finite("time", time)?;
        check_pose(&pose)?;
        let now = self.reference(time);
        let away = now.pose.position() - pose.position();
        let turned = angle_difference(now.pose.heading, pose.heading);
        if time >= self.duration() && (self.is_there(time, pose) || time >= self.duration() + PATIENCE) {
            return Ok(None);
        }
        // The motors respond after the lag; by then the robot has turned on.
        let ahead = self.reference(time + self.parameters.lag);
        let heading = pose.heading + angle_difference(ahead.pose.heading, now.pose.heading);
        let velocity = ahead.velocity + away * self.parameters.position_gain;
        let (forward, left) = (direction(heading), direction(heading + std::f64::consts::FRAC_PI_2));
        let angular = ahead.angular + self.parameters.heading_gain * turned;
        Ok(Some(PlanarTwist::new(velocity.dot(&forward), velocity.dot(&left), angular)))
    }

    /// Whether the robot is within the tolerances.
    fn is_there(&self, time: f64, pose: Pose) -> bool {
        let now = self.reference(time).pose;
        now.distance_to(pose.position()) <= self.parameters.tolerance
            && angle_difference(now.heading, pose.heading).abs() <= self.parameters.heading_tolerance
    }

    /// The behaviour for a robot with this driver.
    pub fn by(&self, driver: OmniDriver) -> OmniPilot<'_> {
        OmniPilot { tracker: self, driver, begin: None }
    }
}

/// An [`OmniTracker`] bound to a robot's wheels, made by [`OmniTracker::by`].
///
/// ```
/// use std::ops::ControlFlow;
/// use roverlab::drive::{OmniDriver, OmniParameters, OmniPilot, OmniTracker};
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::io::control::Behaviour;
/// use roverlab::kinematics::Omni;
/// let driver = OmniDriver::new(Omni::mecanum(0.2, 0.15)?, 0.5)?;
/// let tracker = OmniTracker::new(Pose::default(), &[Point::new(0.0, 1.0)], OmniParameters::default())?;
/// let mut pilot: OmniPilot<'_> = tracker.by(driver);
/// pilot.step(0.0, &Pose::default())?;
/// let step = pilot.step(1.0, &Pose::new(0.0, 0.2, 0.0))?;
/// let ControlFlow::Continue(wheels) = step else { panic!("at the end") };
/// assert!(wheels.0.iter().any(|&w| w > 0.1) && wheels.0.iter().any(|&w| w < -0.1), "to the left");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct OmniPilot<'t> {
    tracker: &'t OmniTracker,
    driver: OmniDriver,
    /// Time of the first step (s).
    begin: Option<f64>,
}

/// Outcome of a drive along a route.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum OmniOutcome {
    /// The estimated pose is at the end of the route.
    Reached,
    /// The route's time is long over, and the robot is not at its end.
    Missed,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(OmniOutcome { Reached: "the end of the route is reached", Missed: "the end of the route is missed" });

impl Behaviour for OmniPilot<'_> {
    type Observation = Pose;
    type Command = WheelCommand;
    type Outcome = OmniOutcome;

    fn period(&self) -> f64 {
        self.tracker.parameters.period
    }

    fn step(&mut self, time: f64, pose: &Pose) -> Decision<Self> {
        let time = time - *self.begin.get_or_insert(time);
        Ok(match self.tracker.step(time, *pose)? {
            Some(twist) => ControlFlow::Continue(WheelCommand(self.driver.command(twist))),
            None if self.tracker.is_there(time, *pose) => ControlFlow::Break(OmniOutcome::Reached),
            None => ControlFlow::Break(OmniOutcome::Missed),
        })
    }
}

impl<R: Odometry + ?Sized> Senses<R> for OmniPilot<'_> {
    fn sense(&mut self, robot: &mut R, _time: f64, pose: &mut Pose) -> Result<()> {
        *pose = robot.pose()?;
        Ok(())
    }
}

/// Commands for motors 1 to 4, as fractions of full speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelCommand(pub [f64; 4]);

impl<R: Motors + ?Sized> Command<R> for WheelCommand {
    fn apply(&self, robot: &mut R) -> Result<()> {
        (1..).zip(self.0).try_for_each(|(motor, fraction)| robot.set_motor(motor, fraction))
    }

    fn stop(robot: &mut R) -> Result<()> {
        Self([0.0; 4]).apply(robot)
    }
}

impl Leg {
    fn new(from: Point, to: Point, begin: f64, parameters: &OmniParameters) -> Self {
        let way = to - from;
        let length = way.norm();
        let along = if length > 0.0 { way / length } else { Vector::zeros() };
        // A short leg is braked before it reaches full speed.
        let speed = parameters.speed.min((length * parameters.acceleration).sqrt());
        let ramp = speed / parameters.acceleration;
        let cruise = if speed > 0.0 { (length - speed * ramp) / speed } else { 0.0 };
        Self { from, along, length, begin, ramp, duration: 2.0 * ramp + cruise }
    }

    /// Distance travelled (m) and speed (m/s) at a time since the leg's start (s).
    fn at(&self, time: f64, acceleration: f64) -> (f64, f64) {
        let speed = acceleration * self.ramp;
        let rest = self.duration - time;
        if time < self.ramp {
            (0.5 * acceleration * time * time, acceleration * time)
        } else if rest < self.ramp {
            (self.length - 0.5 * acceleration * rest * rest, acceleration * rest)
        } else {
            (0.5 * speed * self.ramp + speed * (time - self.ramp), speed)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::advance_planar;
    use proptest::prelude::*;

    fn route() -> impl Strategy<Value = Vec<Point>> {
        prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64).prop_map(|(x, y)| Point::new(x, y)), 1..5)
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn references_move_as_they_say(route in route(), spin in -1.0..1.0f64, share in 0.01..0.99f64) {
            let parameters = OmniParameters { spin, ..OmniParameters::default() };
            let tracker = OmniTracker::new(Pose::new(0.1, 0.2, 0.3), &route, parameters).unwrap();
            let (time, h) = (share * tracker.duration(), 1e-5);
            let [before, now, after] = [time - h, time, time + h].map(|time| tracker.reference(time));
            let rate = (after.pose.position() - before.pose.position()) / (2.0 * h);
            prop_assert!((rate - now.velocity).norm() < 1e-4);
            prop_assert!(now.velocity.norm() <= parameters.speed + 1e-9);
            let end = tracker.reference(tracker.duration());
            prop_assert!((end.pose.position() - route[route.len() - 1]).norm() < 1e-9);
        }

        #[test]
        fn a_robot_that_does_as_told_gets_to_the_end(route in route(), spin in -1.0..1.0f64) {
            let parameters = OmniParameters { spin, lag: 0.001, ..OmniParameters::default() };
            let start = Pose::new(0.1, 0.2, 0.3);
            let tracker = OmniTracker::new(start, &route, parameters).unwrap();
            let (mut pose, mut time) = (start, 0.0);
            while let Some(twist) = tracker.step(time, pose).unwrap() {
                pose = advance_planar(pose, twist.during(0.01));
                time += 0.01;
                prop_assert!((pose.position() - tracker.reference(time).pose.position()).norm() < 0.01);
            }
            prop_assert!((pose.position() - route[route.len() - 1]).norm() <= parameters.tolerance);
        }
    }

    #[test]
    fn routes_that_make_no_sense_are_refused() {
        let start = Pose::default();
        assert!(OmniTracker::new(start, &[Point::new(f64::NAN, 0.0)], OmniParameters::default()).is_err());
        let parameters = OmniParameters { speed: -1.0, ..OmniParameters::default() };
        assert!(OmniTracker::new(start, &[], parameters).is_err());
        let tracker = OmniTracker::new(start, &[], OmniParameters::default()).unwrap();
        assert_eq!(tracker.step(0.0, start).unwrap(), None);
        assert!(tracker.step(0.0, Pose::new(f64::NAN, 0.0, 0.0)).is_err());
    }
}
