use std::collections::VecDeque;
use std::ops::ControlFlow;

use image::GrayImage;

use super::MotionWatchObservation;
use crate::geometry::{Point, Pose, Twist, math};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::reading::{check_gray_image, check_pose};
use crate::io::{self, Camera, Odometry, Resolution};
use crate::parameter::{require, require_positive};
use crate::vision::motion::{FlowDetector, FlowParameters, Motion};
use crate::vision::{CameraGeometry, GrayView, ImageError};

/// Parameters of [`MotionApproach`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionApproachParameters {
    /// Motion detection.
    pub flow: FlowParameters,
    /// Speed (m/s).
    pub speed: f64,
    /// Turn rate in place (rad/s).
    pub turn_speed: f64,
    /// Control period: time between two images (s).
    pub period: f64,
    /// Number of periods between two compared images.
    pub apart: usize,
    /// Distance from the robot's centre at which the thing that moved is reached: to its near side (m).
    pub reach: f64,
    /// Half the width of the floor that must be free ahead (m).
    pub half_width: f64,
    /// Time after which a target that has not moved is watched at a stand, and after which it is given up
    /// (s).
    pub patience: [f64; 2],
}

impl MotionApproachParameters {
    /// Parameters for a camera.
    pub fn new(camera: CameraGeometry) -> Self {
        Self {
            flow: FlowParameters::new(camera),
            speed: 0.2,
            turn_speed: 0.6,
            period: 0.1,
            apart: 2,
            reach: 0.4,
            half_width: 0.12,
            patience: [0.6, 4.0],
        }
    }
}

/// Outcome of a [`MotionApproach`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ApproachOutcome {
    /// It stands before what moves.
    Reached,
    /// The time limit was exceeded.
    TimedOut,
    /// The observer stopped it.
    Stopped,
}

halts!(ApproachOutcome { Reached: "what moves is reached" });

/// Drives until it sees something move (book, section 11.6), and then to it.
///
/// While nothing moves, it drives straight ahead, and turns where the way is not free. The place of a motion
/// comes from the foot of what moves, on the floor. It faces that place before it drives to it, because
/// odometry is least certain while it turns. If nothing has moved there for some time, it stands and watches.
///
/// ```
/// use image::{GrayImage, Luma};
/// use roverlab::drive::motion_watch::{MotionApproach, MotionApproachParameters};
/// use roverlab::geometry::Pose;
/// use roverlab::vision::CameraGeometry;
/// let camera = CameraGeometry { field_of_view: 1.0, height: 0.06, ahead: 0.06 };
/// let floor = GrayImage::from_fn(160, 120, |_, y| Luma([if y < 64 { 110 } else { 180 }]));
/// let mut approach = MotionApproach::new(MotionApproachParameters::new(camera))?;
/// for step in 0..5 {
///     let time = 0.1 * f64::from(step);
///     let twist = approach.step(time, &floor, Pose::new(0.2 * time, 0.0, 0.0))?.expect("nothing reached");
///     assert_eq!((twist.linear, twist.angular), (0.2, 0.0), "nothing moves, and the way is free");
/// }
/// assert!(!approach.motion().expect("three images").is_moving());
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct MotionApproach {
    parameters: MotionApproachParameters,
    detector: FlowDetector,
    images: VecDeque<(GrayImage, Pose)>,
    motion: Option<Motion>,
    target: Option<Target>,
}

/// Place of a motion in the frame of odometry, and when it was last seen (s).
#[derive(Debug, Clone, Copy)]
struct Target {
    place: Point,
    seen: f64,
}

/// Turn between two compared images above which odometry is too uncertain (rad): half a pixel for an error of
/// a tenth.
const TURN: f64 = 0.04;
/// Bearing above which it turns in place before it drives (rad).
const ASIDE: f64 = 0.2;
/// Maximum turn rate while it drives (rad/s), so that images stay comparable.
const STEERING: f64 = 0.15;
/// Free distance ahead below which it turns without a target (m).
const NO_WAY: f64 = 0.45;
/// Times of turning and of looking while it looks round (s): by half the view, and for some images.
const LOOKS: [f64; 2] = [0.8, 0.7];
/// Share of a new place in the target's (filter).
const SHARE: f64 = 0.5;
/// Distance between two places beyond which they are two things (m).
const ANOTHER: f64 = 0.6;

impl MotionApproach {
    /// An approach that has seen no image.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(parameters: MotionApproachParameters) -> Result<Self, ImageError> {
        require_positive("speed", parameters.speed)?;
        require_positive("turn speed", parameters.turn_speed)?;
        require_positive("control period", parameters.period)?;
        require("periods apart", parameters.apart as f64, (1..=100).contains(&parameters.apart), "1 to 100")?;
        require_positive("reach", parameters.reach)?;
        require_positive("half width", parameters.half_width)?;
        let [watched, given_up] = parameters.patience;
        require_positive("patience", watched)?;
        require("patience", given_up, given_up >= watched, "the time of watching before that of giving up")?;
        Ok(Self {
            detector: FlowDetector::new(parameters.flow)?,
            parameters,
            images: VecDeque::new(),
            motion: None,
            target: None,
        })
    }

    /// Motion in the last comparison; `None` while it turns too fast to compare.
    pub fn motion(&self) -> Option<Motion> {
        self.motion
    }

    /// Place of what moves, in the frame of odometry (m).
    pub fn target(&self) -> Option<Point> {
        self.target.map(|target| target.place)
    }

    /// The velocity after an image taken at an odometry pose; `None` when what moves is reached. Fails for an
    /// image that differs in size.
    pub fn step(&mut self, time: f64, image: &GrayImage, pose: Pose) -> Result<Option<Twist>, ImageError> {
        self.motion = self.compare(image, pose)?;
        if let Some(place) = self.motion.filter(Motion::is_moving).and_then(|_| self.detector.place()) {
            self.aim(pose.to_world(place), time);
        }
        self.images.push_back((image.clone(), pose));
        let [watched, given_up] = self.parameters.patience;
        self.target = self.target.filter(|target| time - target.seen < given_up);
        let Some(target) = self.target else { return Ok(Some(self.search(time))) };
        let local = pose.to_local(target.place);
        let (believed, bearing) = (local.coords.norm(), math::atan2(local.y, local.x));
        let p = &self.parameters;
        // What stands there now, whether it has moved again or not.
        let seen = self.detector.free_towards(bearing, p.half_width);
        let seen = seen.filter(|distance| (distance - believed).abs() < ANOTHER);
        if seen.is_some_and(|distance| distance < p.reach) {
            return Ok(None);
        }
        let is_fresh = time - target.seen < watched;
        let distance = seen.unwrap_or(believed);
        Ok(Some(if bearing.abs() > ASIDE {
            Twist::new(0.0, p.turn_speed.copysign(bearing) * (bearing.abs() / 0.5).clamp(0.3, 1.0))
        } else if is_fresh && distance > p.reach {
            Twist::new(p.speed.min(distance - 0.5 * p.reach), bearing.clamp(-STEERING, STEERING))
        } else {
            Twist::STOP
        }))
    }

    fn compare(&mut self, image: &GrayImage, pose: Pose) -> Result<Option<Motion>, ImageError> {
        while self.images.len() > self.parameters.apart {
            self.images.pop_front();
        }
        if self.images.len() < self.parameters.apart {
            return Ok(None);
        }
        let Some((before, at)) = self.images.front() else { return Ok(None) };
        let moved = at.inverse().compose(&pose);
        let (first, second): (GrayView<'_>, GrayView<'_>) = (before.try_into()?, image.try_into()?);
        let motion = self.detector.compare(first, second, moved)?;
        Ok((moved.heading.abs() < TURN).then_some(motion))
    }

    /// Takes a place of motion.
    fn aim(&mut self, place: Point, time: f64) {
        let known = self.target.filter(|target| (target.place - place).norm() < ANOTHER);
        let place = known.map_or(place, |target| target.place + (place - target.place) * SHARE);
        self.target = Some(Target { place, seen: time });
    }

    /// Straight ahead, or a turn to the left where the way is not free, with stops to look round.
    fn search(&self, time: f64) -> Twist {
        let p = &self.parameters;
        let is_free = self.detector.free_towards(0.0, p.half_width).is_none_or(|free| free > NO_WAY);
        let [turning, looking] = LOOKS;
        match (is_free, time.rem_euclid(turning + looking) < turning) {
            (true, _) => Twist::new(p.speed, 0.0),
            (false, true) => Twist::new(0.0, p.turn_speed),
            (false, false) => Twist::STOP,
        }
    }
}

impl Behaviour for MotionApproach {
    type Observation = MotionWatchObservation;
    type Command = Twist;
    type Outcome = ApproachOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &MotionWatchObservation) -> Decision<Self> {
        check_pose(&seen.pose)?;
        check_gray_image(&seen.image)?;
        let twist = MotionApproach::step(self, time, &seen.image, seen.pose).map_err(io::Error::caused_by)?;
        Ok(twist.map_or(ControlFlow::Break(ApproachOutcome::Reached), ControlFlow::Continue))
    }
}

impl<R: Camera + Odometry + ?Sized> Senses<R> for MotionApproach {
    fn prepare(&mut self, robot: &mut R) -> io::Result<()> {
        robot.set_resolution(Resolution::Qqvga)
    }

    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut MotionWatchObservation) -> io::Result<()> {
        *seen = MotionWatchObservation { image: robot.gray_image()?, pose: robot.pose()? };
        Ok(())
    }
}
