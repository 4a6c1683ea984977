use image::RgbImage;

use crate::geometry::{Pose, Twist, angle_difference, units};
use crate::io::control::Stopwatch;
use crate::io::{
    Camera, Clock, Display, DisplayImage, DisplayOption, DistanceSensors, Drive, Encoders, Fill, Font, Key,
    Keys, Lidar, LidarScan, LidarSettings, Manoeuvres, Motors, Odometry, Pixel, Psd, Radio, RadioMessage,
    Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::kinematics::{Displacement, arc_between};
use crate::parameter::{ParameterError, require_finite, require_not_negative, require_positive};
use crate::world::Colour;

/// How manoeuvres are made of speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ManoeuvringParameters {
    /// Seconds from one look at odometry to the next.
    pub period: f64,
    /// The time constant, in seconds, with which the robot takes up a speed: told to stop, it rolls on as far as its
    /// speed takes it in that time.
    pub lag: f64,
}

impl Default for ManoeuvringParameters {
    /// Twenty looks a second at a robot that does at once as it is told.
    fn default() -> Self {
        Self { period: 0.05, lag: 0.0 }
    }
}

impl ManoeuvringParameters {
    /// Fails with the name of the parameter that makes no sense.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        require_positive("period", self.period)?;
        require_not_negative("lag", self.lag)
    }
}

/// A robot that has speeds and odometry, with manoeuvres and a stall detector that are made of these.
///
/// While it is told to move, it looks at odometry once in a period of the robot's clock: in waits, and at the first
/// call after that. A manoeuvre is then given the speeds that share out what is left of its length and of its angle
/// over the same time, so that what went wrong on the way is made up for. While the robot is not told to move, calls
/// go straight through.
///
/// What is left is counted without the way that the robot rolls on by itself; so robots with a lag stop where the way
/// ends, too. They are done when they stand.
///
/// The robot stalls when it has been told to move for half a second and a centimetre, and odometry has not moved half
/// as far. Wheels that slip while something holds the robot deceive odometry, and that detector with it.
///
/// ```
/// use ambassador::Delegate;
/// use roverlab::io::delegate::*;
/// use roverlab::io::wrappers::{Manoeuvring, ManoeuvringParameters};
/// use roverlab::io::{Clock, Drive, Manoeuvres, MockRobot, Odometry};
///
/// /// A robot that can do no more than this.
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
    /// While it is told to move.
    motion: Option<Motion>,
}

/// What a robot that moves is doing.
#[derive(Debug, Clone)]
struct Motion {
    clock: Stopwatch,
    /// When it looks next.
    due: f64,
    /// Where odometry was last.
    pose: Pose,
    told: Twist,
    way: Option<Way>,
    held: Held,
}

/// A running manoeuvre.
#[derive(Debug, Clone, Copy)]
struct Way {
    /// What is left of it.
    left: Displacement,
    /// Whether it turns on the spot.
    turns: bool,
    /// Whether it goes backwards or clockwise.
    back: bool,
    /// Metres, or radians for a turn on the spot, per second.
    speed: f64,
    phase: Phase,
}

/// How far a manoeuvre has come.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Going,
    /// It has the speed that takes it to its end in this period.
    Ending,
    /// It was told to stop so many seconds ago.
    Rolling(f64),
}

/// Lags after which a robot that was told to stop stands: it has a hundredth of its speed.
const STANDS: f64 = 5.0;

/// How long a robot has been where it is, and how far it should have come since.
#[derive(Debug, Clone, Copy)]
struct Held {
    pose: Pose,
    seconds: f64,
    told: f64,
}

/// Metres by which a robot that moves leaves its place.
const PLACE: f64 = 0.005;
/// Seconds for which a robot has to be held.
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

    /// Metres or radians along the way.
    fn along(&self, motion: Displacement) -> f64 {
        let along = if self.turns { motion.angle } else { motion.length };
        if self.back { -along } else { along }
    }

    /// Goes a period further, with so much of the way to be told: the speed from now on, or `None` at the end.
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
    /// Gives manoeuvres to a robot. Fails if a parameter makes no sense.
    pub fn new(inner: R, parameters: ManoeuvringParameters) -> Result<Self> {
        parameters.validate()?;
        Ok(Self { inner, parameters, motion: None })
    }

    /// The robot inside.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The robot inside, which goes on as it was told last.
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
    /// Begins a motion, after another one or from rest. Who has been held still is.
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

    /// Looks at odometry if that is due.
    fn keep_up(&mut self) -> Result<()> {
        let Some(motion) = &mut self.motion else { return Ok(()) };
        let now = motion.clock.now(&mut self.inner);
        match now {
            Ok(now) if now < motion.due => Ok(()),
            Ok(_) => self.look(),
            Err(error) => self.give_up(error),
        }
    }

    /// Looks at odometry, and tells the robot how to go on: after a wait for that, even if the clock stands still.
    /// The robot is stopped if that fails.
    fn look(&mut self) -> Result<()> {
        self.try_to_look().or_else(|error| self.give_up(error))
    }

    fn give_up(&mut self, error: crate::io::Error) -> Result<()> {
        self.motion = None;
        // The first error is the one to tell.
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
        // What the robot has gone by then counts.
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
    Encoders
);
