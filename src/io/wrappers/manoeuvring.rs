use image::RgbImage;

use crate::geometry::{Pose, Twist, Vector3, angle_difference, units};
use crate::io::control::Stopwatch;
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres, Motors, Odometry,
    Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::kinematics::{Displacement, arc_between};
use crate::parameter::{ParameterError, require_finite, require_not_negative, require_positive};
use crate::world::Colour;

/// Parameters of [`Manoeuvring`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ManoeuvringParameters {
    /// Period of the odometry readings (s).
    pub period: f64,
    /// Time constant of the robot's response (s): after a stop it rolls on for its speed times this constant.
    pub lag: f64,
}

impl Default for ManoeuvringParameters {
    /// 20 Hz, for a robot without delay.
    fn default() -> Self {
        Self { period: 0.05, lag: 0.0 }
    }
}

impl ManoeuvringParameters {
    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        require_positive("period", self.period)?;
        require_not_negative("lag", self.lag)
    }
}

/// A robot with velocity control and odometry, extended by manoeuvres and a stall detector.
///
/// While moving, it reads odometry once per period of the robot's clock: during waits, and at the first call
/// after them. A manoeuvre commands the velocity that covers its remaining length and angle in the same time,
/// which corrects errors on the way. While the robot is not commanded to move, calls go straight through.
///
/// The remainder excludes the distance the robot still rolls by itself, so robots with a lag stop at the end,
/// too. They are done when they stand.
///
/// A stall is reported if the robot has been commanded to move for half a second and a centimetre, and
/// odometry has moved less than half as far. Slipping wheels of a held robot deceive odometry, and therefore
/// this detector.
///
/// ```
/// use ambassador::Delegate;
/// use roverlab::io::delegate::*;
/// use roverlab::io::wrappers::{Manoeuvring, ManoeuvringParameters};
/// use roverlab::io::{Clock, Drive, Manoeuvres, MockRobot, Odometry};
///
/// /// A robot without further capabilities.
/// #[derive(Delegate)]
/// #[delegate(Clock, target = "inner")]
/// #[delegate(Drive, target = "inner")]
/// #[delegate(Odometry, target = "inner")]
/// struct Plain {
///     inner: MockRobot,
/// }
///
/// # fn main() -> Result<()> {
/// let plain = Plain { inner: MockRobot::new().with_ideal_drive() };
/// let mut robot = Manoeuvring::new(plain, ManoeuvringParameters::default())?;
/// robot.curve(0.5, 1.0, 0.2)?;
/// robot.wait_done()?;
/// let pose = robot.pose()?;
/// assert!((pose.heading - 1.0).abs() < 1e-9 && (pose.x - 0.5 * 1_f64.sin()).abs() < 1e-9);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Manoeuvring<R> {
    inner: R,
    parameters: ManoeuvringParameters,
    /// Present while the robot is commanded to move.
    motion: Option<Motion>,
}

/// State of a moving robot.
#[derive(Debug, Clone)]
struct Motion {
    clock: Stopwatch,
    /// Time of the next reading (s).
    due: f64,
    /// Last pose by odometry.
    pose: Pose,
    told: Twist,
    way: Option<Way>,
    held: Held,
}

/// A running manoeuvre.
#[derive(Debug, Clone, Copy)]
struct Way {
    /// Remaining motion.
    left: Displacement,
    /// Whether it turns on the spot.
    turns: bool,
    /// Whether it goes backwards or clockwise.
    back: bool,
    /// Speed (m/s), or turn rate on the spot (rad/s).
    speed: f64,
    phase: Phase,
}

/// Phase of a manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Going,
    /// Its speed reaches the end within this period.
    Ending,
    /// Commanded to stop this many seconds ago.
    Rolling(f64),
}

/// Number of lags after which a stopping robot counts as standing: at a hundredth of its speed.
const STANDS: f64 = 5.0;

/// How long a robot has been at a pose, and how far it should have moved since.
#[derive(Debug, Clone, Copy)]
struct Held {
    pose: Pose,
    seconds: f64,
    told: f64,
}

/// Distance within which a robot counts as not having moved (m).
const PLACE: f64 = 0.005;
/// Time for which a robot must be held (s).
const PATIENCE: f64 = 0.5;

impl Held {
    fn at(pose: Pose) -> Self {
        Self { pose, seconds: 0.0, told: 0.0 }
    }

    fn update(&mut self, pose: Pose, told: Twist, seconds: f64) {
        let turned = angle_difference(pose.heading, self.pose.heading).abs();
        if pose.distance_to(self.pose.position()) + units::ARM * turned >= PLACE {
            *self = Self::at(pose);
        } else {
            self.seconds += seconds;
            self.told += (told.linear.abs() + units::ARM * told.angular.abs()) * seconds;
        }
    }

    fn is_stalled(&self) -> bool {
        self.seconds >= PATIENCE && self.told >= 2.0 * PLACE
    }
}

impl Way {
    fn new(left: Displacement, speed: f64) -> Result<Self> {
        require_finite("length", left.length)?;
        require_finite("angle", left.angle)?;
        require_positive("speed", speed.abs())?;
        let turns = left.length == 0.0;
        let back = if turns { left.angle < 0.0 } else { left.length < 0.0 };
        Ok(Self { left, turns, back, speed: speed.abs(), phase: Phase::Going })
    }

    /// Distance (m) or angle (rad) along the manoeuvre.
    fn along(&self, motion: Displacement) -> f64 {
        let along = if self.turns { motion.angle } else { motion.length };
        if self.back { -along } else { along }
    }

    /// Advances by a period. Returns the next velocity for the remainder not yet commanded, or `None` at the
    /// end.
    fn next(&mut self, untold: Displacement, parameters: &ManoeuvringParameters) -> Option<Twist> {
        let rest = self.along(untold);
        self.phase = match self.phase {
            Phase::Going if rest > self.speed * parameters.period => Phase::Going,
            Phase::Going if rest > 0.0 => Phase::Ending,
            Phase::Going | Phase::Ending => Phase::Rolling(0.0),
            Phase::Rolling(seconds) => Phase::Rolling(seconds + parameters.period),
        };
        match self.phase {
            Phase::Rolling(seconds) if seconds >= STANDS * parameters.lag => None,
            Phase::Rolling(_) => Some(Twist::STOP),
            Phase::Going | Phase::Ending => {
                let seconds = (rest / self.speed).max(parameters.period);
                Some(Twist::new(untold.length / seconds, untold.angle / seconds))
            }
        }
    }
}

impl<R> Manoeuvring<R> {
    /// Adds manoeuvres to a robot. Fails for parameters out of range.
    pub fn new(inner: R, parameters: ManoeuvringParameters) -> Result<Self> {
        parameters.validate()?;
        Ok(Self { inner, parameters, motion: None })
    }

    /// The wrapped robot.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The wrapped robot, which continues with its last command.
    pub fn into_inner(self) -> R {
        self.inner
    }

    fn way(&self) -> Option<&Way> {
        self.motion.as_ref().and_then(|motion| motion.way.as_ref())
    }

    fn is_held(&self) -> bool {
        self.motion.as_ref().is_some_and(|motion| motion.held.is_stalled())
    }
}

impl<R: Clock + Drive + Odometry> Manoeuvring<R> {
    /// Starts a motion, from another one or from rest. A held robot stays held.
    fn begin(&mut self, told: Twist, way: Option<Way>) -> Result<()> {
        let pose = self.inner.pose()?;
        let (mut clock, held) = match &self.motion {
            Some(motion) => (motion.clock, motion.held),
            None => (Stopwatch::start(&mut self.inner, f64::INFINITY)?, Held::at(pose)),
        };
        let due = clock.now(&mut self.inner)? + self.parameters.period;
        self.motion = Some(Motion { clock, due, pose, told, way, held });
        Ok(())
    }

    fn start(&mut self, motion: Displacement, speed: f64) -> Result<()> {
        self.begin(Twist::STOP, Some(Way::new(motion, speed)?))?;
        self.look()
    }

    /// Reads odometry if due.
    fn keep_up(&mut self) -> Result<()> {
        let Some(motion) = &mut self.motion else { return Ok(()) };
        let now = motion.clock.now(&mut self.inner);
        match now {
            Ok(now) if now < motion.due => Ok(()),
            Ok(_) => self.look(),
            Err(error) => self.give_up(error),
        }
    }

    /// Reads odometry and updates the robot's velocity. After a wait it does so even if the clock stands
    /// still. Stops the robot on failure.
    fn look(&mut self) -> Result<()> {
        self.try_to_look().or_else(|error| self.give_up(error))
    }

    fn give_up(&mut self, error: crate::io::Error) -> Result<()> {
        self.motion = None;
        // The first error is the one to report.
        let _ = self.inner.stop();
        Err(error)
    }

    fn try_to_look(&mut self) -> Result<()> {
        let Some(motion) = &mut self.motion else { return Ok(()) };
        let now = motion.clock.now(&mut self.inner)?;
        let pose = self.inner.pose()?;
        let went = arc_between(motion.pose, pose);
        motion.held.update(pose, motion.told, self.parameters.period);
        (motion.pose, motion.due) = (pose, now + self.parameters.period);
        let Some(way) = &mut motion.way else { return Ok(()) };
        way.left.length -= went.length;
        way.left.angle -= went.angle;
        let speed = self.inner.speed()?;
        let untold = Displacement {
            length: way.left.length - self.parameters.lag * speed.linear,
            angle: way.left.angle - self.parameters.lag * speed.angular,
        };
        let next = way.next(untold, &self.parameters);
        motion.told = next.unwrap_or(Twist::STOP);
        self.inner.set_speed(motion.told)?;
        if next.is_none() {
            self.motion = None;
        }
        Ok(())
    }
}

impl<R: Clock + Drive + Odometry> Clock for Manoeuvring<R> {
    fn now(&mut self) -> Result<f64> {
        self.keep_up()?;
        self.inner.now()
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        let mut left = seconds;
        while let Some(motion) = &mut self.motion {
            let until = match motion.clock.now(&mut self.inner) {
                Ok(now) => (motion.due - now).max(0.0),
                Err(error) => return self.give_up(error),
            };
            if until > left || left <= 0.0 {
                break;
            }
            self.inner.wait(until)?;
            left -= until;
            self.look()?;
        }
        self.inner.wait(left)
    }

    fn peek_time(&mut self) -> Result<f64> {
        self.inner.peek_time()
    }
}

impl<R: Clock + Drive + Odometry> Drive for Manoeuvring<R> {
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        self.keep_up()?;
        self.inner.set_speed(twist)?;
        if twist == Twist::STOP {
            self.motion = None;
            return Ok(());
        }
        self.begin(twist, None)
    }
}

impl<R: Clock + Drive + Odometry> Odometry for Manoeuvring<R> {
    fn speed(&mut self) -> Result<Twist> {
        self.keep_up()?;
        self.inner.speed()
    }

    fn pose(&mut self) -> Result<Pose> {
        self.keep_up()?;
        self.inner.pose()
    }

    fn set_pose(&mut self, pose: Pose) -> Result<()> {
        // Motion up to now counts.
        self.look()?;
        self.inner.set_pose(pose)?;
        if let Some(motion) = &mut self.motion {
            (motion.pose, motion.held.pose) = (pose, pose);
        }
        Ok(())
    }
}

impl<R: Clock + Drive + Odometry> Manoeuvres for Manoeuvring<R> {
    fn straight(&mut self, distance: f64, speed: f64) -> Result<()> {
        self.start(Displacement { length: distance, angle: 0.0 }, speed)
    }

    fn turn(&mut self, angle: f64, speed: f64) -> Result<()> {
        self.start(Displacement { length: 0.0, angle }, speed)
    }

    fn curve(&mut self, length: f64, angle: f64, speed: f64) -> Result<()> {
        self.start(Displacement { length, angle }, speed)
    }

    fn remaining(&mut self) -> Result<f64> {
        self.keep_up()?;
        Ok(self.way().map_or(0.0, |way| way.along(way.left).max(0.0)))
    }

    fn is_done(&mut self) -> Result<bool> {
        self.keep_up()?;
        Ok(self.way().is_none())
    }

    fn wait_done(&mut self) -> Result<()> {
        while self.way().is_some() && !self.is_held() {
            self.wait(self.parameters.period)?;
        }
        Ok(())
    }
}

impl<R: Clock + Drive + Odometry> StallDetector for Manoeuvring<R> {
    fn is_stalled(&mut self) -> Result<bool> {
        self.keep_up()?;
        Ok(self.is_held())
    }
}

impl<R: Clock + Drive + Odometry + Motors> Motors for Manoeuvring<R> {
    fn set_motor(&mut self, motor: u8, fraction: f64) -> Result<()> {
        self.motion = None;
        self.inner.set_motor(motor, fraction)
    }
}

hooked!(
    Manoeuvring,
    keep_up,
    [Clock Drive Odometry],
    DistanceSensors,
    Lidar,
    Camera,
    Display,
    Keys,
    Radio,
    Servos,
    Encoders,
    Inertial,
    DepthSensor
);
