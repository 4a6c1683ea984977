use std::ops::ControlFlow;

use super::{WallFollower, WallObservation, WallPhase, WallSide};
use crate::geometry::Twist;
use crate::io::{Clock, DistanceSensors, Drive, Psd, Result};

/// A controller that drives a robot along walls.
pub trait FollowsWalls<R: ?Sized> {
    /// Looks, and says how to drive. `seconds` have passed since the last step.
    fn look(&mut self, robot: &mut R, seconds: f64) -> Result<Twist>;

    /// Seconds from one step to the next.
    fn period(&self) -> f64;

    /// Whether the robot drives along a wall that it has found.
    fn is_beside_wall(&self) -> bool;

    /// On which side of the robot the wall is, once that is decided.
    fn wall_side(&self) -> Option<WallSide>;
}

/// How a drive along walls ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum WallOutcome {
    /// The watcher has seen enough.
    Stopped,
    /// The time was over.
    TimedOut,
    /// Something holds the robot.
    Blocked,
}

/// Drives a robot along walls for so many seconds, or until `watch`, which is called after each step with the time and the
/// controller, breaks. The robot stops in the end.
pub fn run_along_wall<R: Clock + Drive + ?Sized, C: FollowsWalls<R>>(
    robot: &mut R,
    controller: &mut C,
    seconds: f64,
    mut watch: impl FnMut(f64, &C) -> ControlFlow<()>,
) -> Result<WallOutcome> {
    /// Seconds for which wheels may be held before that counts.
    const PATIENCE: f64 = 2.0;
    let start = robot.now()?;
    let (mut last, mut free) = (start, start);
    let mut due = start;
    let outcome = loop {
        let now = robot.now()?;
        if now - start >= seconds {
            break WallOutcome::TimedOut;
        }
        if !robot.is_stalled()? {
            free = now;
        } else if now - free > PATIENCE {
            break WallOutcome::Blocked;
        }
        let twist = controller.look(robot, now - last)?;
        last = now;
        robot.set_speed(twist)?;
        due += controller.period();
        let rest = due - robot.now()?;
        if rest > 0.0 {
            robot.wait(rest)?;
        } else {
            due -= rest;
        }
        if watch(robot.now()?, controller).is_break() {
            break WallOutcome::Stopped;
        }
    };
    robot.set_speed(Twist::STOP)?;
    Ok(outcome)
}

/// What the three distance sensors and odometry say.
pub(super) fn observe<R: Drive + DistanceSensors + ?Sized>(robot: &mut R) -> Result<WallObservation> {
    Ok(WallObservation {
        pose: robot.pose()?,
        front: robot.distance(Psd::FRONT)?,
        left: robot.distance(Psd::LEFT)?,
        right: robot.distance(Psd::RIGHT)?,
    })
}

impl<R: Drive + DistanceSensors + ?Sized> FollowsWalls<R> for WallFollower {
    fn look(&mut self, robot: &mut R, _seconds: f64) -> Result<Twist> {
        let observation = observe(robot)?;
        self.step(&observation)
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
