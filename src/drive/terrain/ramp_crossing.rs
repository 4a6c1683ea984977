use std::f64::consts::FRAC_PI_2;
use std::ops::ControlFlow;

use super::edge_sensors::EdgeSensors;
use crate::ParameterError;
use crate::geometry::{Pose, Twist, angle_difference, direction, math, normalize_angle};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::{Attitude, DistanceSensors, Error, Inertial, Odometry, Result};
use crate::parameter::require_positive;

/// The parameters of a [`RampCrossing`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RampParameters {
    /// Metres per second.
    pub speed: f64,
    /// Radians per second.
    pub turn_rate: f64,
    /// Radians of pitch from which the robot is on a ramp.
    pub ramp: f64,
    /// The least metres from side to side of the bank and of the ramps.
    pub width: f64,
    /// Metres that it drives on behind the ramp.
    pub beyond: f64,
    /// Seconds from one step to the next.
    pub period: f64,
}

impl Default for RampParameters {
    /// For the book's levels, ramps and a bank of half a metre and more.
    fn default() -> Self {
        Self { speed: 0.12, turn_rate: 0.6, ramp: 0.06, width: 0.5, beyond: 0.3, period: 0.05 }
    }
}

impl RampParameters {
    /// Fails with the name of the parameter that is out of range.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        require_positive("speed", self.speed)?;
        require_positive("turn rate", self.turn_rate)?;
        require_positive("ramp's slope", self.ramp)?;
        require_positive("width", self.width)?;
        require_positive("way beyond", self.beyond)?;
        require_positive("control period", self.period)
    }
}

/// Drives up a ramp, across the bank on top, and down a second ramp beside the first one, without falling off
/// (book, section 7.4), by distance sensors that look down ([`EdgeSensors`]) and an inertial unit.
///
/// It starts on level ground before the first ramp, about straight ahead. On ramps it keeps to the steepest
/// direction. Where the ground is missing ahead, the bank ends; how far it has come over the bank till then
/// tells the bank's width, and so where the middle is. From there it turns a quarter, to where there is more
/// ground.
#[derive(Debug, Clone)]
pub struct RampCrossing {
    sensors: EdgeSensors,
    parameters: RampParameters,
    stage: Stage,
    /// The heading to keep to, by the inertial unit.
    course: f64,
    /// What the inertial unit shows on level ground.
    level: Option<[f64; 2]>,
    /// The estimate of roll and pitch.
    smooth: [f64; 2],
    /// Metres by the wheels since the stage began, and in all at the last step.
    driven: f64,
    before: Option<Pose>,
    /// Metres from one side of the bank to the other.
    bank: f64,
    last_progress: f64,
}

/// What a [`RampCrossing`] is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RampStage {
    /// Towards the first ramp.
    Approaching,
    /// Up the first ramp.
    Climbing,
    /// Over the bank, up to its end.
    Levelling,
    /// Along the bank.
    Crossing,
    /// Down the second ramp.
    Descending,
    /// Away from it.
    Leaving,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    Driving(RampStage),
    /// Back by so many metres to the middle of the bank, or of the second ramp.
    Centring {
        rest: f64,
        then: RampStage,
    },
    /// To the course.
    Turning {
        then: RampStage,
    },
}

/// How a crossing ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RampOutcome {
    /// Up, across and down.
    Crossed,
    /// Ground is missing where there should be some, or the robot does not get on.
    Stuck,
    /// The time was over.
    TimedOut,
    /// Who watched has seen enough.
    Stopped,
}

halts!(RampOutcome { Crossed: "up, across and down", Stuck: "the robot does not get on" });

/// What a [`RampCrossing`] sees at a step.
#[derive(Debug, Clone, Default)]
pub struct RampObservation {
    /// Where odometry takes the robot to be.
    pub odometry: Pose,
    /// How it is turned.
    pub attitude: Attitude,
    /// Whether ground is missing ahead on the left and on the right.
    pub missing: [bool; 2],
    /// Metres to the ground aside, on the left and on the right.
    pub aside: [f64; 2],
}

/// The share that a reading has in the estimate of roll and pitch.
const SMOOTHING: f64 = 0.2;
/// Steps at the start whose mean is what the unit shows on level ground.
const RESTING: f64 = 1.0;
/// Radians per second of steering for a radian off the course.
const GAIN: f64 = 1.0;
/// Radians per second of steering on ramps: belts that slide in turns slide downhill.
const GENTLY: f64 = 0.12;
/// Radians per second that the robot turns away from an edge beside it.
const AWAY: f64 = 0.25;
/// Radians by which a turn may be missed.
const ALIGNED: f64 = 0.02;
/// Metres in a stage, or seconds, after which the robot does not get on.
const TOO_FAR: f64 = 6.0;
const PATIENCE: f64 = 60.0;

impl RampCrossing {
    /// A crossing with the sensors of a robot.
    pub fn new(sensors: EdgeSensors, parameters: RampParameters) -> Result<Self> {
        parameters.validate()?;
        Ok(Self {
            sensors,
            parameters,
            stage: Stage::Driving(RampStage::Approaching),
            course: 0.0,
            level: None,
            smooth: [0.0; 2],
            driven: 0.0,
            before: None,
            bank: 0.0,
            last_progress: 0.0,
        })
    }

    /// What it is doing.
    pub fn stage(&self) -> RampStage {
        match self.stage {
            Stage::Driving(stage) | Stage::Centring { then: stage, .. } | Stage::Turning { then: stage } => {
                stage
            }
        }
    }

    fn enter(&mut self, stage: Stage, time: f64) {
        (self.stage, self.driven, self.last_progress) = (stage, 0.0, time);
    }

    fn reckon(&mut self, seen: &RampObservation) {
        if let Some(before) = self.before.replace(seen.odometry) {
            let way = seen.odometry.position() - before.position();
            self.driven += way.dot(&direction(before.heading));
        }
        let now = [seen.attitude.roll, seen.attitude.pitch];
        let level = self.level.unwrap_or(now);
        for ((smooth, now), level) in self.smooth.iter_mut().zip(now).zip(level) {
            *smooth += SMOOTHING * (now - level - *smooth);
        }
    }

    /// The bearing of the steepest way up.
    fn uphill(&self) -> f64 {
        let [roll, pitch] = self.smooth;
        math::atan2(math::sin(roll), -math::sin(pitch))
    }

    /// The next speed of a robot that keeps to a bearing, and off edges beside it.
    fn keep(&mut self, bearing: f64, most: f64, seen: &RampObservation) -> Twist {
        let away = match seen.missing {
            [true, false] => -AWAY,
            [false, true] => AWAY,
            _ => 0.0,
        };
        let speed = self.parameters.speed;
        if away != 0.0 {
            self.course = normalize_angle(self.course + 0.3 * away * self.parameters.period);
            return Twist::new(0.3 * speed, away);
        }
        Twist::new(speed, (GAIN * bearing).clamp(-most, most))
    }

    fn drive(
        &mut self,
        stage: RampStage,
        time: f64,
        seen: &RampObservation,
    ) -> ControlFlow<RampOutcome, Twist> {
        let RampParameters { ramp, width, beyond, .. } = self.parameters;
        let pitch = self.smooth[1];
        let off_course = angle_difference(self.course, seen.attitude.yaw);
        let both = seen.missing == [true, true];
        let any = seen.missing != [false, false];
        let ahead = self.sensors.ahead();
        match stage {
            RampStage::Approaching if -pitch > ramp => self.enter(Stage::Driving(RampStage::Climbing), time),
            RampStage::Climbing if -pitch < 0.5 * ramp && self.driven > 0.2 => {
                self.course = seen.attitude.yaw;
                self.enter(Stage::Driving(RampStage::Levelling), time);
            }
            RampStage::Levelling | RampStage::Crossing if any && self.driven > width - ahead => {
                if stage == RampStage::Levelling {
                    self.bank = self.driven + ahead;
                }
                let rest = 0.5 * self.bank - ahead;
                let then =
                    if stage == RampStage::Levelling { RampStage::Crossing } else { RampStage::Descending };
                self.enter(Stage::Centring { rest, then }, time);
                return ControlFlow::Continue(Twist::STOP);
            }
            RampStage::Descending if pitch.abs() < 0.5 * ramp && self.driven > self.bank => {
                self.course = seen.attitude.yaw;
                self.enter(Stage::Driving(RampStage::Leaving), time);
            }
            RampStage::Leaving if self.driven > beyond => return ControlFlow::Break(RampOutcome::Crossed),
            // Over the crest of a ramp the sensors look into the air.
            RampStage::Climbing => {}
            RampStage::Descending if pitch < ramp => {}
            _ if both => return ControlFlow::Break(RampOutcome::Stuck),
            _ => {}
        }
        let turn_rate = self.parameters.turn_rate;
        let twist = match stage {
            RampStage::Climbing => self.keep(self.uphill(), GENTLY, seen),
            RampStage::Descending if pitch > ramp => {
                let downhill = normalize_angle(self.uphill() + std::f64::consts::PI);
                self.keep(downhill, GENTLY, seen)
            }
            _ => self.keep(off_course, turn_rate, seen),
        };
        ControlFlow::Continue(twist)
    }

    /// Turns a quarter, to the side with more ground.
    fn turn(&mut self, then: RampStage, time: f64, seen: &RampObservation) {
        let [left, right] = seen.aside;
        let quarter = if left <= right { FRAC_PI_2 } else { -FRAC_PI_2 };
        self.course = normalize_angle(self.course + quarter);
        self.enter(Stage::Turning { then }, time);
    }
}

impl Behaviour for RampCrossing {
    type Observation = RampObservation;
    type Command = Twist;
    type Outcome = RampOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &RampObservation) -> Decision<Self> {
        let Attitude { roll, pitch, yaw } = seen.attitude;
        if !seen.odometry.is_finite() || ![roll, pitch, yaw].iter().all(|angle| angle.is_finite()) {
            let found = format!("{:?} {:?}", seen.odometry, seen.attitude);
            return Err(Error::invalid_input("observed pose", found, "finite numbers"));
        }
        self.reckon(seen);
        if self.level.is_none() {
            // At rest, the estimates are of the unit's own errors.
            self.course = yaw;
            if time - self.last_progress > RESTING {
                self.level = Some(self.smooth);
                self.smooth = [0.0; 2];
            }
            return Ok(ControlFlow::Continue(Twist::STOP));
        }
        if self.driven.abs() > TOO_FAR || time - self.last_progress > PATIENCE {
            return Ok(ControlFlow::Break(RampOutcome::Stuck));
        }
        Ok(match self.stage {
            Stage::Driving(stage) => self.drive(stage, time, seen),
            Stage::Centring { rest, then } if -self.driven >= rest => {
                self.turn(then, time, seen);
                ControlFlow::Continue(Twist::STOP)
            }
            Stage::Centring { .. } => ControlFlow::Continue(Twist::new(-0.4 * self.parameters.speed, 0.0)),
            Stage::Turning { then } => {
                let rest = angle_difference(self.course, yaw);
                if rest.abs() < ALIGNED {
                    self.enter(Stage::Driving(then), time);
                    return Ok(ControlFlow::Continue(Twist::STOP));
                }
                let rate = self.parameters.turn_rate;
                ControlFlow::Continue(Twist::new(0.0, (2.0 * rest).clamp(-rate, rate)))
            }
        })
    }
}

impl<R: Odometry + DistanceSensors + Inertial + ?Sized> Senses<R> for RampCrossing {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut RampObservation) -> Result<()> {
        seen.odometry = robot.pose()?;
        seen.attitude = robot.attitude()?;
        seen.missing = EdgeSensors::missing(robot)?;
        seen.aside = EdgeSensors::aside(robot)?;
        Ok(())
    }
}
