use std::ops::ControlFlow;

use super::slope_sensor::{SlopeSensor, slope, steepness};
use crate::ParameterError;
use crate::geometry::{Point3, Pose, Twist, Vector, direction, math};
use crate::io::control::{Behaviour, Decision, SensedBy, Senses, halts};
use crate::io::reading::{check_attitude, check_pose};
use crate::io::{Attitude, DistanceSensors, Inertial, Lidar, Odometry, Result};
use crate::parameter::{require, require_positive};
use crate::world::RobotSpec;

/// Parameters of [`Ascent`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AscentParameters {
    /// Maximum tilt of the robot (rad).
    pub slope: f64,
    /// Driving speed (m/s).
    pub speed: f64,
    /// Maximum turn rate (rad/s).
    pub turn_rate: f64,
    /// Weight of a new reading in the smoothed slope, from 0 to 1.
    pub smoothing: f64,
    /// Time without a gain in height after which the ascent ends (s).
    pub patience: f64,
    /// Height that counts as a gain (m).
    pub gain: f64,
    /// Control period (s).
    pub period: f64,
}

impl AscentParameters {
    /// Parameters for a robot, with two thirds of the slope on which it would slip as the maximum tilt.
    pub fn of(spec: &RobotSpec) -> Self {
        Self {
            slope: 0.67 * math::atan(spec.friction),
            speed: 0.12_f64.min(0.5 * spec.drive.top_speed()),
            turn_rate: 0.8,
            smoothing: 0.2,
            patience: 8.0,
            gain: 0.004,
            period: 0.1,
        }
    }

    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        let steep = self.slope > 0.0 && self.slope < std::f64::consts::FRAC_PI_2;
        require("slope", self.slope, steep, "more than 0 and less than a right angle")?;
        require_positive("speed", self.speed)?;
        require_positive("turn rate", self.turn_rate)?;
        let share = self.smoothing > 0.0 && self.smoothing <= 1.0;
        require("smoothing", self.smoothing, share, "more than 0 and at most 1")?;
        require_positive("patience", self.patience)?;
        require_positive("gain", self.gain)?;
        require_positive("control period", self.period)
    }
}

/// Climbs by steepest ascent: turns to where the ground rises most, and drives until the robot gains no more
/// height (book, section 7.4).
///
/// It ends on a local maximum, which is seldom the highest; `nav::SummitSearch` leaves local maxima.
///
/// ```
/// use roverlab::drive::terrain::{Ascent, AscentOutcome, AscentParameters, SlopeSensor};
/// use roverlab::geometry::{Aabb, Point, Pose};
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::world::{HeightField, RobotSpec, Scene, Terrain, World};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let area = Aabb::new(Point::origin(), Point::new(3.0, 3.0));
/// let hill = HeightField::from_fn(61, 61, area, |at| 0.3 * (-(at - Point::new(1.8, 1.6)).norm_squared()).exp())?;
/// let world = World { terrain: Some(Terrain::new("hill.png", hill)), ..World::empty(3.0, 3.0) };
/// let spec = SlopeSensor::equip(RobotSpec::blizzard());
/// let mut ascent = Ascent::new(SlopeSensor::psds(&spec).unwrap(), AscentParameters::of(&spec))?;
/// let simulation = Simulation::new(&Scene::with_robot(world, spec, Pose::new(0.8, 0.8, 2.0)), SimOptions::default())?;
/// let outcome = run(&mut simulation.robot(0)?, &mut ascent, 200.0, |_, _, _| {})?;
/// assert_eq!(outcome, AscentOutcome::Top);
/// assert!(simulation.truth().pose(0)?.distance_to(Point::new(1.8, 1.6)) < 0.2);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Ascent {
    sensor: SlopeSensor,
    parameters: AscentParameters,
    /// The rise of the ground ahead and to the left, smoothed.
    rise: Option<Vector>,
    before: Option<Pose>,
    /// Metres above the start by wheels and attitude, and the most so far that counts, and when.
    height: f64,
    highest: (f64, f64),
}

/// Outcome of an [`Ascent`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum AscentOutcome {
    /// The robot gains no more height.
    Top,
    /// The robot is tilted more than it may be.
    TooSteep,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(AscentOutcome { Top: "it does not get higher", TooSteep: "the ground is too steep" });

/// Observation of an [`Ascent`].
#[derive(Debug, Clone, Default)]
pub struct AscentObservation {
    /// Pose by odometry.
    pub odometry: Pose,
    /// Attitude by the inertial unit.
    pub attitude: Attitude,
    /// Points of the ground around the robot, in its frame (m).
    pub points: Vec<Point3>,
}

impl AscentObservation {
    fn read_state<R: Odometry + Inertial + ?Sized>(&mut self, robot: &mut R) -> Result<()> {
        self.odometry = robot.pose()?;
        self.attitude = robot.attitude()?;
        Ok(())
    }
}

impl Ascent {
    /// Creates an ascent with a slope sensor. Fails for parameters out of range.
    pub fn new(sensor: SlopeSensor, parameters: AscentParameters) -> Result<Self> {
        parameters.validate()?;
        let (height, highest) = (0.0, (0.0, f64::NEG_INFINITY));
        Ok(Self { sensor, parameters, rise: None, before: None, height, highest })
    }

    /// Height above the start, by wheels and attitude (m).
    pub fn height(&self) -> f64 {
        self.height
    }

    /// The behaviour by distance sensors that look down, on robots that need no lidar. Its first step fails
    /// if the sensor is a [lidar](SlopeSensor::lidar).
    ///
    /// ```
    /// use roverlab::drive::terrain::{Ascent, AscentOutcome, AscentParameters, SlopeSensor};
    /// use roverlab::geometry::{Aabb, Point, Pose};
    /// use roverlab::io::control::run;
    /// use roverlab::io::sim::{SimOptions, Simulation};
    /// use roverlab::io::{Clock, DistanceSensors, Drive, Inertial, Odometry, Result};
    /// use roverlab::world::{HeightField, RobotSpec, Scene, Terrain, World};
    ///
    /// fn climb(
    ///     robot: &mut (impl Clock + Drive + Odometry + DistanceSensors + Inertial),
    ///     spec: &RobotSpec,
    /// ) -> Result<AscentOutcome> {
    ///     let sensor = SlopeSensor::psds(spec).expect("eight of its distance sensors look down");
    ///     let mut ascent = Ascent::new(sensor, AscentParameters::of(spec))?;
    ///     run(robot, &mut ascent.by_distance_sensors(), 200.0, |_, _, _| {})
    /// }
    ///
    /// # fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    /// let area = Aabb::new(Point::origin(), Point::new(3.0, 3.0));
    /// let hill = HeightField::from_fn(61, 61, area, |at| 0.3 * (-(at - Point::new(1.8, 1.6)).norm_squared()).exp())?;
    /// let world = World { terrain: Some(Terrain::new("hill.png", hill)), ..World::empty(3.0, 3.0) };
    /// let spec = RobotSpec { lidar: None, ..SlopeSensor::equip(RobotSpec::blizzard()) };
    /// let scene = Scene::with_robot(world, spec.clone(), Pose::new(0.8, 0.8, 2.0));
    /// let simulation = Simulation::new(&scene, SimOptions::default())?;
    /// assert_eq!(climb(&mut simulation.robot(0)?, &spec)?, AscentOutcome::Top);
    /// assert!(simulation.truth().pose(0)?.distance_to(Point::new(1.8, 1.6)) < 0.2);
    /// # Ok(())
    /// # }
    /// ```
    pub fn by_distance_sensors<R: Odometry + DistanceSensors + Inertial + ?Sized>(
        &mut self,
    ) -> impl Senses<R, Observation = AscentObservation, Command = Twist, Outcome = AscentOutcome> {
        let sensor = self.sensor.clone();
        SensedBy::new(self, move |robot: &mut R, _, seen: &mut AscentObservation| {
            seen.read_state(robot)?;
            sensor.look_by_psds(robot, &mut seen.points)
        })
    }

    /// The behaviour by lidar, on robots that need no distance sensors. Its first step fails if the sensor is
    /// not a [lidar](SlopeSensor::lidar).
    pub fn by_lidar<R: Odometry + Lidar + Inertial + ?Sized>(
        &mut self,
    ) -> impl Senses<R, Observation = AscentObservation, Command = Twist, Outcome = AscentOutcome> {
        let mut sensor = self.sensor.clone();
        let mut prepared = false;
        SensedBy::new(self, move |robot: &mut R, _, seen: &mut AscentObservation| {
            if !std::mem::replace(&mut prepared, true) {
                sensor.prepare(robot)?;
            }
            seen.read_state(robot)?;
            sensor.look_by_lidar(robot, &mut seen.points)
        })
    }

    fn reckon(&mut self, seen: &AscentObservation) {
        if let Some(before) = self.before.replace(seen.odometry) {
            let way = seen.odometry.position() - before.position();
            self.height -= way.dot(&direction(before.heading)) * math::sin(seen.attitude.pitch);
            // What was to the left is ahead after a turn to the left.
            let turned = seen.odometry.heading - before.heading;
            let (sin, cos) = math::sin_cos(turned);
            self.rise =
                self.rise.map(|rise| Vector::new(cos * rise.x + sin * rise.y, cos * rise.y - sin * rise.x));
        }
    }
}

impl Behaviour for Ascent {
    type Observation = AscentObservation;
    type Command = Twist;
    type Outcome = AscentOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &AscentObservation) -> Decision<Self> {
        check_pose(&seen.odometry)?;
        check_attitude(&seen.attitude)?;
        let AscentParameters { speed, turn_rate, smoothing, patience, gain, .. } = self.parameters;
        self.reckon(seen);
        if seen.attitude.frame().tilt() > self.parameters.slope + TOO_STEEP {
            return Ok(ControlFlow::Break(AscentOutcome::TooSteep));
        }
        if self.height > self.highest.0 + gain || self.highest.1 == f64::NEG_INFINITY {
            self.highest = (self.height, time);
        }
        if time - self.highest.1 > patience {
            return Ok(ControlFlow::Break(AscentOutcome::Top));
        }
        let around = slope(&seen.points, seen.attitude);
        self.rise = match (self.rise, around) {
            (Some(rise), Some(around)) => Some(rise + (around - rise) * smoothing),
            (known, new) => new.or(known),
        };
        let Some(rise) = self.rise else { return Ok(ControlFlow::Continue(Twist::STOP)) };
        let bearing = math::atan2(rise.y, rise.x);
        // On gentle ground the direction is uncertain, and the top near.
        let fast = speed * math::cos(bearing).max(0.0) * (steepness(rise) / GENTLE).clamp(0.3, 1.0);
        let turn = (1.5 * bearing).clamp(-turn_rate, turn_rate);
        Ok(ControlFlow::Continue(Twist::new(fast, turn)))
    }
}

/// Radians above the limit at which an ascent ends.
const TOO_STEEP: f64 = 0.05;
/// The slope in radians below which it slows down.
const GENTLE: f64 = 0.1;

impl<R: Odometry + DistanceSensors + Lidar + Inertial + ?Sized> Senses<R> for Ascent {
    fn prepare(&mut self, robot: &mut R) -> Result<()> {
        self.sensor.prepare(robot)
    }

    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut AscentObservation) -> Result<()> {
        seen.read_state(robot)?;
        self.sensor.look(robot, &mut seen.points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ascent() -> Ascent {
        let spec = RobotSpec::blizzard();
        Ascent::new(SlopeSensor::lidar(&spec).unwrap(), AscentParameters::of(&spec)).unwrap()
    }

    fn seen(rise: Vector) -> AscentObservation {
        let points = [(0.4, 0.0), (0.0, 0.4), (-0.4, 0.0), (0.0, -0.4)];
        let points = points.map(|(x, y)| Point3::new(x, y, rise.x * x + rise.y * y)).to_vec();
        AscentObservation { points, ..AscentObservation::default() }
    }

    #[test]
    fn it_turns_to_the_gradient_and_drives_along_it() {
        for (rise, turns, drives) in [
            (Vector::new(0.2, 0.0), 0.0, true),
            (Vector::new(0.1, 0.2), 1.0, true),
            (Vector::new(-0.1, -0.2), -1.0, false),
        ] {
            let ControlFlow::Continue(twist) = ascent().step(0.0, &seen(rise)).unwrap() else { panic!() };
            assert!(
                twist.angular * turns >= 0.0 && (twist.angular.abs() > 0.1) == (turns != 0.0),
                "{twist:?}"
            );
            assert_eq!(twist.linear > 0.01, drives, "{twist:?}");
        }
    }

    #[test]
    fn it_ends_where_it_gets_no_higher_or_too_steep() {
        let mut resting = ascent();
        assert!(matches!(resting.step(0.0, &seen(Vector::new(0.1, 0.0))), Ok(ControlFlow::Continue(_))));
        let end = resting.step(9.0, &seen(Vector::new(0.1, 0.0)));
        assert!(matches!(end, Ok(ControlFlow::Break(AscentOutcome::Top))));
        let steep = AscentObservation {
            attitude: Attitude { roll: 1.0, ..Attitude::default() },
            ..seen(Vector::new(0.1, 0.0))
        };
        assert!(matches!(ascent().step(0.0, &steep), Ok(ControlFlow::Break(AscentOutcome::TooSteep))));
        let broken = AscentObservation { odometry: Pose::new(f64::NAN, 0.0, 0.0), ..steep };
        assert!(ascent().step(0.0, &broken).is_err());
    }

    /// Each way of sensing drives as the full robot does, and fails with the other sensor.
    #[test]
    fn each_way_of_sensing_needs_its_own_sensor_and_no_other() {
        use crate::io::control::run;
        use crate::io::sim::{SimOptions, Simulation};
        use crate::world::{Scene, World};
        let spec = SlopeSensor::equip(RobotSpec::blizzard());
        let sensors = [SlopeSensor::psds(&spec).unwrap(), SlopeSensor::lidar(&spec).unwrap()];
        let without =
            [RobotSpec { lidar: None, ..spec.clone() }, RobotSpec { psds: Vec::new(), ..spec.clone() }];
        for (by_lidar, spec) in [false, true].into_iter().zip(without) {
            for (other, sensor) in [false, true].into_iter().zip(&sensors) {
                let scene = Scene::with_robot(World::empty(3.0, 3.0), spec.clone(), Pose::new(1.0, 1.0, 0.0));
                let simulation = Simulation::new(&scene, SimOptions::default()).unwrap();
                let mut ascent = Ascent::new(sensor.clone(), AscentParameters::of(&spec)).unwrap();
                let mut robot = simulation.robot(0).unwrap();
                let outcome = if by_lidar {
                    run(&mut robot, &mut ascent.by_lidar(), 20.0, |_, _, _| {})
                } else {
                    run(&mut robot, &mut ascent.by_distance_sensors(), 20.0, |_, _, _| {})
                };
                if by_lidar == other {
                    assert_eq!(outcome.unwrap(), AscentOutcome::Top);
                } else {
                    assert!(outcome.unwrap_err().to_string().starts_with("slope sensor is "));
                }
            }
        }
    }
}
