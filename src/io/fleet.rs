use std::ops::ControlFlow;

use super::{Error, ErrorKind, Result, RobotIo, RobotTruth};
use crate::geometry::Pose;

/// Step function of a [`FleetIo`]'s robot, called until it breaks. A [`Run`](crate::io::control::Run) turns a
/// behaviour into one.
pub type FleetStep<'a> = Box<dyn FnMut(&mut dyn RobotIo) -> Result<ControlFlow<()>> + 'a>;

/// Robots with behaviours stepped in one thread: a simulator's [`Fleet`](crate::io::sim::Fleet), a recorded
/// one, or the recording of one.
///
/// ```
/// use std::ops::ControlFlow;
/// use roverlab::geometry::{Pose, Twist};
/// use roverlab::io::sim::{Fleet, SimOptions};
/// use roverlab::io::{Drive, Psd, Result, FleetIo};
/// use roverlab::world::{RobotSpec, Scene, World};
///
/// fn approach<'a>(fleet: &mut dyn FleetIo<'a>) -> Result<Pose> {
///     fleet.control(0, 0.1, Box::new(|robot| {
///         let free = robot.distance(Psd::FRONT)?;
///         robot.set_speed(Twist::new(0.5 * (free - 0.2), 0.0))?;
///         Ok(ControlFlow::Continue(()))
///     }))?;
///     fleet.run_for(5.0)?;
///     fleet.pose(0)
/// }
///
/// # fn main() -> Result<()> {
/// let scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(1.0, 1.0, 0.0));
/// let pose = approach(&mut Fleet::new(&scene, SimOptions::default())?)?;
/// assert!(pose.x > 1.6, "it has driven to the wall: {pose:?}");
/// # Ok(())
/// # }
/// ```
///
/// # For implementers
///
/// Step each behaviour when it is due by simulated time, in an order that is the same in equal runs.
pub trait FleetIo<'a> {
    /// Number of robots.
    fn robots(&self) -> usize;

    /// Assigns a behaviour to a robot, called every `period` seconds until it breaks.
    fn control(&mut self, robot: usize, period: f64, behaviour: FleetStep<'a>) -> Result<()>;

    /// Steps each behaviour when it is due, for `seconds` or until all behaviours have ended. The first error
    /// of a behaviour ends the run.
    fn run_for(&mut self, seconds: f64) -> Result<()>;

    /// Time since the start (s).
    fn time(&mut self) -> Result<f64>;

    /// True pose of a robot in the world.
    fn pose(&mut self, robot: usize) -> Result<Pose>;

    /// Ground truth of a robot.
    fn truth(&mut self, robot: usize) -> Result<RobotTruth>;
}

impl<'a, T: FleetIo<'a> + ?Sized> FleetIo<'a> for Box<T> {
    fn robots(&self) -> usize {
        (**self).robots()
    }

    fn control(&mut self, robot: usize, period: f64, behaviour: FleetStep<'a>) -> Result<()> {
        (**self).control(robot, period, behaviour)
    }

    fn run_for(&mut self, seconds: f64) -> Result<()> {
        (**self).run_for(seconds)
    }

    fn time(&mut self) -> Result<f64> {
        (**self).time()
    }

    fn pose(&mut self, robot: usize) -> Result<Pose> {
        (**self).pose(robot)
    }

    fn truth(&mut self, robot: usize) -> Result<RobotTruth> {
        (**self).truth(robot)
    }
}

pub(crate) fn no_robot(robot: usize, robots: usize) -> Error {
    Error::new(ErrorKind::InvalidInput, format!("found no robot {robot}; expected an index below {robots}"))
}
