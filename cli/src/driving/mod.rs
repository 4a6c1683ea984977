//! What the driving commands share: a simulated robot that is watched, and what is said about its run.

mod way;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use roverlab::geometry::{Point, Pose, Twist};
use roverlab::io::log::GroundTruth;
use roverlab::io::sim::{NoiseModel, RobotTruth, SimOptions};
use roverlab::io::{self, Drive, Key};
use roverlab::kinematics::OdometryErrors;
use roverlab::picture::{Picture, SaveError};
use roverlab::world::{Colour, DriveSpec, Object, ObjectKind, RobotSpec, Scene, Shape, World};

use crate::common::{
    CommonArgs, Driven, Failure, Outcome, Pacer, Report, Stage, StageTruth, onlooker,
};

pub(crate) use way::Way;

/// How the simulator runs.
#[derive(Debug, Clone)]
pub(crate) struct Conditions {
    pub(crate) seed: u64,
    pub(crate) noise: f64,
    /// Brightness of the light that cameras see by.
    pub(crate) light: f64,
    /// Key presses and when, in seconds.
    pub(crate) keys: Vec<(f64, Key)>,
    /// Whether robots push what is loose and light.
    pub(crate) pushing: bool,
    /// Speeds that other robots keep, by their indices.
    pub(crate) others: Vec<(usize, Twist)>,
    pub(crate) ideal_encoders: bool,
    /// Simulated seconds.
    pub(crate) time_limit: f64,
    /// What decides where the robot comes from; a simulator that nobody records without it.
    pub(crate) common: Option<CommonArgs>,
}

/// How a robot's program ended: what it says, or why the robot failed.
pub(crate) type Ending<T> = Result<T, String>;

/// A run and what is true about it.
#[derive(Debug, Clone)]
pub(crate) struct Run<T> {
    pub(crate) ending: Ending<T>,
    pub(crate) truth: RobotTruth,
    /// Where odometry takes the robot to be in the world.
    pub(crate) odometry: Pose,
    /// Simulated seconds.
    pub(crate) sim_time: f64,
    pub(crate) true_path: Vec<Pose>,
    pub(crate) odometry_path: Vec<Point>,
    /// Where the scene's objects are at the end.
    pub(crate) objects: Vec<Point>,
}

impl Conditions {
    pub(crate) fn new(common: &CommonArgs, time_limit: f64) -> Result<Self, Failure> {
        // Wrong ones are found before anything begins.
        common.faults()?;
        Ok(Self {
            seed: common.seed,
            noise: common.noise,
            light: 1.0,
            keys: Vec::new(),
            pushing: false,
            others: Vec::new(),
            ideal_encoders: false,
            time_limit: common.time_limit.unwrap_or(time_limit),
            common: Some(common.clone()),
        })
    }

    /// The errors that the robot's odometry is known to have.
    pub(crate) fn odometry_errors(&self) -> OdometryErrors {
        let NoiseModel { wheel_scale, wheel_mismatch, track, slip, .. } =
            NoiseModel::real().scaled(self.noise);
        OdometryErrors { wheel_scale, wheel_mismatch, track, slip }
    }

    /// Lets a program drive the first robot of a scene. `watch` is called with the time at each of its steps.
    pub(crate) fn run<T>(
        &self,
        scene: &Scene,
        watch: impl FnMut(f64),
        program: impl FnOnce(&mut Driven, &mut dyn FnMut()) -> io::Result<T>,
    ) -> Result<Run<T>, Failure> {
        self.run_watched(scene, watch, |robot, step| {
            program(robot, &mut || {
                step();
            })
        })
    }

    /// The same for a program with a watcher, who learns the true pose at each step.
    pub(crate) fn run_watched<T>(
        &self,
        scene: &Scene,
        mut watch: impl FnMut(f64),
        program: impl FnOnce(&mut Driven, &mut dyn FnMut() -> Pose) -> io::Result<T>,
    ) -> Result<Run<T>, Failure> {
        // The program's own limit comes first, unless its clock has stopped.
        const RESERVE: f64 = 1.0;
        let options = SimOptions {
            time_limit: Some(self.time_limit + RESERVE),
            ideal_encoders: self.ideal_encoders,
            light: self.light,
            pushing: self.pushing,
            ..SimOptions::with_noise(self.noise, self.seed)
        };
        let stage = match &self.common {
            Some(common) => common.stage(scene, options)?,
            None => Stage::simulated(scene, options, Vec::new())?,
        };
        for &(time, key) in &self.keys {
            stage.press_key(0, time, key).map_err(Failure::input)?;
        }
        let start = scene.robots[0].pose;
        for &(other, twist) in &self.others {
            // A robot whose program ends keeps its speed.
            stage.robot(other)?.set_speed(twist).map_err(Failure::run)?;
        }
        let mut robot = stage.robot(0)?;
        let mut truth = stage.truth(0)?;
        let (mut true_path, mut odometry_path) = (vec![start], vec![start.position()]);
        let result = program(&mut robot, &mut || {
            if let Ok(robot) = truth.robot(0) {
                true_path.push(robot.pose);
                odometry_path.push(start.compose(&robot.odometry).position());
            }
            watch(truth.time().unwrap_or_default());
            *true_path.last().unwrap_or(&start)
        });
        // The robot lets go of the world, so that what is true stays as it is.
        drop(robot);
        let objects = scene.world.objects.iter().enumerate().map(|(index, object)| {
            // What nobody pushes stays where it was.
            let moved = if self.pushing { truth.object(index).ok() } else { None };
            moved.unwrap_or(object.pose).position()
        });
        let objects = objects.collect();
        let run = finish(result, &mut truth, start, true_path, odometry_path)?;
        Ok(Run { objects, ..run })
    }
}

fn finish<T>(
    result: io::Result<T>,
    truth: &mut StageTruth,
    start: Pose,
    true_path: Vec<Pose>,
    odometry_path: Vec<Point>,
) -> Result<Run<T>, Failure> {
    let end = truth.robot(0).map_err(Failure::run)?;
    Ok(Run {
        ending: result.map_err(|error| Failure::from(error).to_string()),
        odometry: start.compose(&end.odometry),
        sim_time: truth.time().map_err(Failure::run)?,
        truth: end,
        true_path,
        odometry_path,
        objects: Vec::new(),
    })
}

impl<T> Run<T> {
    /// A report with what is true about the run and with the outcome that `outcome` finds.
    pub(crate) fn report(&self, outcome: impl FnOnce(&T) -> Outcome) -> Report {
        let (outcome, error) = match &self.ending {
            Ok(ended) => (outcome(ended), None),
            Err(error) if error.contains("time limit") => (Outcome::failure("timed_out"), None),
            Err(error) => (Outcome::failure("failed"), Some(error.clone())),
        };
        Report {
            sim_time: Some(self.sim_time),
            collisions: Some(self.truth.contacts.into()),
            path_length: Some(self.truth.path_length),
            pose: Some(self.truth.pose),
            odometry: Some(self.odometry),
            error,
            ..Report::new(outcome)
        }
    }

    /// Where the robot really was.
    pub(crate) fn positions(&self) -> impl Iterator<Item = Point> {
        self.true_path.iter().map(Pose::position)
    }
}

/// Keeps simulated time from running ahead of the wall clock, if the options ask for it.
pub(crate) fn paced(common: &CommonArgs) -> impl FnMut(f64) {
    let (pacer, realtime) = (Pacer::start(), common.realtime);
    move |time| {
        if realtime {
            pacer.keep(time);
        }
    }
}

/// Draws a run, though never unasked where a program reads the report. Returns the file, if there is one, and what went
/// wrong.
pub(crate) fn drawn(
    common: &CommonArgs,
    name: &str,
    picture: impl FnOnce() -> Picture,
) -> (Option<PathBuf>, Option<String>) {
    // Who looks on wants the picture itself.
    let mut picture = Some(picture);
    if onlooker::is_there() {
        picture.take().map(onlooker::pictured);
    }
    let (Some(picture), Some(file)) = (picture, common.picture_file(name)) else { return (None, None) };
    match save(&picture(), &file) {
        Ok(()) => {
            common.tell(format_args!("picture: {}", file.display()));
            (Some(file), None)
        }
        Err(error) => (None, Some(Failure::from(error).to_string())),
    }
}

fn save(picture: &Picture, file: &Path) -> Result<(), SaveError> {
    picture.save(file)
}

/// Some things by their number.
pub(crate) fn counted(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

/// Metres between a robot's left and right wheels.
pub(crate) fn track(spec: &RobotSpec) -> f64 {
    match spec.drive {
        DriveSpec::Differential { track, .. }
        | DriveSpec::Ackermann { track, .. }
        | DriveSpec::Omni { track, .. } => track,
        _ => f64::NAN,
    }
}

/// The world as the first robot of a scene finds it: the others stand in it.
pub(crate) fn world_with_others(scene: &Scene) -> World {
    let mut world = scene.world.clone();
    for other in &scene.robots[1..] {
        let radius = other.spec.footprint.bounding_radius();
        let shape = Shape::Cylinder { radius, height: other.spec.height };
        let kind = ObjectKind { fixed: true, ..ObjectKind::new(&other.spec.name, shape, Colour::BLUE) };
        world.objects.push(Object::new(Arc::new(kind), other.pose));
    }
    world
}

/// Refuses a robot without a lidar.
pub(crate) fn check_lidar(scene: &Scene) -> Result<(), Failure> {
    match scene.robots[0].spec.lidar {
        Some(_) => Ok(()),
        None => Err(Failure::input("found a robot without a lidar; expected one with a lidar")),
    }
}

/// Refuses a robot with a drive that the command has no use for.
pub(crate) fn check_drive(
    common: &CommonArgs,
    spec: &RobotSpec,
    good: bool,
    expected: &str,
) -> Result<(), Failure> {
    if good {
        return Ok(());
    }
    let file = common.robot.as_ref().or(common.world.as_ref());
    let place = file.map_or(String::new(), |file| format!("{}: ", file.display()));
    Err(Failure::input(format!("{place}found robot {} with another drive; expected {expected}", spec.name)))
}
