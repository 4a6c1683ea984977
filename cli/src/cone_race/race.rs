//! One race.

use std::ops::ControlFlow;
use std::thread;

use image::RgbImage;
use roverlab::geometry::{Point, Pose, Twist};
use roverlab::io::control::{Behaviour, Decision, Halt, LidarObservation, SensedBy, Senses, until};
use roverlab::io::sim::{RobotTruth, SimOptions};
use roverlab::io::{self, Resolution, RobotIo};
use roverlab::race::{
    CameraMount, CameraSight, CarLimits, Cone, ConeMap, LaneFinder, LineTracker, RaceObservation,
    RaceOutcome, RacePhase, RaceScore, Racer, SpeedProfile, sightings,
};
use roverlab::world::{RobotSpec, Scene};

use super::Sensors;
use super::event;
use crate::common::{Claimed, Failure, Stage};
use crate::cones::{Course, Judge, Passed, judged};

/// Settings of a race apart from its course.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settings {
    pub(crate) laps: usize,
    pub(crate) sensors: Sensors,
    pub(crate) seed: u64,
    pub(crate) noise: f64,
    pub(crate) limit: Option<f64>,
    /// Whether a second car drives ahead.
    pub(crate) other: bool,
}

impl Settings {
    /// Cones and cars.
    pub(crate) fn scene(&self, course: &Course) -> Scene {
        let starts = [Some(course.start), self.other.then(|| course.ahead(HEAD_START))];
        course.scene(&starts.into_iter().flatten().collect::<Vec<_>>())
    }

    /// Options of a race's simulation.
    pub(crate) fn options(&self) -> SimOptions {
        SimOptions::with_noise(self.noise, self.seed)
    }

    /// Time limit of a race (s): a very slow first lap, and slow further ones.
    fn limit(&self, course: &Course) -> f64 {
        let slow = if self.other { 2.0 } else { 3.0 };
        self.limit.unwrap_or(course.corridor.length() * (1.0 + self.laps as f64 / slow))
    }
}

/// Initial lead of a second car (m).
const HEAD_START: f64 = 6.0;
/// Speed of a second car (m/s), its lookahead (m), and its maximum distance to cones (m).
const STROLL: f64 = 3.0;
const LOOK_AHEAD: f64 = 3.5;
const SIGHT: f64 = 24.0;
/// Distance from its rear axle to halfway between the axles (m).
const MIDDLE: f64 = 0.775;

/// The second car, which drives in the middle of the lane that it sees, without a map.
struct Other {
    car: Claimed,
    pilot: Pilot,
    judge: Judge,
}

/// State of the second car.
struct Pilot {
    map: ConeMap,
    lane: LaneFinder,
}

/// Control period of a second car (s).
const OTHER_PERIOD: f64 = 0.1;
/// Radio id of the second car, and the message at the end of the race.
const OTHER: u32 = 2;
const OVER: &[u8] = b"over";

impl Other {
    fn new(course: &Course, stage: &Stage) -> Result<Self, Failure> {
        let judge = Judge::new(course, stage.truth(1)?, 1).map_err(Failure::run)?;
        let parameters = course.parameters(1);
        let (map, lane) = (ConeMap::new(parameters.map)?, LaneFinder::new(parameters.lane)?);
        let pilot = Pilot { map, lane };
        Ok(Self { car: stage.claim(1)?, pilot, judge })
    }

    /// Drives until the message of the end, or the time limit.
    fn drive(self, limit: f64) -> Result<Second, Failure> {
        let Self { car, mut pilot, mut judge } = self;
        let mut car = car.ready()?;
        judged(car.as_mut(), &mut pilot, limit, &mut judge, |car, _, _| {
            Ok::<_, io::Error>(until(car.receive()?.is_some()))
        })?;
        Ok(Second { cones_hit: judge.verdict().cones_hit, trail: judge.trail().to_vec() })
    }
}

impl Behaviour for Pilot {
    type Observation = LidarObservation;
    type Command = Twist;
    type Outcome = Halt;

    fn period(&self) -> f64 {
        OTHER_PERIOD
    }

    fn step(&mut self, _time: f64, seen: &LidarObservation) -> Decision<Self> {
        self.map.update(seen.odometry, &sightings(&seen.scan));
        let pose = self.map.pose();
        let near: Vec<Cone> =
            self.map.fresh_cones().filter(|cone| (cone.position - pose.position()).norm() < SIGHT).collect();
        let middle = pose.compose(&Pose::new(MIDDLE, 0.0, 0.0));
        let lane = self.lane.step(middle, &near);
        // Without a lane it stands and keeps looking.
        Ok(ControlFlow::Continue(lane.map_or(Twist::STOP, |lane| pursue(&lane.points, pose))))
    }
}

impl<R: RobotIo + ?Sized> Senses<R> for Pilot {
    fn sense(&mut self, car: &mut R, _time: f64, seen: &mut LidarObservation) -> io::Result<()> {
        seen.read(car)
    }
}

/// The arc to the point of a line at the lookahead distance.
fn pursue(line: &[Point], rear: Pose) -> Twist {
    let ahead = line.iter().map(|point| rear.to_local(*point)).filter(|point| point.x > 0.0);
    let off = |point: &Point| (point.coords.norm() - LOOK_AHEAD).abs();
    let Some(aim) = ahead.min_by(|a, b| off(a).total_cmp(&off(b))) else { return Twist::STOP };
    let curvature = 2.0 * aim.y / aim.coords.norm_squared().max(1.0);
    Twist::new(STROLL, STROLL * curvature)
}

/// Result of a second car's drive.
#[derive(Debug, Clone)]
pub(crate) struct Second {
    pub(crate) cones_hit: usize,
    pub(crate) trail: Vec<Passed>,
}

/// How a race ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// All laps, or the event, were driven.
    Finished,
    /// The time limit came first.
    TimedOut,
    /// The car stopped without a lane, or without cones that fit its map or event.
    Lost,
    /// The car stopped, but not behind the finish and before the end of the lane there; or its lap count
    /// differs from the referee's.
    Missed,
}

impl Ending {
    /// The ending for an outcome of the car; `complete` tells whether the referee saw the whole race.
    pub(super) fn of(outcome: RaceOutcome, complete: bool) -> Self {
        match outcome {
            RaceOutcome::Finished if complete => Self::Finished,
            RaceOutcome::Finished => Self::Missed,
            RaceOutcome::Lost => Self::Lost,
            _ => Self::TimedOut,
        }
    }
}

/// Result of a race.
#[derive(Debug, Clone)]
pub(crate) struct Outcome {
    pub(crate) verdict: RaceScore,
    /// How the race ended, or the error.
    pub(crate) ending: Result<Ending, String>,
    pub(crate) truth: RobotTruth,
    pub(crate) time: f64,
    /// Pose and speed of the car at every decision.
    pub(crate) trail: Vec<Passed>,
    /// Racing line in the world.
    pub(crate) line: Vec<Point>,
    /// For each flying lap on a racing line, the lap time divided by the quasi-steady optimum on that line.
    pub(crate) over_optimum: Vec<f64>,
    pub(crate) standing: Vec<bool>,
    /// Whether the car touched another one.
    pub(crate) touched: bool,
    /// Result of a second car.
    pub(crate) other: Option<Second>,
}

impl Outcome {
    /// Whether all laps were driven.
    pub(crate) fn is_finished(&self) -> bool {
        self.ending == Ok(Ending::Finished)
    }

    /// Whether all laps were driven without a penalty.
    pub(crate) fn is_clean(&self) -> bool {
        self.is_finished() && self.verdict.cones_hit + self.verdict.off_course == 0 && !self.touched
    }
}

/// A car's cone detection.
pub(super) struct Eyes {
    sensors: Sensors,
    camera: CameraSight,
    image: RgbImage,
}

impl Eyes {
    pub(super) fn new<R: RobotIo + ?Sized>(
        sensors: Sensors,
        resolution: Resolution,
        car: &mut R,
    ) -> io::Result<Self> {
        if sensors != Sensors::Lidar {
            car.set_resolution(resolution)?;
        }
        let camera = CameraSight::new(CameraMount::default());
        Ok(Self { sensors, camera, image: RgbImage::default() })
    }

    /// The cones around a car, and its own motion.
    pub(super) fn look<R: RobotIo + ?Sized>(
        &mut self,
        car: &mut R,
        seen: &mut RaceObservation,
    ) -> io::Result<()> {
        if self.sensors != Sensors::Camera {
            car.scan_into(&mut seen.scan)?;
            seen.cones = sightings(&seen.scan);
        }
        if self.sensors != Sensors::Lidar {
            car.image_into(&mut self.image)?;
            let found = self.camera.find(&self.image);
            let both = self.sensors == Sensors::Both;
            seen.cones = if both { self.camera.fuse(&seen.cones, &found) } else { found };
        }
        (seen.odometry, seen.speed) = (car.pose()?, car.speed()?);
        Ok(())
    }
}

/// A racer's plans, in its map's frame.
#[derive(Default)]
struct Plans {
    /// The first racing line.
    first: Vec<Point>,
    /// For each lap, the quasi-steady optimum on its racing line (s). `None` for laps that do not begin at
    /// full speed.
    optima: Vec<Option<f64>>,
    racing: bool,
}

impl Plans {
    fn see(&mut self, racer: &Racer, limits: &CarLimits) {
        let flying = std::mem::replace(&mut self.racing, racer.phase() == RacePhase::Racing) && self.racing;
        let points = racer.line().filter(|_| self.racing).map(LineTracker::points);
        if self.first.is_empty() {
            self.first = points.map(<[Point]>::to_vec).unwrap_or_default();
        }
        let optimum = |points: &[Point]| SpeedProfile::closed(points, limits).ok();
        if racer.laps() < self.optima.len() {
            return;
        }

        self.optima.resize(racer.laps(), None);
        self.optima.push(points.filter(|_| flying).and_then(optimum).map(|profile| profile.lap_time));
    }

    fn over_optimum(&self, lap_times: &[f64]) -> Vec<f64> {
        let pairs = lap_times.iter().zip(&self.optima);
        pairs.filter_map(|(time, optimum)| optimum.map(|optimum| time / optimum)).collect()
    }
}

/// Steady-state limits of the car, for the optimum.
pub(super) fn limits() -> Result<CarLimits, Failure> {
    CarLimits::of(&RobotSpec::race_car()).ok_or_else(|| Failure::run("a racing car without tyres"))
}

/// Races on a course.
pub(crate) fn race(course: &Course, settings: &Settings, stage: &Stage) -> Result<Outcome, Failure> {
    if let Some(event) = &course.event {
        return event::race(course, event, settings, stage);
    }
    let mut judge = Judge::new(course, stage.truth(0)?, 0).map_err(Failure::run)?;
    let car = stage.claim(0)?;
    let other = settings.other.then(|| Other::new(course, stage)).transpose()?;
    let mut plans = Plans::default();
    let limits = limits()?;
    let (driven, other) = thread::scope(|scope| {
        let limit = settings.limit(course);
        let other = other.map(|other| scope.spawn(move || other.drive(limit)));
        let mut car = car.ready()?;
        let driven = drive(course, settings, car.as_mut(), &mut judge, |racer| plans.see(racer, &limits));
        // A car that misses the message drives until the time limit.
        let told = if other.is_some() { car.send(OTHER, OVER) } else { Ok(()) };
        drop(car);
        let other = other.map(|other| other.join().expect("the second car's thread does not panic"));
        Ok::<_, Failure>((driven.and_then(|ending| told.map(|()| ending)), other.transpose()?))
    })?;
    let line = plans.first.iter().map(|point| course.start.to_world(*point)).collect();
    Ok(Outcome {
        over_optimum: plans.over_optimum(&judge.verdict().lap_times),
        verdict: judge.verdict().clone(),
        ending: driven.map_err(|error| Failure::from(error).to_string()),
        truth: judge.truth().clone(),
        time: judge.time(),
        trail: judge.trail().to_vec(),
        line,
        standing: judge.standing(),
        touched: judge.touched(),
        other,
    })
}

fn drive<R: RobotIo + ?Sized>(
    course: &Course,
    settings: &Settings,
    car: &mut R,
    judge: &mut Judge,
    mut see: impl FnMut(&Racer),
) -> io::Result<Ending> {
    let mut racer = Racer::new(course.parameters(settings.laps))?;
    let mut eyes = Eyes::new(settings.sensors, course.resolution(), car)?;
    let mut seeing = SensedBy::new(&mut racer, |car: &mut R, _, seen: &mut _| eyes.look(car, seen));
    let watch = |_: &mut R, racer: &SensedBy<'_, Racer, _>, _: &Judge| see(racer.behaviour());
    let outcome = judged(car, &mut seeing, settings.limit(course), judge, watch)?;
    Ok(Ending::of(outcome, judge.verdict().lap_times.len() == settings.laps))
}
