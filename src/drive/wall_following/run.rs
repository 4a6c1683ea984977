use std::ops::ControlFlow;

use super::super::follower::PATIENCE;
use super::{WallFollower, WallObservation, WallPhase, WallSide};
use crate::geometry::{Point, Pose, Twist};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::{DistanceSensors, Lidar, LidarScan, Odometry, Psd, Result, StallDetector};
use crate::kinematics::{Displacement, advance};

/// A controller that steers along walls.
#[auto_impl::auto_impl(&mut)]
pub trait FollowsWalls {
    /// What it goes by.
    type Observation: Default;

    /// How to drive. `seconds` have passed since the last step.
    fn steer(&mut self, seen: &Self::Observation, seconds: f64) -> Result<Twist>;

    /// Seconds from one step to the next.
    fn period(&self) -> f64;

    /// Whether the robot drives along a wall that it has found.
    fn is_beside_wall(&self) -> bool;

    /// On which side of the robot the wall is, once that is decided.
    fn wall_side(&self) -> Option<WallSide>;
}

/// What a controller that steers along walls can read from a robot.
pub trait WallReading<R: ?Sized> {
    /// Reads it.
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

/// How a drive along walls ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum WallOutcome {
    /// The watcher has seen enough.
    Stopped,
    /// The time was over.
    TimedOut,
    /// Something holds the robot, or it has no room: it turns round and round on the spot.
    Blocked,
}

halts!(WallOutcome { Blocked: "something holds the robot, or it has no room" });

/// A drive along walls by a controller.
#[derive(Debug, Clone)]
pub struct AlongWall<C> {
    /// The controller.
    pub controller: C,
    /// When the last step was, and when the wheels were free last.
    last: Option<f64>,
    free: f64,
    spot: Spot,
}

/// How far a robot that goes as it is told has come from a place, and how far it has turned since.
#[derive(Debug, Clone, Copy, Default)]
struct Spot {
    /// In the frame of the place.
    pose: Pose,
    turned: f64,
    told: Twist,
}

/// Metres from a place within which a robot is still there.
const HERE: f64 = 0.2;
/// Radians that a robot turns in one place before it counts as blocked: round what it follows the wall of, it gets about.
const ROUND: f64 = 3.0 * std::f64::consts::TAU;

impl Spot {
    /// Goes as told for some seconds. Whether the robot only turns round.
    fn advance(&mut self, seconds: f64) -> bool {
        let angle = self.told.angular * seconds;
        self.pose = advance(self.pose, Displacement { length: self.told.linear * seconds, angle });
        self.turned += angle;
        if self.pose.distance_to(Point::origin()) > HERE {
            *self = Self { told: self.told, ..Self::default() };
        }
        self.turned.abs() > ROUND
    }
}

impl<C: FollowsWalls> AlongWall<C> {
    /// A drive that begins.
    pub fn new(controller: C) -> Self {
        Self { controller, last: None, free: 0.0, spot: Spot::default() }
    }
}

/// What is seen at a step of a drive along walls.
#[derive(Debug, Clone, Default)]
pub struct AlongWallObservation<O> {
    /// Whether something holds the robot.
    pub stalled: bool,
    /// What the controller goes by.
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
        if self.spot.advance(seconds) {
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
