use std::ops::ControlFlow;

use image::GrayImage;

use crate::geometry::{Pose, Twist, angle_difference};
use crate::io::control::{Behaviour, Decision, Halt, Senses};
use crate::io::reading::check_pose;
use crate::io::{self, Camera, Odometry, Resolution};
use crate::parameter::{require_not_negative, require_positive};
use crate::vision::motion::{Motion, MotionDetector, MotionParameters, TurnCompensator};
use crate::vision::{GrayView, ImageError};

/// Parameters of a [`MotionWatch`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionWatchParameters {
    /// Motion detection while the robot stands.
    pub standing: MotionParameters,
    /// Motion detection while the robot turns.
    pub turning: MotionParameters,
    /// Horizontal field of view of the camera (rad).
    pub field_of_view: f64,
    /// Turn rate towards motion (rad/s).
    pub turn_speed: f64,
    /// Time between two images (s), as in Program 11.14.
    pub period: f64,
    /// Parallax of near edges per pixel of image shift, as the camera is off the robot's axis: its distance
    /// from the axis divided by that of the nearest things.
    pub parallax: f64,
    /// Time for which the robot keeps turning after the last motion on a side (s).
    pub patience: f64,
}

impl MotionWatchParameters {
    /// Parameters for a camera with this horizontal field of view (rad).
    pub fn new(field_of_view: f64) -> Self {
        let turning = MotionParameters { threshold: 8.0, least_noise: 4.0, ..MotionParameters::default() };
        Self {
            standing: MotionParameters::default(),
            turning,
            field_of_view,
            turn_speed: 0.4,
            period: 0.1,
            parallax: 0.3,
            patience: 0.3,
        }
    }
}

/// Turns towards motion (book, section 11.5), and detects it while turning as well (section 11.6).
///
/// ```
/// use image::{GrayImage, Luma};
/// use roverlab::drive::motion_watch::{MotionWatch, MotionWatchParameters};
/// use roverlab::geometry::{Pose, Twist};
/// let room = GrayImage::from_fn(160, 120, |x, y| Luma([80 + ((x * 7 + y * 13) % 50) as u8]));
/// let mut watch = MotionWatch::new(MotionWatchParameters::new(1.0))?;
/// for step in 0..10 {
///     let twist = watch.step(0.1 * f64::from(step), &room, Pose::default())?;
///     assert_eq!(twist, Twist::default(), "nothing moves, and the robot stands");
/// }
/// assert!(!watch.motion().expect("two images").is_moving());
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct MotionWatch {
    parameters: MotionWatchParameters,
    standing: MotionDetector,
    turning: MotionDetector,
    compensator: TurnCompensator,
    before: Option<(GrayImage, Pose)>,
    motion: Option<Motion>,
    /// Whether the robot stood between the previous two images, and whether it is commanded to turn now.
    settled: bool,
    turns: bool,
    side: f64,
    until: f64,
}

impl MotionWatch {
    /// Creates a watch that has seen no image. Fails for parameters out of range.
    pub fn new(parameters: MotionWatchParameters) -> Result<Self, ImageError> {
        require_positive("turn speed", parameters.turn_speed)?;
        require_positive("control period", parameters.period)?;
        require_not_negative("parallax", parameters.parallax)?;
        require_not_negative("patience", parameters.patience)?;
        Ok(Self {
            standing: MotionDetector::new(parameters.standing)?,
            turning: MotionDetector::new(parameters.turning)?,
            compensator: TurnCompensator::new(parameters.field_of_view)?,
            parameters,
            before: None,
            motion: None,
            settled: true,
            turns: false,
            side: 0.0,
            until: f64::NEG_INFINITY,
        })
    }

    /// Motion between the last two images.
    pub fn motion(&self) -> Option<Motion> {
        self.motion
    }

    /// The velocity after an image taken at an odometry pose. Fails for an image that differs in size.
    pub fn step(&mut self, time: f64, image: &GrayImage, pose: Pose) -> Result<Twist, ImageError> {
        self.motion = match self.before.take() {
            Some((before, at)) => {
                Some(self.compare(&before, image, angle_difference(pose.heading, at.heading))?)
            }
            None => None,
        };
        self.before = Some((image.clone(), pose));
        if let Some(sector) = self.motion.and_then(|motion| motion.strongest) {
            // Left, ahead, right.
            self.side = 1.0 - sector as f64;
            self.until = time + self.parameters.patience;
        }
        let turn = if time < self.until { self.side * self.parameters.turn_speed } else { 0.0 };
        self.turns = turn != 0.0;
        Ok(Twist::new(0.0, turn))
    }

    fn compare(&mut self, before: &GrayImage, image: &GrayImage, turned: f64) -> Result<Motion, ImageError> {
        /// Rotation below the camera's resolution.
        const STILL: f64 = 3e-4;
        /// Displacement of edges that rounding to pixels and registration may cause (pixels).
        const PIXELS: f64 = 1.25;
        let (first, second): (GrayView<'_>, GrayView<'_>) = (before.try_into()?, image.try_into()?);
        // Encoders count whole ticks: a robot that has not turned for one image may still be moving.
        let settled = self.settled;
        self.settled = turned.abs() < STILL && !self.turns;
        if settled && self.settled {
            return self.standing.compare(first, second);
        }
        let seen = self.compensator.turn(first, second, turned)?;
        // Each image gets half of the edge error as slack.
        let off = PIXELS + self.parameters.parallax * seen.shift;
        let slack = (0.5 * off + 0.5).min(first.width() as f64) as usize;
        // Content beyond the edge of one image may appear in the other by the same amount.
        let (from, to) = (seen.from + 2 * slack, seen.to.saturating_sub(2 * slack));
        if to < from + self.parameters.turning.block {
            return self.standing.compare(second, second);
        }
        let (width, height) = (to - from, second.height());
        let moved = seen.image.region((from, 0), width, height)?;
        self.turning.compare_loosely(moved, second.region((from, 0), width, height)?, slack)
    }
}

/// Observation of a [`MotionWatch`].
#[derive(Debug, Clone, Default)]
pub struct MotionWatchObservation {
    /// Camera image.
    pub image: GrayImage,
    /// Pose by odometry.
    pub pose: Pose,
}

impl Behaviour for MotionWatch {
    type Observation = MotionWatchObservation;
    type Command = Twist;
    type Outcome = Halt;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &MotionWatchObservation) -> Decision<Self> {
        check_pose(&seen.pose)?;
        let twist = MotionWatch::step(self, time, &seen.image, seen.pose).map_err(io::Error::caused_by)?;
        Ok(ControlFlow::Continue(twist))
    }
}

impl<R: Camera + Odometry + ?Sized> Senses<R> for MotionWatch {
    fn prepare(&mut self, robot: &mut R) -> io::Result<()> {
        robot.set_resolution(Resolution::Qqvga)
    }

    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut MotionWatchObservation) -> io::Result<()> {
        *seen = MotionWatchObservation { image: robot.gray_image()?, pose: robot.pose()? };
        Ok(())
    }
}
