//! A drive with stops.

use std::fmt;

use roverlab::drive::cones::{Racer, RacerParameters, sightings};
use roverlab::drive::safety::{
    Causes, SafetyState, SpeedError, StopRecord, StoppingModel, Supervised, SupervisorParameters,
};
use roverlab::geometry::{Point, Pose};
use roverlab::io::sim::NoiseModel;
use roverlab::io::sim::race::{Race, RaceCarSpec, RaceOptions};
use roverlab::io::{self, Clock, Drive, Lidar, LidarScan};
use serde_json::{Value, json};

use super::Args;
use super::base::{Base, SeenStop};
use super::crew::{Crew, Event};
use crate::common::{CommonArgs, DEADMAN, Driven as Robot, Failure, Stage, rounded};
use crate::cones::{Course, Judge, pass};

/// A stop, and what was true about it.
#[derive(Debug, Clone)]
pub(crate) struct Stopped {
    seen: SeenStop,
    record: StopRecord,
    bound: f64,
}

impl Stopped {
    /// Where it began, and where the car stood.
    pub(crate) fn places(&self) -> [Pose; 2] {
        self.seen.places
    }

    fn distance(&self) -> f64 {
        self.seen.metres[1] - self.seen.metres[0]
    }

    /// The distance as a share of what is allowed.
    pub(crate) fn share(&self) -> f64 {
        self.distance() / self.bound.max(1e-9)
    }

    /// Whether the car stood within the distance that is allowed.
    pub(crate) fn is_within(&self) -> bool {
        self.distance() <= self.bound + 1e-6
    }

    fn reaction(&self) -> Option<f64> {
        self.seen.event.map(|(_, time)| self.record.time - time)
    }

    pub(crate) fn told(&self) -> Value {
        json!({
            "event": self.seen.event.map(|(event, _)| event.name()),
            "state": format!("{:?}", self.record.state),
            "causes": self.record.causes.names().collect::<Vec<_>>(),
            "time_s": rounded(self.record.time),
            "reaction_ms": self.reaction().map(|seconds| rounded(1000.0 * seconds)),
            "speed_m_s": rounded(self.seen.speed),
            "distance_m": rounded(self.distance()),
            "bound_m": rounded(self.bound),
        })
    }
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let causes: Vec<&str> = self.record.causes.names().collect();
        write!(f, "{:6.2} s: {:?} for {}", self.record.time, self.record.state, causes.join(", "))?;
        if let Some(reaction) = self.reaction() {
            write!(f, ", {:.0} ms after it began", 1000.0 * reaction)?;
        }
        write!(f, "; from {:.2} m/s in {:.2} of {:.2} m", self.seen.speed, self.distance(), self.bound)
    }
}

/// What came out of a drive.
pub(crate) struct Driven {
    pub(crate) stops: Vec<Stopped>,
    pub(crate) states: Vec<(f64, SafetyState)>,
    /// Whether everything happened in time.
    pub(crate) done: bool,
    pub(crate) judge: Judge,
}

/// The world of the drive.
pub(crate) fn world(course: &Course, common: &CommonArgs) -> io::Result<Race> {
    let noise = NoiseModel::real().scaled(common.noise);
    let options = RaceOptions { seed: common.seed, noise, ..RaceOptions::default() };
    Race::new(&course.race_cones(), &[(RaceCarSpec::default(), course.start)], options)
}

/// Drives until everything has happened.
pub(crate) fn drive(course: &Course, args: &Args, stage: &Stage) -> Result<Driven, Failure> {
    let mut judge = Judge::new(course, stage.truth(0)?, 0).map_err(Failure::run)?;
    let events = if args.event.is_empty() { Event::ALL.to_vec() } else { args.event.clone() };
    let limit = args.common.time_limit.unwrap_or(20.0 + 15.0 * events.len() as f64);
    let parameters = SupervisorParameters {
        fence: fence(args.fence),
        speed_error: SpeedError::default().scaled(args.common.noise),
        ..SupervisorParameters::default()
    };
    let spec = RaceCarSpec::default();
    let stopping = parameters.stopping(1.0 / spec.speed_gain, spec.brake);
    let base = Base::new(Crew::new(events), stage.truth(0)?, parameters.heartbeat);
    let mut car = Supervised::new(stage.robot(0)?, base, parameters).map_err(Failure::run)?;
    let mut records = Vec::new();
    let done = program(&mut car, &mut judge, limit, &mut records);
    let base = car.station_mut();
    let stops = base.stops.iter().zip(&records).map(|(seen, record)| {
        // Without a link, or while a call hangs, the brake is in the hands of the car's own watchdog.
        let alone = seen.alone || record.causes.has(Causes::LINK);
        let reaction = stopping.reaction + if alone { DEADMAN } else { 0.0 };
        let bound = StoppingModel { reaction, ..stopping }.distance(seen.speed);
        Stopped { seen: seen.clone(), record: *record, bound }
    });
    Ok(Driven { stops: stops.collect(), states: base.states.clone(), done, judge })
}

fn fence(half: Option<f64>) -> Vec<Point> {
    let half = half.into_iter();
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    half.flat_map(|half| corners.map(|(x, y)| Point::new(half * x, half * y))).collect()
}

/// The program that drives, until everything has happened. Whether it has, within some seconds.
fn program(
    car: &mut Supervised<Robot, Base>,
    judge: &mut Judge,
    limit: f64,
    records: &mut Vec<StopRecord>,
) -> bool {
    let mut racer = Racer::new(RacerParameters { laps: 100, ..RacerParameters::rolling() });
    let mut scan = LidarScan::default();
    while judge.time() < limit && !car.station_mut().crew.is_done() {
        // A sensor that fails stops the car; the program goes on with what it has.
        let seen = car.scan_into(&mut scan).map(|()| sightings(&scan)).unwrap_or_default();
        if let (Ok(pose), Ok(speed)) = (car.pose(), car.speed())
            && pose.is_finite()
        {
            let _ = car.set_speed(racer.decide(pose, speed, &seen));
        }
        // Who hangs lets time pass at once.
        if car.station_mut().crew.lets_hang() {
            let _ = car.wait(1.0);
        }
        // A wait that fails has taken its time, but for a car that is out of reach for good.
        let before = judge.time();
        let passed = pass(car, &mut [judge], 0.05);
        note(car, records);
        if passed.is_err() && (judge.look().is_err() || judge.time() <= before) {
            break;
        }
    }
    car.station_mut().crew.is_done()
}

/// Notes the last stop, if it is new.
fn note(car: &Supervised<Robot, Base>, records: &mut Vec<StopRecord>) {
    if let Some(stop) = car.last_stop()
        && records.last().is_none_or(|last| *last != stop)
    {
        records.push(stop);
    }
}
