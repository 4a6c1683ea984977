//! Driving to what moves.

use image::GrayImage;
use roverlab::drive::motion_watch::{ApproachOutcome, MotionApproach, MotionApproachParameters};
use roverlab::geometry::{Pose, Twist, units};
use roverlab::io::sim::Truth;
use roverlab::io::{self, Camera, Clock, Drive, Odometry, Resolution, control};
use roverlab::vision::motion::{FlowDetector, Motion};
use roverlab::vision::{CameraGeometry, ImageError};
use roverlab::world::{CameraSpec, Scene};

use super::campaign::wrong;
use super::watch::{Seen, bearing, show};
use super::{Args, scene};
use crate::common::{Failure, Outcome, Report, portable, rounded, wrong_seeds};
use crate::driving::{Conditions, Run};

/// Time limit of an approach in a campaign (s).
const TIME_LIMIT: f64 = 60.0;
/// Speed at which moving robots are to be found (m/s), and number of pairs in a scene, 0.1 s apart.
const SPEED: f64 = 0.2;
const IN_A_SCENE: usize = 25;
/// Number of pairs in which a moving robot must be in view.
const IN_VIEW: usize = 5;
/// True distance between the centres of two robots at which one has reached the other (m).
const REACHED: f64 = 0.5;
/// Distance from the other robot at which a drive past it ends (m).
const CLOSE: f64 = 0.3;

/// Shares of robots to be found and reached, and number of pairs per allowed false alarm.
const WANTED: (f64, f64, usize) = (0.98, 0.95, 1000);

/// Drives to what moves.
pub(super) fn run(
    conditions: &Conditions,
    scene: &Scene,
    camera: &CameraSpec,
    watch: impl FnMut(f64),
) -> Result<Run<Seen>, Failure> {
    let mut approach = MotionApproach::new(parameters(camera)?).map_err(Failure::input)?;
    conditions.run(scene, watch, |robot, step| {
        let mut seen = Seen::default();
        let outcome = control::run(robot, &mut approach, conditions.time_limit, |robot, approach, at| {
            step();
            show(robot, approach.motion(), &at.seen.image)?;
            seen.take(at.time, approach.motion());
            io::Result::Ok(())
        })?;
        seen.is_reached = outcome == ApproachOutcome::Reached;
        Ok(seen)
    })
}

/// Parameters for a camera, which must be level.
fn parameters(camera: &CameraSpec) -> Result<MotionApproachParameters, Failure> {
    if camera.tilt != 0.0 || camera.fisheye || camera.mount.y != 0.0 || camera.mount.yaw != 0.0 {
        return Err(Failure::input(
            "--approach: found a camera that is tilted, aside or a fisheye; expected a level one on the robot's axis",
        ));
    }
    let geometry =
        CameraGeometry { field_of_view: camera.field_of_view, height: camera.mount.z, ahead: camera.mount.x };
    Ok(MotionApproachParameters::new(geometry))
}

/// Outcome of an approach.
pub(super) fn outcome(is_reached: bool) -> Outcome {
    if is_reached { Outcome::verdict("reached") } else { Outcome::failure("timed_out") }
}

/// True distance from the nearest other robot at the end (m).
pub(super) fn distance(run: &Run<Seen>, scene: &Scene) -> Option<f64> {
    let still = scene.robots.iter().skip(1).map(|robot| robot.pose);
    let last = still.enumerate().map(|(index, start)| {
        run.others.get(index).and_then(|trail| trail.last()).map_or(start, |(_, pose)| *pose)
    });
    last.map(|pose| run.truth.pose.distance_to(pose.position())).reduce(f64::min)
}

/// Result of a scene.
#[derive(Debug, Clone, Copy)]
struct Trial {
    /// Pairs and alarms while nothing moves.
    still: (usize, usize),
    /// Whether the moving robot was found; `None` if it was hardly in view.
    found: Option<bool>,
    reached: bool,
}

portable!(struct Trial { still, found, reached });

/// Many scenes.
pub(super) fn campaign(args: &Args) -> Result<Report, Failure> {
    let trials = args.parts.share_out(&args.common.origin, "scenes", args.scenes, None, |index| {
        let seed = args.common.seed.wrapping_add(index);
        Ok((seed, trial(args, seed)?))
    })?;
    let all = || trials.iter().map(|(_, trial)| trial);
    let pairs: usize = all().map(|trial| trial.still.0).sum();
    let alarms: usize = all().map(|trial| trial.still.1).sum();
    let in_view = all().filter(|trial| trial.found.is_some()).count();
    let found = all().filter(|trial| trial.found == Some(true)).count() as f64 / in_view.max(1) as f64;
    let reached = all().filter(|trial| trial.reached).count() as f64 / args.scenes as f64;
    let passed = found >= WANTED.0 && reached >= WANTED.1 && alarms * WANTED.2 <= pairs;
    let outcome = if passed { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    Ok(Report::new(outcome)
        .field("scenes", args.scenes)
        .field("pairs", pairs)
        .field("false_alarms", alarms)
        .field("in_view", in_view)
        .field("found", rounded(found))
        .field("reached", rounded(reached))
        .field("missed_seeds", wrong_seeds(&trials, |trial| trial.found != Some(false)))
        .field("lost_seeds", wrong_seeds(&trials, |trial| trial.reached)))
}

fn trial(args: &Args, seed: u64) -> Result<Trial, Failure> {
    let still = passing(args, seed, false)?;
    let moving = passing(args, seed, true)?;
    let seen = moving.iter().filter(|(in_view, _)| *in_view);
    let found = (seen.clone().count() >= IN_VIEW).then(|| seen.clone().any(|(_, alarm)| *alarm));
    let alarms = still.iter().filter(|(_, alarm)| *alarm).count();
    Ok(Trial { still: (still.len(), alarms), found, reached: reached(args, seed)? })
}

/// Drives straight past the other robot: for each pair of images, whether that was in view, and an alarm.
fn passing(args: &Args, seed: u64, moves: bool) -> Result<Vec<(bool, bool)>, Failure> {
    let simulation = scene::simulated(args, seed, moves).map_err(Failure::run)?;
    let parameters = parameters(&own_camera(seed)?)?;
    let mut detector = FlowDetector::new(parameters.flow).map_err(Failure::run)?;
    let mut look = || -> io::Result<Vec<(bool, bool)>> {
        let (truth, mut robot) = (simulation.truth(), simulation.robot(0)?);
        robot.set_resolution(Resolution::Qqvga)?;
        robot.set_speed(Twist::new(SPEED, 0.0))?;
        // The motors take time to respond.
        robot.wait(0.5)?;
        let mut shots = Vec::new();
        let mut pairs = Vec::new();
        while pairs.len() < IN_A_SCENE && truth.pose(0)?.distance_to(truth.pose(1)?.position()) > CLOSE {
            robot.wait(parameters.period)?;
            shots.push((robot.gray_image()?, robot.pose()?, is_in_view(&truth)?));
            let Some(before) = shots.len().checked_sub(1 + parameters.apart) else { continue };
            let ((first, from, was), (second, at, is)) = (&shots[before], &shots[shots.len() - 1]);
            let moved = from.inverse().compose(at);
            let motion = compare(&mut detector, first, second, moved).map_err(|error| wrong(&error))?;
            pairs.push((*was && *is, motion.is_moving()));
        }
        Ok(pairs)
    };
    look().map_err(Failure::run)
}

fn compare(
    detector: &mut FlowDetector,
    first: &GrayImage,
    second: &GrayImage,
    moved: Pose,
) -> Result<Motion, ImageError> {
    detector.compare(first.try_into()?, second.try_into()?, moved)
}

/// Camera of the watching robot.
fn own_camera(seed: u64) -> Result<CameraSpec, Failure> {
    let camera = scene::drawn(seed).robots[0].spec.camera;
    camera.ok_or_else(|| Failure::run("a robot without a camera"))
}

/// Whether the other robot is in view of the first one.
fn is_in_view(truth: &Truth) -> io::Result<bool> {
    let (watcher, other) = (truth.pose(0)?, truth.pose(1)?.position());
    let is_near = (0.25..1.8).contains(&watcher.distance_to(other));
    Ok(is_near && bearing(watcher, other).abs() < units::from_deg(24.0))
}

/// Whether a robot reaches the moving one without touching anything.
fn reached(args: &Args, seed: u64) -> Result<bool, Failure> {
    let simulation = scene::simulated(args, seed, true).map_err(Failure::run)?;
    let mut approach = MotionApproach::new(parameters(&own_camera(seed)?)?).map_err(Failure::run)?;
    let mut robot = simulation.robot(0).map_err(Failure::run)?;
    let outcome = control::run(&mut robot, &mut approach, TIME_LIMIT, |_, _, _| ()).map_err(Failure::run)?;
    let truth = simulation.truth();
    let (own, other) = (truth.robot(0).map_err(Failure::run)?, truth.pose(1).map_err(Failure::run)?);
    let is_near = own.pose.distance_to(other.position()) < REACHED;
    Ok(outcome == ApproachOutcome::Reached && own.contacts == 0 && is_near)
}
