use super::cliff_parameters::CliffGuardParameters;
use crate::geometry::{Pose, Twist, Vector, Vector3, math};
use crate::io::wrappers::signatures;
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Odometry, Pixel, Psd, Radio,
    RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::parameter::require_finite;
use crate::world::{Colour, Footprint, Mount, PsdSpec, RobotSpec};
use image::RgbImage;

/// A robot that does not drive over edges, whatever its program does.
///
/// Beyond each corner of the outline's bounding box, two distance sensors look at the ground. They look as
/// far ahead of the corner as aside of it: the outer one by [`far`](CliffGuardParameters::far), the inner one
/// by [`near`](CliffGuardParameters::near). Where the outer one of a corner finds no ground, the robot stops
/// and then creeps; where the inner one finds none, it stops. Motions that bring the corner no nearer to any
/// edge beyond it are not limited. Speeds are reduced on the same circle, such that no place of the outline
/// is faster than [`speed`](CliffGuardParameters::speed). A sensor that fails stops the robot.
///
/// # Proof
///
/// Let *n* be the normal of a straight edge. The corner in whose quadrant *n* lies is the place of the box
/// that is nearest to the edge; in the robot's axes with that corner's signs, *n* = (a, b) with a, b ≥ 0 and
/// 1 ≤ a + b ≤ √2. A sensor that looks *s* beyond the corner along both axes looks (a + b) s nearer to the
/// edge. It therefore finds ground as long as the corner is farther than (a + b) s from the edge.
///
/// 1. *From the outer to the inner sensor.* While the outer sensor finds ground, the corner is at least `far`
///    away. Afterwards the robot stops within `D(speed)`, where `D` is [`StoppingModel::distance`], and goes
///    on at `creep` at most: a first-order lag has no overshoot. As `far = √2 near + D(speed)`, it is no
///    faster than `creep` when the inner sensor loses the ground.
/// 2. *From the inner sensor to the edge.* While the inner sensor finds ground, the corner is at least `near`
///    away. Afterwards the robot stops within `D(creep) = near`.
/// 3. *Nearness.* The inner sensor finds ground until the corner is √2 `near` from the edge. A robot that is
///    driven on therefore stands within √2 `near` of the edge, measured from its box. A disc of radius r may
///    be (√2 - 1) r farther away than its box.
///
/// `D` contains the reaction (two periods: one look, and the one that was just missed), the lag of the
/// motors, their limited deceleration and the error of the speed.
///
/// [`StoppingModel::distance`]: super::StoppingModel::distance
///
/// # Assumptions
///
/// The ground drops by more than [`drop`](CliffGuardParameters::drop) at an edge, and bends by less under and
/// around the robot. The robot does not slide, and nobody pushes it. Edges are straight over the robot's
/// size: a spit of land narrower than the robot lies between its sensors. The guard checks the ground at
/// every call that is due, so a program must make a call (such as a wait) in each period. Motors cannot be
/// driven one by one through it, because their speeds would be unknown. For manoeuvres put
/// [`Manoeuvring`](crate::io::wrappers::Manoeuvring) around the guard.
///
/// ```
/// use roverlab::geometry::Twist;
/// use roverlab::io::{Clock, Drive, MockRobot, Odometry, Psd};
/// use roverlab::safety::{CliffGuard, CliffGuardParameters};
/// use roverlab::world::RobotSpec;
///
/// # fn main() -> roverlab::io::Result<()> {
/// let plain = RobotSpec::blizzard();
/// let parameters = CliffGuardParameters::of(&plain);
/// let spec = CliffGuard::equip(plain, &parameters);
/// // The ground ends ahead on the left after the first two looks.
/// let robot = (21..29).fold(MockRobot::new().with_ideal_drive(), |robot, id| robot.with_distance(Psd(id), 0.2));
/// let robot = robot.with_distance(Psd(25), [vec![0.2; 2], vec![0.6; 1000]].concat());
/// let mut robot = CliffGuard::new(robot, &spec, parameters)?;
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
    /// The program's last command, and the one given to the robot.
    told: Twist,
    given: Twist,
    /// Whether the robot has slowed down since an outer sensor lost the ground.
    slow: bool,
    /// Time of the next look (s).
    due: f64,
}

/// A corner of the outline's bounding box, with its sensors.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Corner {
    place: Vector,
    /// Direction outwards along both axes: 1 or -1.
    outwards: Vector,
    outer: Eye,
    inner: Eye,
}

/// A sensor that looks at the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Eye {
    psd: Psd,
    /// Largest reading that shows ground (m).
    most: f64,
    /// Whether the last reading showed none.
    lost: bool,
}

/// Numbers of the first outer and of the first inner sensor.
const OUTER: u8 = 21;
const INNER: u8 = 25;

impl Corner {
    /// Whether a motion brings the corner no nearer to any edge beyond it.
    fn leaves(&self, twist: Twist) -> bool {
        let nearer = velocity(self.place, twist).component_mul(&self.outwards);
        nearer.x <= 0.0 && nearer.y <= 0.0
    }
}

/// Velocity of a place of a robot in its own axes.
fn velocity(place: Vector, twist: Twist) -> Vector {
    Vector::new(twist.linear - twist.angular * place.y, twist.angular * place.x)
}

/// Positions of the corners of a robot's bounding box, and their directions outwards.
fn corners(spec: &RobotSpec) -> [(Vector, Vector); 4] {
    let (min, max) = match spec.footprint {
        Footprint::Disc { radius } => (Vector::repeat(-radius), Vector::repeat(radius)),
        Footprint::Rectangle(outline) => (outline.min.coords, outline.max.coords),
    };
    [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(ahead, left)| {
        let x = if ahead > 0.0 { max.x } else { min.x };
        let y = if left > 0.0 { max.y } else { min.y };
        (Vector::new(x, y), Vector::new(ahead, left))
    })
}

/// Distance over the ground from a corner to where its sensor looks, by the distance along each axis.
fn diagonal(ahead: f64) -> f64 {
    std::f64::consts::SQRT_2 * ahead
}

impl CliffGuard<()> {
    /// A robot with eight more distance sensors, which look down from the height of its top: the outer ones
    /// have numbers 21 to 24 (left and right in front, left and right behind), the inner ones 25 to 28.
    #[must_use]
    pub fn equip(mut spec: RobotSpec, parameters: &CliffGuardParameters) -> RobotSpec {
        for (first, ahead) in [(OUTER, parameters.far()), (INNER, parameters.near())] {
            for (id, (place, outwards)) in (first..).zip(corners(&spec)) {
                let (z, yaw) = (spec.height, math::atan2(outwards.y, outwards.x));
                let pitch = math::atan2(z, diagonal(ahead));
                let mount = Mount { x: place.x, y: place.y, z, pitch, yaw, ..Mount::default() };
                let max_range = PsdSpec::DEFAULT_MAX_RANGE;
                spec.psds.push(PsdSpec { id, name: format!("PSD_EDGE_{id}"), mount, max_range });
            }
        }
        spec
    }
}

impl<R> CliffGuard<R> {
    /// Guards a robot with the sensors of [`equip`](CliffGuard::equip). Fails for parameters out of range.
    pub fn new(inner: R, spec: &RobotSpec, parameters: CliffGuardParameters) -> Result<Self> {
        parameters.validate()?;
        // A drop lengthens an oblique ray in proportion to its height.
        let share = 1.0 + parameters.drop / spec.height;
        let eye = |id: u8, ahead: f64| {
            let most = share * math::hypot(spec.height, diagonal(ahead));
            Eye { psd: Psd(id), most, lost: false }
        };
        let mut number = 0;
        let corners = corners(spec).map(|(place, outwards)| {
            let outer = eye(OUTER + number, parameters.far());
            let inner = eye(INNER + number, parameters.near());
            number += 1;
            Corner { place, outwards, outer, inner }
        });
        let (told, given) = (Twist::STOP, Twist::STOP);
        Ok(Self { inner, parameters, corners, told, given, slow: false, due: f64::NEG_INFINITY })
    }

    /// Whether an inner sensor found no ground at the last look.
    pub fn is_at_edge(&self) -> bool {
        self.corners.iter().any(|corner| corner.inner.lost)
    }

    /// The wrapped robot.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The wrapped robot, without the guard.
    pub fn into_inner(self) -> R {
        self.inner
    }

    /// Speed of the fastest corner (m/s).
    fn fastest(&self, twist: Twist) -> f64 {
        self.corners.iter().map(|corner| velocity(corner.place, twist).norm()).fold(0.0, f64::max)
    }

    /// The same motion with no corner faster than a limit (m/s).
    fn limited(&self, twist: Twist, limit: f64) -> Twist {
        let fastest = self.fastest(twist);
        let share = if fastest > limit { limit / fastest } else { 1.0 };
        Twist::new(twist.linear * share, twist.angular * share)
    }
}

impl<R: Clock + Drive + Odometry + DistanceSensors> CliffGuard<R> {
    /// Looks at the ground if due.
    fn keep_up(&mut self) -> Result<()> {
        let now = self.inner.peek_time()?;
        if now < self.due { Ok(()) } else { self.look() }
    }

    /// Looks at the ground, and adapts the robot's velocity.
    fn look(&mut self) -> Result<()> {
        let answer = self.try_to_look();
        if answer.is_err() {
            // The first error is the one to report.
            let _ = self.inner.set_speed(Twist::STOP);
            (self.told, self.given) = (Twist::STOP, Twist::STOP);
        }
        answer
    }

    fn try_to_look(&mut self) -> Result<()> {
        self.due = self.inner.peek_time()? + self.parameters.period;
        for corner in &mut self.corners {
            for eye in [&mut corner.outer, &mut corner.inner] {
                let range = self.inner.distance(eye.psd)?;
                // No return, and what is no number, is no ground.
                eye.lost = range.is_nan() || range > eye.most;
            }
        }
        let allowed = self.allowed()?;
        if allowed != self.given {
            self.inner.set_speed(allowed)?;
            self.given = allowed;
        }
        Ok(())
    }

    /// The part of the program's command that may be given to the robot.
    fn allowed(&mut self) -> Result<Twist> {
        let told = self.limited(self.told, self.parameters.speed);
        let stays = |lost: fn(&Corner) -> bool| {
            self.corners.iter().any(|corner| lost(corner) && !corner.leaves(told))
        };
        if stays(|corner| corner.inner.lost) {
            return Ok(Twist::STOP);
        }
        if !stays(|corner| corner.outer.lost) {
            self.slow = false;
            return Ok(told);
        }
        let creep = self.parameters.creep;
        if !self.slow {
            let moving = self.inner.speed()?;
            self.slow = self.fastest(moving) <= creep;
        }
        Ok(if self.slow { self.limited(told, creep) } else { Twist::STOP })
    }
}

impl<R: Clock + Drive + Odometry + DistanceSensors> Clock for CliffGuard<R> {
    fn now(&mut self) -> Result<f64> {
        self.keep_up()?;
        self.inner.now()
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        require_finite("seconds", seconds)?;
        let mut left = seconds;
        loop {
            let until = (self.due - self.inner.peek_time()?).max(0.0);
            if left <= until {
                self.inner.wait(left)?;
                return self.keep_up();
            }
            self.inner.wait(until)?;
            left -= until;
            self.look()?;
        }
    }

    fn peek_time(&mut self) -> Result<f64> {
        self.inner.peek_time()
    }
}

impl<R: Clock + Drive + Odometry + DistanceSensors> Drive for CliffGuard<R> {
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        if !twist.is_finite() {
            return self.inner.set_speed(twist);
        }
        self.told = twist;
        self.look()
    }
}

impl<R: Clock + Drive + Odometry + DistanceSensors + Keys> Keys for CliffGuard<R> {
    fn read_key(&mut self) -> Result<Option<Key>> {
        self.keep_up()?;
        self.inner.read_key()
    }

    /// Polls once per period, and looks at the ground.
    fn wait_key(&mut self) -> Result<Key> {
        loop {
            if let Some(key) = self.read_key()? {
                return Ok(key);
            }
            self.wait(self.parameters.period)?;
        }
    }

    fn read_touch(&mut self) -> Result<Option<Pixel>> {
        self.keep_up()?;
        self.inner.read_touch()
    }
}

/// Traits that move nothing; their calls take time.
macro_rules! passed_on {
    ($capability:ident { $( fn $name:ident($($arg:ident: $type:ty),*) -> $result:ty; )* }) => {
        impl<R: Clock + Drive + Odometry + DistanceSensors + $capability> $capability for CliffGuard<R> {
            $( fn $name(&mut self $(, $arg: $type)*) -> Result<$result> {
                self.keep_up()?;
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
