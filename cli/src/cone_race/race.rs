//! One race.

use image::RgbImage;
use roverlab::geometry::{Point, Pose, Twist};
use roverlab::io::sim::race::{Race, RaceCarSpec, RaceOptions};
use roverlab::io::sim::{NoiseModel, RobotTruth};
use roverlab::io::{self, Clock, LidarScan, RobotIo};
use roverlab::race::{
    CameraMount, CameraSight, CarLimits, Cone, ConeMap, Hold, LaneFinder, LineTracker, RacePhase, Racer,
    Sighting, SpeedProfile, Tyres, Verdict, sightings,
};

use super::Sensors;
use super::event;
use crate::common::{Driven, Failure, Stage};
use crate::cones::{Course, Judge, pass};

/// What a race is made of, beside its course.
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
    /// The world of a race.
    pub(crate) fn world(&self, course: &Course) -> io::Result<Race> {
        let noise = NoiseModel::real().scaled(self.noise);
        let options = RaceOptions { seed: self.seed, noise, ..RaceOptions::default() };
        let starts = [Some(course.start), self.other.then(|| course.ahead(HEAD_START))];
        let cars: Vec<_> =
            starts.into_iter().flatten().map(|start| (RaceCarSpec::default(), start)).collect();
        Race::new(&course.race_cones(), &cars, options)
    }
}

/// Metres that a second car is ahead at first.
const HEAD_START: f64 = 6.0;
/// Metres per second of a second car, metres that it looks ahead on its way, and those within which it counts on cones.
const STROLL: f64 = 3.0;
const LOOK_AHEAD: f64 = 3.5;
const SIGHT: f64 = 24.0;

/// The second car, which drives in the middle of the lane that it sees, whatever it was like a lap ago.
struct Other {
    car: Driven,
    scan: LidarScan,
    map: ConeMap,
    lane: LaneFinder,
    judge: Judge,
    decisions: u32,
}

impl Other {
    fn new(course: &Course, stage: &Stage) -> Result<Self, Failure> {
        let judge = Judge::new(course, stage.truth(1)?, 1).map_err(Failure::run)?;
        let parameters = course.parameters(1);
        Ok(Self {
            car: stage.robot(1)?,
            scan: LidarScan::default(),
            map: ConeMap::new(parameters.map),
            lane: LaneFinder::new(parameters.lane),
            judge,
            decisions: 0,
        })
    }

    /// Steers at every second decision of the racer, which is ten times a second.
    fn act(&mut self) -> io::Result<()> {
        self.decisions += 1;
        if !self.decisions.is_multiple_of(2) {
            return Ok(());
        }
        self.car.scan_into(&mut self.scan)?;
        self.map.update(self.car.pose()?, &sightings(&self.scan));
        let pose = self.map.pose();
        let near: Vec<Cone> =
            self.map.fresh_cones().filter(|cone| (cone.position - pose.position()).norm() < SIGHT).collect();
        let middle = pose.compose(&Pose::new(0.5 * RaceCarSpec::default().wheelbase(), 0.0, 0.0));
        let lane = self.lane.step(middle, &near);
        // Without a lane it stands, and looks on.
        let command = lane.map_or(Twist::STOP, |lane| pursue(&lane.points, pose));
        self.car.set_speed(command)
    }
}

/// The way on a circle to the point of a line that is some metres ahead.
fn pursue(line: &[Point], rear: Pose) -> Twist {
    let ahead = line.iter().map(|point| rear.to_local(*point)).filter(|point| point.x > 0.0);
    let off = |point: &Point| (point.coords.norm() - LOOK_AHEAD).abs();
    let Some(aim) = ahead.min_by(|a, b| off(a).total_cmp(&off(b))) else { return Twist::STOP };
    let curvature = 2.0 * aim.y / aim.coords.norm_squared().max(1.0);
    Twist::new(STROLL, STROLL * curvature)
}

/// What came out of a second car's drive.
#[derive(Debug, Clone)]
pub(crate) struct Second {
    pub(crate) cones_hit: usize,
    /// Whether the two cars touched.
    pub(crate) touched: bool,
    pub(crate) trail: Vec<(Pose, f64)>,
}

/// Two cars to which time passes when the first one waits. The second one gets to notice it: its safety system has to look.
struct Both<'a, R: ?Sized> {
    waits: &'a mut R,
    other: &'a mut (dyn RobotIo + Send),
}

impl<R: Clock + ?Sized> Clock for Both<'_, R> {
    fn now(&mut self) -> io::Result<f64> {
        self.waits.now()
    }

    fn wait(&mut self, seconds: f64) -> io::Result<()> {
        self.waits.wait(seconds)?;
        self.other.wait(0.0)
    }
}

/// How a race ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// All laps were driven, or the event.
    Finished,
    /// Time was over.
    TimedOut,
    /// The car stood without a lane, or without cones that fit its map or its event.
    Lost,
    /// The car stood, but not behind the finish and before the end of the lane there; or it counted other laps than the referee.
    Missed,
}

/// What came out of a race.
#[derive(Debug, Clone)]
pub(crate) struct Outcome {
    pub(crate) verdict: Verdict,
    /// How far it came, or what failed.
    pub(crate) ending: Result<Ending, String>,
    pub(crate) truth: RobotTruth,
    pub(crate) time: f64,
    /// Where the car was, and how fast, at every decision.
    pub(crate) trail: Vec<(Pose, f64)>,
    /// The racing line in the frame of the world.
    pub(crate) line: Vec<Point>,
    /// Of each flying lap on a racing line, the lap time over the quasi-steady optimum on that line.
    pub(crate) over_optimum: Vec<f64>,
    pub(crate) standing: Vec<bool>,
    /// What became of a second car.
    pub(crate) other: Option<Second>,
}

impl Outcome {
    /// Whether all laps were driven.
    pub(crate) fn is_finished(&self) -> bool {
        self.ending == Ok(Ending::Finished)
    }

    /// Whether all laps were driven without a penalty.
    pub(crate) fn is_clean(&self) -> bool {
        let touched = self.other.as_ref().is_some_and(|other| other.touched);
        self.is_finished() && self.verdict.cones_hit + self.verdict.off_course == 0 && !touched
    }
}

/// What a car sees cones with.
pub(super) struct Eyes {
    sensors: Sensors,
    camera: CameraSight,
    scan: LidarScan,
    image: RgbImage,
}

impl Eyes {
    pub(super) fn new(sensors: Sensors) -> Self {
        let camera = CameraSight::new(CameraMount::default());
        Self { sensors, camera, scan: LidarScan::default(), image: RgbImage::default() }
    }

    /// The cones around a car.
    pub(super) fn look<R: RobotIo + ?Sized>(&mut self, car: &mut R) -> io::Result<Vec<Sighting>> {
        let mut seen = Vec::new();
        if self.sensors != Sensors::Camera {
            car.scan_into(&mut self.scan)?;
            seen = sightings(&self.scan);
        }
        if self.sensors != Sensors::Lidar {
            car.image_into(&mut self.image)?;
            let found = self.camera.find(&self.image);
            seen = if self.sensors == Sensors::Both { self.camera.fuse(&seen, &found) } else { found };
        }
        Ok(seen)
    }
}

/// What a racer has planned, in its map's frame.
#[derive(Default)]
struct Plans {
    /// The first racing line.
    first: Vec<Point>,
    /// Of each lap: seconds of the quasi-steady optimum on its racing line. `None` for laps that do not begin at full speed.
    optima: Vec<Option<f64>>,
    racing: bool,
}

impl Plans {
    fn see(&mut self, racer: &Racer) {
        let flying = std::mem::replace(&mut self.racing, racer.phase() == RacePhase::Racing) && self.racing;
        let points = racer.line().filter(|_| self.racing).map(LineTracker::points);
        if self.first.is_empty() {
            self.first = points.map(<[Point]>::to_vec).unwrap_or_default();
        }
        let optimum = |points: &[Point]| SpeedProfile::closed(points, &limits(&RaceCarSpec::default())).ok();
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

/// What a car can do at most, in balance: what the optimum is for.
pub(super) fn limits(spec: &RaceCarSpec) -> CarLimits {
    CarLimits {
        hold: Hold::Balance(Tyres {
            grip: spec.grip,
            stiffness: spec.stiffness * 9.81,
            front: spec.balance,
            wheelbase: spec.wheelbase(),
            lock: spec.max_steering,
        }),
        drive: spec.drive,
        brake: spec.brake,
        top_speed: spec.top_speed,
        turning: f64::INFINITY,
    }
}

/// Races on a course.
pub(crate) fn race(course: &Course, settings: &Settings, stage: &Stage) -> Result<Outcome, Failure> {
    if let Some(event) = &course.event {
        return event::race(course, event, settings, stage);
    }
    let mut judge = Judge::new(course, stage.truth(0)?, 0).map_err(Failure::run)?;
    let mut car = stage.robot(0)?;
    let mut other = settings.other.then(|| Other::new(course, stage)).transpose()?;
    let mut plans = Plans::default();
    let driven = drive(course, settings, car.as_mut(), (&mut judge, other.as_mut()), &mut plans);
    // The second car goes first: while the other one may have to stop, nobody looks at it.
    let other = other.map(|other| Second {
        cones_hit: other.judge.verdict().cones_hit,
        touched: judge.touched(),
        trail: other.judge.trail().to_vec(),
    });
    drop(car);
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
        other,
    })
}

fn drive<R: RobotIo + ?Sized>(
    course: &Course,
    settings: &Settings,
    car: &mut R,
    (judge, mut other): (&mut Judge, Option<&mut Other>),
    plans: &mut Plans,
) -> io::Result<Ending> {
    let parameters = course.parameters(settings.laps);
    let mut racer = Racer::new(parameters);
    let mut eyes = Eyes::new(settings.sensors);
    if settings.sensors != Sensors::Lidar {
        car.set_resolution(course.resolution())?;
    }
    // A first lap at a crawl, and all others at a walk.
    let slow = if settings.other { 2.0 } else { 3.0 };
    let limit = settings.limit.unwrap_or(course.corridor.length() * (1.0 + settings.laps as f64 / slow));
    while judge.time() < limit {
        let seen = eyes.look(car)?;
        let (pose, speed) = (car.pose()?, car.speed()?);
        car.set_speed(racer.decide(pose, speed, &seen))?;
        match &mut other {
            Some(other) => {
                other.act()?;
                let mut both = Both { waits: &mut *car, other: other.car.as_mut() };
                pass(&mut both, &mut [&mut *judge, &mut other.judge], parameters.period)?;
            }
            None => pass(car, &mut [&mut *judge], parameters.period)?,
        }
        plans.see(&racer);
        if racer.is_done(speed) {
            break;
        }
    }
    Ok(match racer.phase() {
        RacePhase::Finished if judge.verdict().lap_times.len() == settings.laps => Ending::Finished,
        RacePhase::Finished => Ending::Missed,
        RacePhase::Lost => Ending::Lost,
        RacePhase::Mapping | RacePhase::Racing => Ending::TimedOut,
    })
}
