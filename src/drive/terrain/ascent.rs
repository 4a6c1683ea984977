use std::ops::ControlFlow;

use super::slope_sensor::{SlopeSensor, slope, steepness};
use crate::ParameterError;
use crate::geometry::{Point3, Pose, Twist, Vector, direction, math};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::{Attitude, DistanceSensors, Error, Inertial, Lidar, Odometry, Result};
use crate::parameter::{require, require_positive};
use crate::world::RobotSpec;

/// The parameters of an [`Ascent`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AscentParameters {
    /// The steepest that the robot may be tilted, in radians.
    pub slope: f64,
    /// Metres per second.
    pub speed: f64,
    /// Radians per second.
    pub turn_rate: f64,
    /// The share that a reading has in the estimate of the slope.
    pub smoothing: f64,
    /// Seconds in which the robot has to get higher, and metres by which.
    pub patience: f64,
    /// Metres of height that count as getting higher.
    pub gain: f64,
    /// Seconds from one step to the next.
    pub period: f64,
}

impl AscentParameters {
    /// Those for a robot: within two thirds of the slope on which it would slip.
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

    /// Fails with the name of the parameter that is out of range.
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

/// Drives up the steepest way, always turning to where the ground around rises most, until it does not get higher any more
/// (book, section 7.4).
///
/// That is the top of a hill, and seldom the highest one: `nav::SummitSearch` goes on from there.
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

/// How an ascent ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum AscentOutcome {
    /// It does not get higher any more.
    Top,
    /// The ground is steeper than the robot may stand on.
    TooSteep,
    /// The time was over.
    TimedOut,
    /// Who watched has seen enough.
    Stopped,
}

halts!(AscentOutcome { Top: "it does not get higher", TooSteep: "the ground is too steep" });

/// What an [`Ascent`] sees at a step.
#[derive(Debug, Clone, Default)]
pub struct AscentObservation {
    /// Where odometry takes the robot to be.
    pub odometry: Pose,
    /// How it is turned.
    pub attitude: Attitude,
    /// Points of the ground around, in the robot's frame.
    pub points: Vec<Point3>,
}

impl Ascent {
    /// An ascent by what a sensor shows.
    pub fn new(sensor: SlopeSensor, parameters: AscentParameters) -> Result<Self> {
        parameters.validate()?;
        let (height, highest) = (0.0, (0.0, f64::NEG_INFINITY));
        Ok(Self { sensor, parameters, rise: None, before: None, height, highest })
    }

    /// Metres above the start.
    pub fn height(&self) -> f64 {
        self.height
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
        let Attitude { roll, pitch, yaw } = seen.attitude;
        if !seen.odometry.is_finite() || ![roll, pitch, yaw].iter().all(|angle| angle.is_finite()) {
            let found = format!("{:?} {:?}", seen.odometry, seen.attitude);
            return Err(Error::invalid_input("observed pose", found, "finite numbers"));
        }
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
        seen.odometry = robot.pose()?;
        seen.attitude = robot.attitude()?;
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
}
