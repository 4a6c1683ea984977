//! Shared parts of the driving commands: an observed simulated robot, and the report on its run.

mod looking;
mod way;

use std::sync::Arc;

use roverlab::geometry::{Point, Pose, Twist, units};
use roverlab::io::log::GroundTruth;
use roverlab::io::sim::{NoiseModel, RobotTruth, SimOptions};
use roverlab::io::{self, Drive, Key, TruthInSpace};
use roverlab::kinematics::OdometryErrors;
use roverlab::picture::{Mark, Picture, Style};
use roverlab::scan::{LocalisationMap, LocaliserParameters};
use roverlab::world::{Colour, DriveSpec, Footprint, Object, ObjectKind, RobotSpec, Scene, Shape, World};

use crate::common::{CommonArgs, Driven, Failure, Outcome, Pacer, Report, Stage};

pub(crate) use looking::{Looking, in_time};
pub(crate) use way::Way;

/// Conditions of a simulation.
#[derive(Debug, Clone)]
pub(crate) struct Conditions {
    pub(crate) seed: u64,
    pub(crate) noise: f64,
    /// Brightness of the light for cameras.
    pub(crate) light: f64,
    /// Key presses with their times (s).
    pub(crate) keys: Vec<(f64, Key)>,
    /// Whether robots push loose, light objects.
    pub(crate) pushing: bool,
    /// Constant velocities of other robots, by index.
    pub(crate) others: Vec<(usize, Twist)>,
    pub(crate) ideal_encoders: bool,
    /// Time limit (s).
    pub(crate) time_limit: f64,
    /// Time that the simulator adds to the limit (s): [`RESERVE`], or 0 for a program that leaves its limit
    /// to the simulator.
    pub(crate) reserve: f64,
    /// Options that select the robot's source; without them, an unrecorded simulator.
    pub(crate) common: Option<CommonArgs>,
}

/// Time after which the simulator ends a program with a limit of its own, such as one whose clock has stopped
/// (s).
pub(crate) const RESERVE: f64 = 1.0;

/// Poses of a robot with their times (s).
pub(crate) type Trail = Vec<(f64, Pose)>;

/// End of a robot's program: its result, or the robot's error.
pub(crate) type Ending<T> = Result<T, String>;

/// A run with its ground truth.
#[derive(Debug, Clone)]
pub(crate) struct Run<T> {
    pub(crate) ending: Ending<T>,
    pub(crate) truth: RobotTruth,
    /// Pose by odometry, in the world.
    pub(crate) odometry: Pose,
    /// Simulated time (s).
    pub(crate) sim_time: f64,
    /// True path, and path by odometry.
    pub(crate) trail: Trail,
    pub(crate) odometry_path: Vec<(f64, Point)>,
    /// True paths of the other moving robots.
    pub(crate) others: Vec<Trail>,
    /// Final positions of the scene's objects.
    pub(crate) objects: Vec<Point>,
    /// Where the robot was in space, in a world with hills or water, at each moment of the trail but the
    /// first.
    pub(crate) in_space: Vec<TruthInSpace>,
}

impl Conditions {
    pub(crate) fn new(common: &CommonArgs, time_limit: f64) -> Result<Self, Failure> {
        // Wrong ones are detected before anything begins.
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
            reserve: RESERVE,
            common: Some(common.clone()),
        })
    }

    /// The known error model of the robot's odometry.
    pub(crate) fn odometry_errors(&self) -> OdometryErrors {
        let NoiseModel { wheel_scale, wheel_mismatch, track, slip, .. } =
            NoiseModel::real().scaled(self.noise);
        OdometryErrors { wheel_scale, wheel_mismatch, track, slip }
    }

    /// Parameters of a localiser that knows how wrong the robot's lidar and its odometry are. The usual ones
    /// are enough for noise of up to 1.
    pub(crate) fn localiser(&self, spec: &RobotSpec) -> LocaliserParameters {
        let parameters = LocaliserParameters {
            range_error: NoiseModel::real().scaled(self.noise).range,
            radius: spec.footprint.bounding_radius(),
            ..LocaliserParameters::default()
        };
        let track = track(spec);
        if self.noise <= 1.0 || !track.is_finite() {
            return parameters;
        }
        let (known, least) = (self.odometry_errors(), parameters.odometry);
        let odometry = OdometryErrors {
            wheel_scale: known.wheel_scale.max(least.wheel_scale),
            wheel_mismatch: known.wheel_mismatch.max(least.wheel_mismatch),
            ..known
        };
        LocaliserParameters { odometry, track, ..parameters }
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

    /// The same with a watcher that gets the true pose at each step.
    pub(crate) fn run_watched<T>(
        &self,
        scene: &Scene,
        mut watch: impl FnMut(f64),
        program: impl FnOnce(&mut Driven, &mut dyn FnMut() -> Pose) -> io::Result<T>,
    ) -> Result<Run<T>, Failure> {
        let options = SimOptions {
            time_limit: Some(self.time_limit + self.reserve),
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
            // A robot whose program has ended keeps its speed.
            stage.robot(other)?.set_speed(twist).map_err(Failure::run)?;
        }
        let mut robot = stage.robot(0)?;
        let mut truth = stage.truth(0)?;
        let (mut trail, mut odometry_path) = (vec![(0.0, start)], vec![(0.0, start.position())]);
        let has_hills = scene.world.terrain.is_some() || scene.world.water_level.is_some();
        let mut in_space = Vec::new();
        let mut others: Vec<Trail> = self.others.iter().map(|_| Trail::new()).collect();
        let result = program(&mut robot, &mut || {
            let seen = truth.robot(0);
            let time = truth.time().unwrap_or_default();
            if let Ok(robot) = seen {
                trail.push((time, robot.pose));
                odometry_path.push((time, start.compose(&robot.odometry).position()));
            }
            if has_hills {
                in_space.extend(truth.in_space(0).ok());
            }
            for (other, trail) in self.others.iter().zip(&mut others) {
                trail.extend(truth.pose(other.0).ok().map(|pose| (time, pose)));
            }
            watch(time);
            trail.last().map_or(start, |(_, pose)| *pose)
        });
        // Dropping the robot freezes the world, and therefore the ground truth.
        drop(robot);
        let objects = scene.world.objects.iter().enumerate().map(|(index, object)| {
            // Objects that cannot be pushed stay in place.
            let moved = if self.pushing { truth.object(index).ok() } else { None };
            moved.unwrap_or(object.pose).position()
        });
        let objects = objects.collect();
        let end = truth.robot(0).map_err(Failure::run)?;
        Ok(Run {
            ending: result.map_err(|error| Failure::from(error).to_string()),
            odometry: start.compose(&end.odometry),
            sim_time: truth.time().map_err(Failure::run)?,
            truth: end,
            trail,
            odometry_path,
            others,
            objects,
            in_space,
        })
    }
}

/// Fails if a run that lasts until its time limit (s) ended well before it: the robot's clock has jumped
/// ahead.
pub(crate) fn check_lasted(sim_time: f64, limit: f64) -> Ending<()> {
    if sim_time + RESERVE >= limit {
        return Ok(());
    }
    Err(format!("the robot's clock ended the run of {limit} s after {sim_time:.1} s"))
}

impl<T> Run<T> {
    /// The same for a run that lasts until its time limit (s); it has failed if the robot's clock ended it
    /// early.
    pub(crate) fn lasting(self, limit: f64) -> Self {
        let ending = self.ending.and_then(|ended| check_lasted(self.sim_time, limit).map(|()| ended));
        Self { ending, ..self }
    }

    /// A report with the run's ground truth and the outcome determined by `outcome`.
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
            in_space: self.in_space.last().map(|space| space.pose),
            odometry: Some(self.odometry),
            error,
            ..Report::new(outcome)
        }
    }

    /// True positions of the robot.
    pub(crate) fn positions(&self) -> impl Iterator<Item = Point> {
        self.trail.iter().map(|(_, pose)| pose.position())
    }

    /// Draws a robot's drive, start, odometry and contacts.
    pub(crate) fn draw(&self, picture: &mut Picture, spec: &RobotSpec) {
        picture.drive(&self.trail, &spec.footprint);
        picture.trace(self.odometry_path.iter().copied(), Style::odometry());
        picture.mark(Mark::Start, self.trail[0].1.position());
        draw_contacts(picture, &self.truth.contact_places);
    }
}

/// Paces simulated time by the wall clock, if requested.
pub(crate) fn paced(common: &CommonArgs) -> impl FnMut(f64) {
    let (pacer, realtime) = (Pacer::start(), common.realtime);
    move |time| {
        if realtime {
            pacer.keep(time);
        }
    }
}

/// Draws the contacts of robots.
pub(crate) fn draw_contacts(picture: &mut Picture, places: &[Point]) {
    for &place in places {
        picture.mark(Mark::Contact, place);
    }
}

/// Style of standing robots and former poses.
pub(crate) fn pale() -> Style {
    Style::new(Colour::from_hex(0x8a_90_9c)).opacity(0.5)
}

/// A number with its noun.
pub(crate) fn counted(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

/// Distance between a robot's left and right wheels (m).
pub(crate) fn track(spec: &RobotSpec) -> f64 {
    match spec.drive {
        DriveSpec::Differential { track, .. }
        | DriveSpec::Ackermann { track, .. }
        | DriveSpec::Tracked { track, .. }
        | DriveSpec::Omni { track, .. } => track,
        _ => f64::NAN,
    }
}

/// The world for the first robot of a scene, with the other robots as obstacles.
pub(crate) fn world_with_others(scene: &Scene) -> World {
    let mut world = scene.world.clone();
    for other in &scene.robots[1..] {
        let height = other.spec.height;
        let (shape, middle) = if let Footprint::Rectangle(outline) = other.spec.footprint {
            let (size, middle) = (outline.size(), outline.min + outline.size() * 0.5);
            (Shape::Box { length: size.x, width: size.y, height }, Pose::new(middle.x, middle.y, 0.0))
        } else {
            let radius = other.spec.footprint.bounding_radius();
            (Shape::Cylinder { radius, height }, Pose::default())
        };
        let kind = ObjectKind { fixed: true, ..ObjectKind::new(&other.spec.name, shape, Colour::BLUE) };
        let object = Object::new(Arc::new(kind), other.pose.compose(&middle));
        world.objects.push(Object { elevation: other.elevation, ..object });
    }
    world
}

/// The map for the first robot of a scene, whose lidar passes over what is lower.
pub(crate) fn localisation_map(scene: &Scene) -> io::Result<LocalisationMap> {
    let robot = &scene.robots[0];
    let height = robot.elevation + robot.spec.lidar.unwrap_or_default().mount.z;
    LocalisationMap::at_height(&world_with_others(scene), height)
}

/// Rejects a robot without a lidar.
pub(crate) fn check_lidar(scene: &Scene) -> Result<(), Failure> {
    match scene.robots[0].spec.lidar {
        Some(_) => Ok(()),
        None => Err(Failure::input("found a robot without a lidar; expected one with a lidar")),
    }
}

/// Largest angle of a beam to the floor at which it counts as level (rad): over 10 m it rises by 10 mm.
const LEVEL: f64 = 1e-3;

/// Rejects a robot without a lidar, and one whose beams pass over walls or meet the floor, because maps have
/// no heights.
pub(crate) fn check_level_lidar(scene: &Scene) -> Result<(), Failure> {
    check_lidar(scene)?;
    let lidar = scene.robots[0].spec.lidar.unwrap_or_default();
    let steepest =
        [lidar.tilt, lidar.mount.pitch, lidar.mount.roll].map(f64::abs).into_iter().fold(0.0, f64::max);
    if steepest > LEVEL {
        let degrees = units::to_deg(steepest);
        return Err(Failure::input(format!(
            "found a lidar tilted by {degrees:.1} degrees; expected a level one, as maps have no heights"
        )));
    }
    Ok(())
}

/// Rejects a robot with an unsuitable drive.
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
