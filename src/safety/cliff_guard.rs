use super::{SpeedError, StoppingModel};
use crate::ParameterError;
use crate::geometry::{Aabb, Pose, Twist, Vector, Vector3, math};
use crate::io::wrappers::signatures;
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres, Odometry, Pixel,
    Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::parameter::{require, require_positive};
use crate::world::{Colour, Footprint, Mount, PsdSpec, RobotSpec};
use image::RgbImage;

/// The parameters of a [`CliffGuard`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CliffGuardParameters {
    /// Metres by which a reading has to exceed that of level ground for the ground to be missing.
    pub drop: f64,
    /// The most metres per second of any place of the outline.
    pub speed: f64,
    /// Seconds from one look at the ground to the next.
    pub period: f64,
    /// How the robot stops.
    pub stopping: StoppingModel,
}

impl Default for CliffGuardParameters {
    /// 0.3 m/s, on ground with a friction of 0.4 or more; the noise of real sensors makes no false alarm in
    /// five standard deviations.
    fn default() -> Self {
        let stopping =
            StoppingModel { reaction: 0.03, lag: 0.0, deceleration: 3.0, error: SpeedError::default() };
        Self { drop: 0.05, speed: 0.3, period: 0.02, stopping }
    }
}

impl CliffGuardParameters {
    /// Fails with the name of the parameter that is out of range, also if the robot could not stop within
    /// what its sensors look ahead.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        require_positive("drop", self.drop)?;
        require_positive("control period", self.period)?;
        require_positive("speed", self.speed)?;
        let way = self.stopping.distance(self.speed);
        require("speed", self.speed, way <= AHEAD, "slow enough to stop within 35 mm")?;
        let late = self.stopping.reaction;
        require("reaction time", late, late >= self.period, "at least the control period")
    }
}

/// Metres ahead of and beside a corner of the outline at which its sensor looks.
const AHEAD: f64 = 0.035;
/// Metres above the ground of the sensors.
const HEIGHT: f64 = 0.12;
/// The number of the first of the sensors that look down.
const FIRST: u8 = 21;

/// A robot that does not fall off edges, whatever its program does.
///
/// Four distance sensors look down, one beyond each corner of the outline's bounding box: 35 mm ahead and as
/// much aside. Where one of them finds no ground, only such motions are passed on as take that corner
/// away from edges in all directions; anything else stops the robot, and so does a sensor that fails. Speeds
/// are reduced such that no place of the outline is faster than [`speed`](CliffGuardParameters::speed), on
/// the same circle.
///
/// # Why it does not fall
///
/// Of a straight edge with its normal *n*, the corner in whose quadrant *n* lies is the nearest place of the
/// box. In the robot's axes, with the corner's signs, *n* = (a, b) with a, b ≥ 0 and a + b ≥ 1. Its sensor
/// looks 35 mm · (a + b) ≥ 35 mm nearer to the edge. So it finds the ground missing while the corner is at
/// least 35 mm away, less the way in the reaction time; then the robot stops within
/// [`StoppingModel::distance`], which is required to be at most 35 mm. A robot that stands has at most
/// 35 mm · √2 to the edge beside what it stopped too early.
///
/// Motors cannot be driven one by one through it: nothing would be known of their speeds.
///
/// On level ground that drops by more than 0.1 m, that is; not if the robot slides down a slope, is pushed,
/// or stands beside a spit of land narrower than itself.
///
/// ```
/// use roverlab::geometry::Twist;
/// use roverlab::io::{Clock, Drive, MockRobot, Odometry, Psd};
/// use roverlab::safety::{CliffGuard, CliffGuardParameters};
/// use roverlab::world::RobotSpec;
///
/// # fn main() -> roverlab::io::Result<()> {
/// let spec = CliffGuard::equip(RobotSpec::blizzard());
/// // The ground ends ahead on the left after the first look at it.
/// let robot = MockRobot::new().with_ideal_drive();
/// let robot = robot.with_distance(Psd(21), vec![0.14, 0.14, 0.4]);
/// let robot = [22, 23, 24].into_iter().fold(robot, |robot, id| robot.with_distance(Psd(id), 0.14));
/// let mut robot = CliffGuard::new(robot, &spec, CliffGuardParameters::default())?;
/// robot.set_speed(Twist::new(0.2, 0.0))?;
/// robot.wait(5.0)?;
/// assert!(robot.pose()?.x < 0.02 && robot.is_at_edge());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct CliffGuard<R> {
    inner: R,
    parameters: CliffGuardParameters,
    corners: [Corner; 4],
    /// The speed given to the robot, if its last command was a speed.
    told: Option<Twist>,
}

/// A corner of the outline, and whether there is ground before it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Corner {
    place: Vector,
    /// Which way is outwards along both axes: 1 or -1.
    outwards: Vector,
    psd: Psd,
    missing: bool,
}

impl Corner {
    /// Whether a motion brings the corner no nearer to any edge beyond it.
    fn allows(&self, twist: Twist) -> bool {
        let velocity = velocity(self.place, twist);
        let nearer = velocity.component_mul(&self.outwards);
        !self.missing || (nearer.x <= 0.0 && nearer.y <= 0.0)
    }
}

/// Velocity of a place of a robot in its own axes.
fn velocity(place: Vector, twist: Twist) -> Vector {
    Vector::new(twist.linear - twist.angular * place.y, twist.angular * place.x)
}

/// The corners of a robot's bounding box, and the numbers of their sensors.
fn corners(spec: &RobotSpec) -> [Corner; 4] {
    let Aabb { min, max } = match spec.footprint {
        Footprint::Disc { radius } => {
            let reach = Vector::repeat(radius);
            Aabb::new((-reach).into(), reach.into())
        }
        Footprint::Rectangle(outline) => outline,
    };
    let places = [(max.x, max.y), (max.x, min.y), (min.x, max.y), (min.x, min.y)];
    let outwards = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    [0, 1, 2, 3].map(|number: usize| Corner {
        place: Vector::new(places[number].0, places[number].1),
        outwards: Vector::new(outwards[number].0, outwards[number].1),
        psd: Psd(FIRST + number as u8),
        missing: false,
    })
}

/// The reading of the sensors on level ground.
fn level() -> f64 {
    math::hypot(HEIGHT, math::hypot(AHEAD, AHEAD))
}

impl CliffGuard<()> {
    /// A robot with the four distance sensors that look down, numbers 21 to 24: left and right ahead, left
    /// and right behind.
    #[must_use]
    pub fn equip(mut spec: RobotSpec) -> RobotSpec {
        let pitch = math::atan2(HEIGHT, math::hypot(AHEAD, AHEAD));
        spec.psds.extend(corners(&spec).map(|corner| {
            let Corner { place, outwards, psd, .. } = corner;
            let yaw = math::atan2(outwards.y, outwards.x);
            let mount = Mount { x: place.x, y: place.y, z: HEIGHT, pitch, yaw, ..Mount::default() };
            let name = format!("PSD_EDGE_{}", psd.0);
            PsdSpec { id: psd.0, name, mount, max_range: PsdSpec::DEFAULT_MAX_RANGE }
        }));
        spec
    }
}

impl<R> CliffGuard<R> {
    /// Guards a robot with the sensors of [`equip`](CliffGuard::equip). Fails for parameters out of range.
    pub fn new(inner: R, spec: &RobotSpec, parameters: CliffGuardParameters) -> Result<Self> {
        parameters.validate()?;
        Ok(Self { inner, parameters, corners: corners(spec), told: None })
    }

    /// Whether ground was missing at the last look.
    pub fn is_at_edge(&self) -> bool {
        self.corners.iter().any(|corner| corner.missing)
    }

    /// The wrapped robot.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The wrapped robot, without the guard.
    pub fn into_inner(self) -> R {
        self.inner
    }

    /// Metres of the farthest corner from the middle.
    fn radius(&self) -> f64 {
        self.corners.iter().map(|corner| corner.place.norm()).fold(0.0, f64::max)
    }

    /// The same motion with no place of the outline faster than allowed.
    fn slowed(&self, twist: Twist) -> Twist {
        let fastest = twist.linear.abs() + twist.angular.abs() * self.radius();
        let share = if fastest > self.parameters.speed { self.parameters.speed / fastest } else { 1.0 };
        Twist::new(twist.linear * share, twist.angular * share)
    }

    fn allows(&self, twist: Twist) -> bool {
        self.corners.iter().all(|corner| corner.allows(twist))
    }
}

impl<R: Clock + Drive + Odometry + DistanceSensors> CliffGuard<R> {
    /// Looks at the ground, and stops a motion that it does not allow.
    fn look(&mut self) -> Result<()> {
        let found = self.read();
        if let Err(error) = found {
            self.halt()?;
            return Err(error);
        }
        if !self.is_at_edge() {
            return Ok(());
        }
        let moving = match self.told {
            Some(told) => told,
            None => self.inner.speed()?,
        };
        if self.allows(moving) { Ok(()) } else { self.halt() }
    }

    fn read(&mut self) -> Result<()> {
        let most = level() + self.parameters.drop;
        for corner in &mut self.corners {
            let range = self.inner.distance(corner.psd)?;
            // No return, and what is no number, is no ground.
            corner.missing = range.is_nan() || range > most;
        }
        Ok(())
    }

    fn halt(&mut self) -> Result<()> {
        self.told = Some(Twist::STOP);
        self.inner.set_speed(Twist::STOP)
    }

    /// Checks a manoeuvre before it starts.
    fn admits(&mut self, twist: Twist) -> Result<bool> {
        self.read()?;
        self.told = None;
        let allowed = self.allows(twist);
        if !allowed {
            self.halt()?;
        }
        Ok(allowed)
    }
}

impl<R: Clock + Drive + Odometry + DistanceSensors> Clock for CliffGuard<R> {
    fn now(&mut self) -> Result<f64> {
        self.inner.now()
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        let mut left = seconds;
        while left > self.parameters.period {
            self.inner.wait(self.parameters.period)?;
            left -= self.parameters.period;
            self.look()?;
        }
        self.inner.wait(left)?;
        self.look()
    }

    fn peek_time(&mut self) -> Result<f64> {
        self.inner.peek_time()
    }
}

impl<R: Clock + Drive + Odometry + DistanceSensors> Drive for CliffGuard<R> {
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        let twist = if twist.is_finite() { self.slowed(twist) } else { twist };
        self.told = Some(twist);
        self.look()?;
        match self.told {
            Some(told) if told == twist => self.inner.set_speed(twist),
            _ => Ok(()),
        }
    }
}

impl<R: Clock + Drive + Odometry + DistanceSensors + Manoeuvres> Manoeuvres for CliffGuard<R> {
    fn straight(&mut self, distance: f64, speed: f64) -> Result<()> {
        let speed = speed.clamp(-self.parameters.speed, self.parameters.speed);
        if self.admits(Twist::new(distance.signum(), 0.0))? {
            self.inner.straight(distance, speed)
        } else {
            Ok(())
        }
    }

    fn turn(&mut self, angle: f64, speed: f64) -> Result<()> {
        let most = self.parameters.speed / self.radius();
        if self.admits(Twist::new(0.0, angle.signum()))? {
            self.inner.turn(angle, speed.clamp(-most, most))
        } else {
            Ok(())
        }
    }

    fn curve(&mut self, length: f64, angle: f64, speed: f64) -> Result<()> {
        let most = self.slowed(Twist::new(speed, speed * angle / length)).linear;
        let speed = if most.is_finite() { most } else { speed };
        if self.admits(Twist::new(length.signum(), angle / length.abs()))? {
            self.inner.curve(length, angle, speed)
        } else {
            Ok(())
        }
    }

    fn remaining(&mut self) -> Result<f64> {
        self.inner.remaining()
    }

    fn is_done(&mut self) -> Result<bool> {
        self.inner.is_done()
    }

    fn wait_done(&mut self) -> Result<()> {
        while !self.inner.is_done()? {
            self.wait(self.parameters.period)?;
        }
        Ok(())
    }
}

impl<R: Clock + Drive + Odometry + DistanceSensors + Keys> Keys for CliffGuard<R> {
    fn read_key(&mut self) -> Result<Option<Key>> {
        self.inner.read_key()
    }

    /// Looks at the ground while it waits.
    fn wait_key(&mut self) -> Result<Key> {
        loop {
            if let Some(key) = self.read_key()? {
                return Ok(key);
            }
            self.wait(self.parameters.period)?;
        }
    }

    fn read_touch(&mut self) -> Result<Option<Pixel>> {
        self.inner.read_touch()
    }
}

/// Traits that move nothing.
macro_rules! passed_on {
    ($capability:ident { $( fn $name:ident($($arg:ident: $type:ty),*) -> $result:ty; )* }) => {
        impl<R: $capability> $capability for CliffGuard<R> {
            $( fn $name(&mut self $(, $arg: $type)*) -> Result<$result> {
                self.inner.$name($($arg),*)
            } )*
        }
    };
}

signatures! { Odometry => passed_on!() }
signatures! { StallDetector => passed_on!() }
signatures! { DistanceSensors => passed_on!() }
signatures! { Lidar => passed_on!() }
signatures! { Camera => passed_on!() }
signatures! { Display => passed_on!() }
signatures! { Radio => passed_on!() }
signatures! { Servos => passed_on!() }
signatures! { Encoders => passed_on!() }
signatures! { Inertial => passed_on!() }
signatures! { DepthSensor => passed_on!() }
