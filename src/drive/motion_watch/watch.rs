use std::ops::ControlFlow;

use image::GrayImage;

use crate::geometry::{Pose, Twist, angle_difference};
use crate::io::control::{Behaviour, Decision, Halt, Senses};
use crate::io::{self, Camera, Odometry, Resolution};
use crate::parameter::{require_not_negative, require_positive};
use crate::vision::motion::{Motion, MotionDetector, MotionParameters, TurnCompensator};
use crate::vision::{GrayView, ImageError};

/// How a [`MotionWatch`] looks and turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionWatchParameters {
    /// What makes motion while the robot stands.
    pub standing: MotionParameters,
    /// What makes motion while it turns.
    pub turning: MotionParameters,
    /// The camera's horizontal field of view in radians.
    pub field_of_view: f64,
    /// Radians per second at which the robot turns towards motion.
    pub turn_speed: f64,
    /// Seconds between two images, as in Program 11.14.
    pub period: f64,
    /// Pixels by which edges of near things may be off for each pixel of a turn, as the camera is not on the robot's
    /// axis: its distance from there over that of the nearest things.
    pub parallax: f64,
    /// Seconds for which it turns on after the last motion to a side.
    pub patience: f64,
}

impl MotionWatchParameters {
    /// For a camera with a horizontal field of view in radians.
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

/// Turns to where something moves (book, section 11.5), and sees motion while it turns as well (section 11.6).
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
    /// Whether it did not turn from the image before the last one to the last one, and whether it is told to now.
    settled: bool,
    turns: bool,
    side: f64,
    until: f64,
}

impl MotionWatch {
    /// A watch that has seen nothing yet.
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

    /// What moved between the last two images.
    pub fn motion(&self) -> Option<Motion> {
        self.motion
    }

    /// The speed for an image that was taken at a pose of odometry.
    pub fn step(&mut self, time: f64, image: &GrayImage, pose: Pose) -> Result<Twist, ImageError> {
        self.motion = match self.before.take() {
            Some((before, at)) => {
                Some(self.compare(&before, image, angle_difference(pose.heading, at.heading))?)
            }
            None => None,
        };
        self.before = Some((image.clone(), pose));
        if let Some(sector) = self.motion.and_then(|motion| motion.strongest) {
            // Left, on, right.
            self.side = 1.0 - sector as f64;
            self.until = time + self.parameters.patience;
        }
        let turn = if time < self.until { self.side * self.parameters.turn_speed } else { 0.0 };
        self.turns = turn != 0.0;
        Ok(Twist::new(0.0, turn))
    }

    fn compare(&mut self, before: &GrayImage, image: &GrayImage, turned: f64) -> Result<Motion, ImageError> {
        /// Less is below what the camera can tell.
        const STILL: f64 = 3e-4;
        /// What whole pixels and the registration may put edges off by.
        const PIXELS: f64 = 1.25;
        let (first, second): (GrayView<'_>, GrayView<'_>) = (before.try_into()?, image.try_into()?);
        // Encoders count whole ticks: a robot that has not turned for one image only may not stand yet.
        let settled = self.settled;
        self.settled = turned.abs() < STILL && !self.turns;
        if settled && self.settled {
            return self.standing.compare(first, second);
        }
        let seen = self.compensator.turn(first, second, turned)?;
        // Half of what edges may be off by is granted to each of the images.
        let off = PIXELS + self.parameters.parallax * seen.shift;
        let slack = (0.5 * off + 0.5).min(first.width() as f64) as usize;
        // What was beyond the edge of one image may be in the other by as much.
        let (from, to) = (seen.from + 2 * slack, seen.to.saturating_sub(2 * slack));
        if to < from + self.parameters.turning.block {
            return self.standing.compare(second, second);
        }
        let (width, height) = (to - from, second.height());
        let moved = seen.image.region((from, 0), width, height)?;
        self.turning.compare_loosely(moved, second.region((from, 0), width, height)?, slack)
    }
}

/// What a [`MotionWatch`] sees at a step.
#[derive(Debug, Clone, Default)]
pub struct MotionWatchObservation {
    /// The camera's image.
    pub image: GrayImage,
    /// Where odometry takes the robot to be.
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
