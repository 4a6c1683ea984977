use std::ops::ControlFlow;

use super::super::follower::PATIENCE;
use super::{WallFollower, WallObservation, WallPhase, WallSide};
use crate::geometry::{Point, Pose, Twist};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::{DistanceSensors, Lidar, LidarScan, Odometry, Psd, Result, StallDetector};
use crate::kinematics::{Displacement, advance};

/// A controller that steers along walls.
///
/// # For implementers
///
/// `steer` is called once per period, with the time since its last call. Stop rather than fail where no
/// wall is found.
#[auto_impl::auto_impl(&mut)]
pub trait FollowsWalls {
    /// Input of the controller.
    type Observation: Default;

    /// The velocity for an observation, `seconds` after the last step.
    fn steer(&mut self, seen: &Self::Observation, seconds: f64) -> Result<Twist>;

    /// Control period (s).
    fn period(&self) -> f64;

    /// Whether the robot drives along a wall.
    fn is_beside_wall(&self) -> bool;

    /// Side of the wall, once decided.
    fn wall_side(&self) -> Option<WallSide>;
}

/// Observation that a wall-following controller reads from a robot.
///
/// # For implementers
///
/// Overwrite the whole observation. Do not wait and do not move the robot.
pub trait WallReading<R: ?Sized> {
    /// Reads the sensors into the observation.
    fn read(&mut self, robot: &mut R) -> Result<()>;
}

impl<R: Odometry + DistanceSensors + ?Sized> WallReading<R> for WallObservation {
    fn read(&mut self, robot: &mut R) -> Result<()> {
        *self = Self {
            pose: robot.pose()?,
            front: robot.distance(Psd::FRONT)?,
            left: robot.distance(Psd::LEFT)?,
            right: robot.distance(Psd::RIGHT)?,
        };
        Ok(())
    }
}

impl<R: Lidar + ?Sized> WallReading<R> for LidarScan {
    fn read(&mut self, robot: &mut R) -> Result<()> {
        robot.scan_into(self)
    }
}

/// Outcome of a drive along walls.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum WallOutcome {
    /// The observer stopped the run.
    Stopped,
    /// The time limit came first.
    TimedOut,
    /// The drive has stalled, or the robot keeps turning for lack of room or of walls: in one place, or
    /// without getting along any.
    Blocked,
}

halts!(WallOutcome { Blocked: "something holds the robot, or it has no room" });

/// A drive along walls by a controller.
///
/// ```
/// use roverlab::drive::{AlongWall, WallFollower, WallFollowerParameters};
/// use roverlab::geometry::Pose;
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::world::{RobotSpec, Scene, World};
/// let scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(0.5, 1.7, 0.0));
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let mut drive = AlongWall::new(WallFollower::new(WallFollowerParameters::default())?);
/// run(&mut simulation.robot(0)?, &mut drive, 30.0, |_, _, _| {})?;
/// let truth = simulation.truth().robot(0)?;
/// assert!(truth.contacts == 0 && truth.path_length > 3.0);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct AlongWall<C> {
    /// The controller.
    pub controller: C,
    /// Time of the last step, and of the last one without a stall (s).
    last: Option<f64>,
    free: f64,
    spot: Spot,
}

/// Dead reckoning by commands since a place: displacement and total turn; and the total turn since the robot
/// last got along walls.
#[derive(Debug, Clone, Copy, Default)]
struct Spot {
    /// Pose in the frame of the place.
    pose: Pose,
    turned: f64,
    /// Length of the way beside walls, and total turn, since the robot last got along them.
    along: f64,
    turned_apart: f64,
    told: Twist,
}

/// Distance from a point within which the robot counts as being there (m).
const HERE: f64 = 0.2;
/// Length of the way beside walls, in all, after which the robot has got along them (m): where all walls are
/// short, most of the way is in corners.
const ALONG: f64 = 0.1;
/// Turn in one place, or apart from walls, after which the robot counts as blocked (rad).
const ROUND: f64 = 3.0 * std::f64::consts::TAU;

impl Spot {
    /// Integrates the commanded velocity. Returns whether the robot only turns round.
    fn advance(&mut self, seconds: f64, is_beside_wall: bool) -> bool {
        let (length, angle) = (self.told.linear * seconds, self.told.angular * seconds);
        self.pose = advance(self.pose, Displacement { length, angle });
        self.turned += angle;
        if self.pose.distance_to(Point::origin()) > HERE {
            (self.pose, self.turned) = (Pose::default(), 0.0);
        }
        self.along += if is_beside_wall { length } else { 0.0 };
        self.turned_apart += angle;
        if self.along > ALONG {
            (self.along, self.turned_apart) = (0.0, 0.0);
        }
        self.turned.abs().max(self.turned_apart.abs()) > ROUND
    }
}

impl<C: FollowsWalls> AlongWall<C> {
    /// Creates a drive by a controller.
    pub fn new(controller: C) -> Self {
        Self { controller, last: None, free: 0.0, spot: Spot::default() }
    }
}

/// Observation of a drive along walls.
#[derive(Debug, Clone, Default)]
pub struct AlongWallObservation<O> {
    /// Whether the drive has stalled.
    pub stalled: bool,
    /// Input of the controller.
    pub seen: O,
}

impl<C: FollowsWalls> Behaviour for AlongWall<C> {
    type Observation = AlongWallObservation<C::Observation>;
    type Command = Twist;
    type Outcome = WallOutcome;

    fn period(&self) -> f64 {
        self.controller.period()
    }

    fn step(&mut self, time: f64, now: &Self::Observation) -> Decision<Self> {
        let last = self.last.replace(time);
        if !now.stalled || last.is_none() {
            self.free = time;
        } else if time - self.free > PATIENCE {
            return Ok(ControlFlow::Break(WallOutcome::Blocked));
        }
        let seconds = last.map_or(0.0, |last| time - last);
        if self.spot.advance(seconds, self.controller.is_beside_wall()) {
            return Ok(ControlFlow::Break(WallOutcome::Blocked));
        }
        self.spot.told = self.controller.steer(&now.seen, seconds)?;
        Ok(ControlFlow::Continue(self.spot.told))
    }
}

impl<R, C> Senses<R> for AlongWall<C>
where
    R: StallDetector + ?Sized,
    C: FollowsWalls<Observation: WallReading<R>>,
{
    fn sense(&mut self, robot: &mut R, _time: f64, now: &mut Self::Observation) -> Result<()> {
        now.stalled = robot.is_stalled()?;
        now.seen.read(robot)
    }
}

impl FollowsWalls for WallFollower {
    type Observation = WallObservation;

    fn steer(&mut self, seen: &WallObservation, _seconds: f64) -> Result<Twist> {
        self.step(seen)
    }

    fn period(&self) -> f64 {
        self.parameters().period
    }

    fn is_beside_wall(&self) -> bool {
        self.phase() == WallPhase::Following
    }

    fn wall_side(&self) -> Option<WallSide> {
        self.side()
    }
}
