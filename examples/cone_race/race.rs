//! One race.

use image::RgbImage;
use roverlab::drive::cones::{CameraMount, CameraSight, RacePhase, Racer, Referee, Verdict, fuse, sightings};
use roverlab::geometry::{Point, Pose};
use roverlab::io::sim::NoiseModel;
use roverlab::io::sim::race::{CarTruth, Race, RaceCarSpec, RaceOptions};
use roverlab::io::{self, Camera, Drive, Lidar, LidarScan, Resolution};

use super::Sensors;
use super::course::Course;

/// What a race is made of, beside its course.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settings {
    pub(crate) laps: usize,
    pub(crate) sensors: Sensors,
    pub(crate) seed: u64,
    pub(crate) noise: f64,
    pub(crate) limit: Option<f64>,
}

/// What came out of a race.
#[derive(Debug, Clone)]
pub(crate) struct Outcome {
    pub(crate) verdict: Verdict,
    pub(crate) phase: RacePhase,
    pub(crate) truth: CarTruth,
    pub(crate) time: f64,
    pub(crate) odometry: Pose,
    /// Where the car was, how fast, and its heading, every 50 ms.
    pub(crate) trail: Vec<(Pose, f64)>,
    /// The racing line in the frame of the world.
    pub(crate) line: Vec<Point>,
    pub(crate) standing: Vec<bool>,
}

impl Outcome {
    /// Whether all laps were driven without a penalty.
    pub(crate) fn is_clean(&self) -> bool {
        self.phase == RacePhase::Finished && self.verdict.cones_hit + self.verdict.off_course == 0
    }
}

/// Races on a course.
pub(crate) fn race(course: &Course, settings: &Settings) -> io::Result<Outcome> {
    let Settings { laps, sensors, seed, noise, limit } = *settings;
    let parameters = course.parameters(laps);
    let options = RaceOptions { seed, noise: NoiseModel::real().scaled(noise), ..RaceOptions::default() };
    let mut world = Race::new(&course.race_cones(), &[(RaceCarSpec::default(), course.start)], options)?;
    let mut referee = Referee::new(course.corridor.clone(), Course::wheels());
    let mut racer = Racer::new(parameters);
    let (mut scan, mut image) = (LidarScan::default(), RgbImage::default());
    let mut camera = CameraSight::new(CameraMount::default());
    world.car(0)?.set_resolution(Resolution::Vga)?;
    // A first lap at a crawl, and all others at a walk.
    let limit = limit.unwrap_or(course.corridor.length() * (1.0 + laps as f64 / 3.0));
    let ticks = (parameters.period / 0.01).round().max(1.0) as usize;
    let (mut trail, mut line) = (Vec::new(), Vec::new());
    let mut odometry = Pose::default();
    while world.time() < limit {
        let mut car = world.car(0)?;
        let mut seen = Vec::new();
        if sensors != Sensors::Camera {
            car.scan_into(&mut scan)?;
            seen = sightings(&scan);
        }
        if sensors != Sensors::Lidar {
            car.image_into(&mut image)?;
            let found = camera.find(&image);
            seen = if sensors == Sensors::Both { fuse(&seen, &found) } else { found };
        }
        let (pose, speed) = (car.pose()?, car.speed()?);
        odometry = pose;
        let command = racer.decide(pose, speed, &seen);
        car.set_speed(command)?;
        for _ in 0..ticks {
            world.advance(0.01);
            if let Some(truth) = world.truth(0) {
                referee.see(world.time(), truth.pose, truth.hits);
            }
        }
        if let Some(truth) = world.truth(0) {
            trail.push((truth.pose, truth.twist.linear));
        }
        if racer.phase() == RacePhase::Racing && line.is_empty() {
            // The map's frame is that of the start.
            let points = racer.line().map(|line| line.points().to_vec()).unwrap_or_default();
            line = points.into_iter().map(|point| course.start.to_world(point)).collect();
        }
        if racer.phase() == RacePhase::Finished && speed.linear.abs() < 0.05 {
            break;
        }
    }
    let truth = world.truth(0).ok_or_else(|| io::Error::new(io::ErrorKind::Other, "the car is gone"))?;
    Ok(Outcome {
        verdict: referee.verdict().clone(),
        phase: racer.phase(),
        truth,
        time: world.time(),
        odometry,
        trail,
        line,
        standing: world.standing().collect(),
    })
}
