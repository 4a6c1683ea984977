use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use super::helm::Helm;
use super::legs::over_ground;
use super::reckoning::Reckoning;
use super::wall_memory::WallMemory;
use super::{DepthHoldParameters, DiveObservation, Thrust};
use crate::geometry::{Point, Pose, Vector, Vector3, WallSide, direction, math, normalize_angle};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::reading::{check_distances, check_pose};
use crate::io::{DepthSensor, DistanceSensors, Error, Inertial, Odometry, Psd, Result};
use crate::kinematics::marine::{CraftMotion, Wrench};
use crate::parameter::{require_not_negative, require_positive, require_up_to};
use crate::world::{DriveSpec, RobotSpec};

/// Parameters of [`PoolWall`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoolWallParameters {
    /// Depth of the pressure sensor (m).
    pub depth: f64,
    /// Distance from the craft's side to the wall (m).
    pub distance: f64,
    /// Speed (m/s).
    pub speed: f64,
    /// Side of the wall.
    pub side: WallSide,
    /// Number of laps after which the drive ends.
    pub laps: u32,
    /// Distance ahead of the point the craft steers for (m).
    pub lookahead: f64,
    /// Control period (s).
    pub period: f64,
    /// Parameters of the depth controller.
    pub hold: DepthHoldParameters,
}

impl Default for PoolWallParameters {
    /// One lap at 0.3 m/s, half a metre beside the wall on the left, 0.8 m deep.
    fn default() -> Self {
        Self {
            depth: 0.8,
            distance: 0.5,
            speed: 0.3,
            side: WallSide::Left,
            laps: 1,
            lookahead: 0.8,
            period: 0.1,
            hold: DepthHoldParameters::default(),
        }
    }
}

/// Observation of [`PoolWall`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PoolWallObservation {
    /// Depth, attitude and turn rates.
    pub dive: DiveObservation,
    /// Pose by the log: over ground, or with a log that does not see the ground, relative to the water.
    pub odometry: Pose,
    /// Reading of the distance sensor ahead (m).
    pub front: f64,
    /// Reading of the distance sensor at the side of the wall (m).
    pub side: f64,
    /// Reading of the distance sensor at the other side (m).
    pub far: f64,
}

/// Outcome of a drive along the sides of a pool.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PoolWallOutcome {
    /// All laps are done.
    Round,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(PoolWallOutcome { Round: "all laps are done" });

/// Follows the sides of a pool at a depth, by the distance sensors ahead and at both sides (book, section
/// 8.5).
///
/// It remembers the points that the sensors have hit, placed by dead reckoning, and extrapolates the wall
/// beside it by a parabola as long as there is no gap. It steers by pure pursuit: of the points at the
/// lookahead distance, to the one nearest to the wall that keeps the desired distance from all known walls.
/// This one rule rounds outer corners, turns before walls ahead, and approaches a wall from afar. The sensor
/// at the other side shows a wall that the craft approaches at a small angle with the wrong side: the beam
/// ahead meets it farther on.
///
/// In a current it crabs: what of its speed neither thrust nor turn explains is learnt as that of the water,
/// and steered against. Only a Doppler log, which sees the ground, shows it; without one the remembered
/// points drift away with the water.
///
/// ```
/// use roverlab::drive::marine::{PoolWall, PoolWallOutcome, PoolWallParameters};
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::random::Stream;
/// use roverlab::world::generate::{PoolKind, pool};
/// use roverlab::world::{RobotSpec, Scene};
///
/// let pool = pool(&mut Stream::new(1), PoolKind::Kidney)?;
/// let scene = Scene::with_robot(pool.world, RobotSpec::mako(), pool.start);
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let mut round = PoolWall::new(&RobotSpec::mako(), PoolWallParameters::default())?;
/// assert_eq!(run(&mut simulation.robot(0)?, &mut round, 400.0, |_, _, _| {})?, PoolWallOutcome::Round);
/// assert_eq!(simulation.truth().robot(0)?.contacts, 0);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct PoolWall {
    parameters: PoolWallParameters,
    helm: Helm,
    reckoning: Reckoning,
    walls: WallMemory,
    /// Places of the sensors in the craft's frame, mirrored if the wall is on the right.
    front: Point,
    side: Point,
    far: Point,
    lap: Option<Lap>,
    /// Speed through the water forward and to the left (m/s) that thrust and turn have led to.
    through: Vector,
    /// Velocity of the water (m/s).
    current: Vector,
}

/// A round along the wall.
#[derive(Debug, Clone, Copy)]
struct Lap {
    /// Where it began; the heading is not bounded.
    start: Pose,
    number: u32,
}

/// Where a craft steers for.
#[derive(Debug, Clone, Copy)]
struct Aim {
    /// The angle (rad) from the heading to the place.
    angle: f64,
    /// How much the way there bends (rad/m), positive to the left.
    bend: f64,
}

impl Aim {
    /// A place straight away.
    fn at(angle: f64) -> Self {
        Self { angle, bend: 0.0 }
    }
}

/// Radians per second: the fastest turn.
const FASTEST: f64 = 0.5;
/// Least forward speed in the computation of the slip angle (m/s).
const CREEP: f64 = 0.15;
/// Largest slip angle that is steered against (rad).
const SLIP: f64 = 0.6;
/// Turn rate per angle to the place that is steered for (1/s).
const GAIN: f64 = 1.0;
/// Weight of the momentary slip in that angle; the rest is the slip that a turn ends with, because the
/// momentary slip alone would make the craft swing.
const MOMENTARY: f64 = 0.45;
/// Time in which a current is learnt (s): longer than a craft swings in a turn.
const LEARNING: f64 = 8.0;
/// Metres between the walls nearest here and there within which the way leads round a corner.
const PIVOT: f64 = 0.2;
/// Steps in which a direction is looked for (rad).
const STEP: f64 = 0.1;
/// Halvings of a step.
const HALVINGS: usize = 6;
/// Distance before the nose that stays free (m).
const FREE: f64 = 0.2;
/// Time in which the rest of the distance ahead is driven (s); it limits the speed.
const BRAKING: f64 = 2.0;
/// Metres from the depth, and from the distance, at which the drive and its first lap begin.
const BEGIN: f64 = 0.1;
/// Angle that may be missing from a full turn when a lap ends (rad).
const NEARLY: f64 = 0.6;
/// Largest distance from a lap's start at which it ends (m).
const CLOSE: f64 = 2.5;

impl PoolWall {
    /// Creates a drive for a craft with distance sensors ahead and at both sides. Fails without them, and for
    /// parameters out of range.
    pub fn new(robot: &RobotSpec, parameters: PoolWallParameters) -> Result<Self> {
        let DriveSpec::Craft(craft) = &robot.drive else {
            return Err(Error::invalid_input("robot", &robot.name, "a craft"));
        };
        require_not_negative("depth", parameters.depth)?;
        require_positive("distance", parameters.distance)?;
        require_positive("speed", parameters.speed)?;
        require_positive("lookahead", parameters.lookahead)?;
        require_up_to("lookahead", parameters.lookahead, 10.0)?;
        require_positive("period", parameters.period)?;
        if parameters.laps == 0 {
            return Err(Error::invalid_input("laps", 0, "at least 1"));
        }
        let mirror = mirror(parameters.side);
        let [side, far] = sensors(parameters.side);
        let place = |psd: Psd| {
            let spec = robot.psds.iter().find(|spec| spec.id == psd.0);
            spec.map(|spec| Point::new(spec.mount.x, mirror * spec.mount.y))
                .ok_or_else(|| Error::unsupported(psd))
        };
        let helm = Helm::new(craft, 0.8, parameters.period, parameters.hold)?;
        Ok(Self {
            helm,
            front: place(Psd::FRONT)?,
            side: place(side)?,
            far: place(far)?,
            reckoning: Reckoning::default(),
            walls: WallMemory::default(),
            lap: None,
            through: Vector::zeros(),
            current: Vector::zeros(),
            parameters,
        })
    }

    /// Number of complete laps so far.
    pub fn laps(&self) -> u32 {
        self.lap.map_or(0, |lap| lap.number)
    }

    fn notice(&mut self, time: f64, seen: &PoolWallObservation) -> Result<()> {
        self.helm.observe(time, &seen.dive)?;
        let sense = mirror(self.parameters.side);
        let Pose { x, y, heading } = seen.odometry;
        let mirrored = Pose::new(x, sense * y, sense * heading);
        self.reckoning.advance(mirrored, sense * self.helm.heading(), self.helm.seconds());
        let pose = self.reckoning.pose();
        let hit = |sensor: Point, way: Vector, range: f64| {
            range.is_finite().then(|| pose.to_world(sensor + way * range))
        };
        let side = hit(self.side, Vector::y(), seen.side);
        let others = [hit(self.front, Vector::x(), seen.front), hit(self.far, -Vector::y(), seen.far)];
        self.walls.add(pose.position(), side, others);
        Ok(())
    }

    /// Where to steer for: from the direction of the nearest wall on, the first place ahead that keeps the
    /// distance.
    fn aim(&self) -> Aim {
        let (pose, ahead) = (self.reckoning.pose(), self.parameters.lookahead);
        let place = pose.position();
        let apart = self.parameters.distance + self.side.y;
        let Some(wall) = self.walls.nearest(place) else { return Aim::at(0.0) };
        let towards = pose.bearing_to(wall);
        if (wall - place).norm() >= apart + ahead {
            return Aim::at(towards);
        }
        // In the time that it takes to turn there, the current carries it on.
        let there = |aside: f64| {
            let turn = normalize_angle(towards - aside);
            place + direction(pose.heading + turn) * ahead + self.current * (turn.abs() / FASTEST)
        };
        let is_free = |aside: f64| self.walls.clearance(there(aside)) >= apart;
        let steps = (PI / STEP) as u32;
        let free = (1..=steps).map(|step| STEP * f64::from(step)).find(|&aside| is_free(aside));
        let Some(mut free) = free else { return Aim::at(normalize_angle(towards - PI)) };
        let mut blocked = free - STEP;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (free + blocked);
            if is_free(middle) { free = middle } else { blocked = middle }
        }
        // Round a corner the way bends about it, elsewhere as the wall does.
        let next = self.walls.nearest(there(free)).unwrap_or(wall);
        let pivots = (next - wall).norm() < PIVOT;
        let bend = self.walls.bend();
        let bend = if pivots { 1.0 / apart } else { bend / (1.0 - bend * apart).max(0.3) };
        Aim { angle: normalize_angle(towards - free), bend }
    }

    /// Counts laps. Round a pool, the craft turns once.
    fn count(&mut self, side: f64) {
        let pose = self.reckoning.pose();
        let Some(lap) = &mut self.lap else {
            if (side - self.parameters.distance).abs() < BEGIN {
                self.lap = Some(Lap { start: pose, number: 0 });
            }
            return;
        };
        let turned = lap.start.heading - pose.heading;
        let start = Pose { heading: lap.start.heading, ..lap.start };
        let passed = start.to_local(pose.position());
        if turned > TAU - NEARLY && passed.x >= 0.0 && passed.coords.norm() < CLOSE {
            *lap = Lap { start: Pose { heading: lap.start.heading - TAU, ..pose }, number: lap.number + 1 };
        }
    }

    /// Learns the current. Returns the slip (rad) by it, besides that of turning, of a craft that moves at a
    /// velocity.
    fn crab(&mut self, velocity: Vector) -> f64 {
        let (pose, seconds) = (self.reckoning.pose(), self.helm.seconds());
        let turn_rate = mirror(self.parameters.side) * self.helm.turn_rate();
        let linear = Vector3::new(self.through.x, self.through.y, 0.0);
        let own = CraftMotion { linear, angular: Vector3::z() * turn_rate };
        let push = Wrench { force: Vector3::x() * self.helm.pushed(), moment: Vector3::zeros() };
        self.through += self.helm.craft().response(&own, &push).linear.xy() * seconds;
        let drift = over_ground(&pose, velocity - self.through);
        self.current += (drift - self.current) * (seconds / LEARNING).min(1.0);
        let aside = self.current.dot(&direction(pose.heading + 0.5 * PI));
        math::atan2(aside, self.parameters.speed).clamp(-SLIP, SLIP)
    }

    fn thrust(&mut self, seen: &PoolWallObservation) -> Result<Thrust> {
        let PoolWallParameters { depth, speed, lookahead, .. } = self.parameters;
        let Aim { angle, bend } = self.aim();
        let velocity = self.reckoning.velocity();
        let slip = math::atan2(velocity.y, velocity.x.max(CREEP)).clamp(-SLIP, SLIP);
        let lasting = self.helm.slip(speed, speed * bend).clamp(-SLIP, SLIP);
        let lasting = lasting + self.crab(velocity);
        let off = angle - MOMENTARY * slip - (1.0 - MOMENTARY) * lasting;
        // What of the angle is the chord of the bend is no error.
        let turn = GAIN * math::sin(off.clamp(-0.5 * PI, 0.5 * PI)) + (speed - 0.5 * GAIN * lookahead) * bend;
        let turn = turn.clamp(-FASTEST, FASTEST);
        let free = (seen.front - FREE) / BRAKING;
        let deep = (seen.dive.depth - depth).abs() < BEGIN || self.lap.is_some();
        let wanted = if deep { speed * math::cos(off).max(0.0) } else { 0.0 };
        let wanted = wanted.min(free.max(0.0));
        let push = self.helm.push(velocity.x, wanted, mirror(self.parameters.side) * turn);
        self.helm.thrust(depth, push)
    }
}

/// 1 with the wall on the left, -1 with a mirrored world.
fn mirror(side: WallSide) -> f64 {
    if side == WallSide::Left { 1.0 } else { -1.0 }
}

/// The distance sensors at the side of the wall and at the other one.
fn sensors(side: WallSide) -> [Psd; 2] {
    match side {
        WallSide::Left => [Psd::LEFT, Psd::RIGHT],
        WallSide::Right => [Psd::RIGHT, Psd::LEFT],
    }
}

impl Behaviour for PoolWall {
    type Observation = PoolWallObservation;
    type Command = Thrust;
    type Outcome = PoolWallOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &PoolWallObservation) -> Decision<Self> {
        seen.dive.check()?;
        check_pose(&seen.odometry)?;
        check_distances("observed distance", &[seen.front, seen.side, seen.far])?;
        self.notice(time, seen)?;
        self.count(seen.side);
        if self.laps() >= self.parameters.laps {
            return Ok(ControlFlow::Break(PoolWallOutcome::Round));
        }
        Ok(ControlFlow::Continue(self.thrust(seen)?))
    }
}

impl<R: DepthSensor + Inertial + Odometry + DistanceSensors + ?Sized> Senses<R> for PoolWall {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut PoolWallObservation) -> Result<()> {
        seen.dive.read(robot)?;
        seen.odometry = robot.pose()?;
        seen.front = robot.distance(Psd::FRONT)?;
        let [side, far] = sensors(self.parameters.side);
        seen.side = robot.distance(side)?;
        seen.far = robot.distance(far)?;
        Ok(())
    }
}
