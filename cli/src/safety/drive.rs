//! A drive with stops.

use std::fmt;

use roverlab::ParameterError;
use roverlab::geometry::{Point, Pose};
use roverlab::io::wrappers::{Fault, FaultKind};
use roverlab::io::{Clock, Drive, Lidar, LidarScan, Odometry};
use roverlab::race::{Racer, RacerParameters, sightings};
use roverlab::safety::{Causes, SafetyState, SpeedError, StoppingModel, Supervised, SupervisedParameters};
use roverlab::world::RobotSpec;
use serde_json::{Value, json};

use super::Args;
use super::base::{Answer, Base, SeenStop};
use super::crew::{Crew, Event, STEP};
use crate::common::{DEADMAN, Driven as Robot, Failure, Stage, rounded};
use crate::cones::{Course, Judge, pass};
use crate::driving::Ending;

/// A stop with its ground truth.
#[derive(Debug, Clone)]
pub(crate) struct Stopped {
    seen: SeenStop,
    bound: f64,
}

impl Stopped {
    /// Poses at its start and at rest.
    pub(crate) fn places(&self) -> [Pose; 2] {
        self.seen.places
    }

    fn distance(&self) -> f64 {
        self.seen.metres[1] - self.seen.metres[0]
    }

    /// Stopping distance as a fraction of its bound.
    pub(crate) fn share(&self) -> f64 {
        self.distance() / self.bound.max(1e-9)
    }

    /// Whether the car stopped within the bound.
    pub(crate) fn is_within(&self) -> bool {
        self.distance() <= self.bound + 1e-6
    }

    pub(crate) fn told(&self) -> Value {
        let mut told = told(&self.seen.answer);
        told["speed_m_s"] = rounded(self.seen.speed).into();
        told["distance_m"] = rounded(self.distance()).into();
        told["bound_m"] = rounded(self.bound).into();
        told
    }
}

/// The car's response, for the report.
pub(crate) fn told(answer: &Answer) -> Value {
    json!({
        "event": answer.event.map(|(event, _)| event.name()),
        "state": format!("{:?}", answer.state),
        "causes": answer.causes.names().collect::<Vec<_>>(),
        "time_s": rounded(answer.time),
        "reaction_ms": answer.reaction().map(|seconds| rounded(1000.0 * seconds)),
    })
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let causes: Vec<&str> = self.causes.names().collect();
        write!(f, "{:6.2} s: {:?} for {}", self.time, self.state, causes.join(", "))?;
        self.reaction().map_or(Ok(()), |reaction| write!(f, ", {:.0} ms after it began", 1000.0 * reaction))
    }
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { seen, bound } = self;
        write!(f, "{}; from {:.2} m/s in {:.2} of {bound:.2} m", seen.answer, seen.speed, self.distance())
    }
}

/// Result of a drive.
pub(crate) struct Driven {
    pub(crate) stops: Vec<Stopped>,
    pub(crate) takeovers: Vec<Answer>,
    /// Whether each event was answered in time.
    pub(crate) prompt: bool,
    pub(crate) states: Vec<(f64, SafetyState)>,
    /// Whether all events happened within the time limit, or the robot's error that ended the drive.
    pub(crate) ending: Ending<bool>,
    pub(crate) judge: Judge,
}

/// Drives until all events have happened.
pub(crate) fn drive(course: &Course, args: &Args, stage: &Stage) -> Result<Driven, Failure> {
    let mut judge = Judge::new(course, stage.truth(0)?, 0).map_err(Failure::run)?;
    let events = if args.event.is_empty() { Event::ALL.to_vec() } else { args.event.clone() };
    let limit = args.common.time_limit.unwrap_or(20.0 + 15.0 * events.len() as f64);
    let parameters = SupervisedParameters {
        fence: fence(args.fence),
        speed_error: SpeedError::default().scaled(args.common.noise),
        ..SupervisedParameters::default()
    };
    let crew = Crew::new(events, well(&args.common.faults()?));
    let base = Base::new(crew, stage.truth(0)?, parameters.heartbeat)?;
    let mut car = Supervised::new(stage.robot(0)?, base, parameters.clone()).map_err(Failure::run)?;
    let ending = program(&mut car, &mut judge, limit)?;
    let base = car.station_mut();
    let bounded = |seen: &SeenStop| Stopped { bound: bound(&parameters, seen), seen: seen.clone() };
    let stops: Vec<Stopped> = base.stops.iter().map(bounded).collect();
    let mut answers = base.stops.iter().map(|stop| stop.answer).chain(base.takeovers.iter().copied());
    let prompt = answers.all(|answer| is_prompt(&answer, &parameters));
    let (takeovers, states) = (base.takeovers.clone(), base.states.clone());
    Ok(Driven { stops, takeovers, prompt, states, ending, judge })
}

/// Maximum stopping distance (m).
fn bound(parameters: &SupervisedParameters, seen: &SeenStop) -> f64 {
    let spec = RobotSpec::race_car();
    let stopping = parameters.stopping_in(seen.answer.state, spec.motor.time_constant, spec.deceleration());
    // Without a link, or during a hanging call, the car's own watchdog brakes.
    let alone = seen.alone || seen.answer.causes.has(Causes::LINK);
    let reaction = stopping.reaction + if alone { DEADMAN } else { 0.0 };
    StoppingModel { reaction, ..stopping }.distance(seen.speed)
}

/// Whether an event was answered in time, to the microsecond.
fn is_prompt(answer: &Answer, parameters: &SupervisedParameters) -> bool {
    answer.event.is_none_or(|(event, time)| answer.time - time <= event.allowed(parameters) + 1e-6)
}

/// Time from which no fault disturbs a sensor any more (s).
fn well(faults: &[Fault]) -> f64 {
    let end = |fault: &Fault| match fault.kind {
        FaultKind::Hang(seconds) => fault.at + seconds,
        FaultKind::ClockStop | FaultKind::ClockJump(_) => 0.0,
        _ => fault.until.unwrap_or(f64::INFINITY),
    };
    faults.iter().map(end).fold(0.0, f64::max)
}

fn fence(half: Option<f64>) -> Vec<Point> {
    let half = half.into_iter();
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    half.flat_map(|half| corners.map(|(x, y)| Point::new(half * x, half * y))).collect()
}

/// The driving program, until all events have happened. Returns whether they did within the limit (s), or the
/// error of a car that stays out of reach.
fn program(
    car: &mut Supervised<Robot, Base>,
    judge: &mut Judge,
    limit: f64,
) -> Result<Ending<bool>, ParameterError> {
    let mut racer = Racer::new(RacerParameters { laps: 100, ..RacerParameters::rolling() })?;
    let mut scan = LidarScan::default();
    while judge.time() < limit && !car.station_mut().crew.is_done() {
        // A failing sensor stops the car; the program continues with the remaining data.
        let seen = car.scan_into(&mut scan).map(|()| sightings(&scan)).unwrap_or_default();
        if let (Ok(pose), Ok(speed)) = (car.pose(), car.speed())
            && pose.is_finite()
        {
            let _ = car.set_speed(racer.decide(pose, speed, &seen));
        }
        // A hanging program lets time pass at once.
        if car.station_mut().crew.lets_hang() {
            let _ = car.wait(1.0);
        }
        // A failing wait takes its time, except for a car that is permanently out of reach.
        let before = judge.time();
        if let Err(error) = pass(car, judge, STEP)
            && (judge.look().is_err() || judge.time() <= before)
        {
            return Ok(Err(format!("the car is out of reach: {}", Failure::from(error))));
        }
    }
    Ok(Ok(car.station_mut().crew.is_done()))
}
