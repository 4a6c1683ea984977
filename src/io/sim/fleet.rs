use std::fmt;
use std::ops::ControlFlow;

use super::body::Body;
use super::engine::Engine;
use super::lockstep::{check_duration, no_robot, time_is_over};
use super::options::ticks_in;
use super::truth::robot_truth;
use super::{SimOptions, Watcher};
use crate::geometry::Pose;
use crate::io::fleet;
use crate::io::{Error, ErrorKind, FleetIo, Key, Result, RobotTruth};
use crate::parameter::require_positive;
use crate::world::Scene;

/// Robots whose behaviours are stepped in one thread.
///
/// ```
/// use std::ops::ControlFlow;
/// use roverlab::geometry::{Pose, Twist};
/// use roverlab::io::sim::{Fleet, SimOptions};
/// use roverlab::io::{DistanceSensors, Drive, Psd};
/// use roverlab::world::{RobotSpec, Scene, World};
///
/// # fn main() -> Result<(), roverlab::io::Error> {
/// let scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(1.0, 1.0, 0.0));
/// let mut fleet = Fleet::new(&scene, SimOptions::ideal())?;
/// fleet.control(0, 0.1, |robot| {
///     let free = robot.distance(Psd::FRONT)?;
///     robot.set_speed(Twist::new(0.5 * (free - 0.2), 0.0))?;
///     Ok(ControlFlow::Continue(()))
/// })?;
/// fleet.run_for(20.0)?;
/// let truth = fleet.truth(0)?;
/// assert!((truth.pose.x - 1.735).abs() < 0.02 && truth.contacts == 0);
/// # Ok(())
/// # }
/// ```
pub struct Fleet<'a> {
    engine: Engine,
    members: Vec<Option<Member<'a>>>,
}

type Behaviour<'a> = dyn FnMut(&mut FleetRobot<'_>) -> Result<ControlFlow<()>> + 'a;

/// A robot's behaviour and its schedule.
struct Member<'a> {
    behaviour: Box<Behaviour<'a>>,
    period: u64,
    due: u64,
}

/// A robot of a [`Fleet`], as its behaviour sees it, or of a [`Stepped`](super::Stepped) world: a full robot
/// that cannot wait, because the fleet schedules the calls.
#[derive(Debug)]
pub struct FleetRobot<'e> {
    engine: &'e mut Engine,
    index: usize,
}

impl fmt::Debug for Fleet<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let controlled = self.members.iter().flatten().count();
        f.debug_struct("Fleet")
            .field("robots", &self.members.len())
            .field("controlled", &controlled)
            .field("time", &self.time())
            .finish_non_exhaustive()
    }
}

impl<'a> Fleet<'a> {
    /// A fleet of all robots of a scene. Fails as [`Simulation::new`](super::Simulation::new) does.
    pub fn new(scene: &Scene, options: SimOptions) -> Result<Self> {
        let engine = Engine::new(scene, options)?;
        let members = engine.bodies.iter().map(|_| None).collect();
        Ok(Self { engine, members })
    }

    /// Adds a watcher from now on.
    pub fn watch(&mut self, watcher: Box<dyn Watcher>) {
        self.engine.watch(watcher);
    }

    /// Number of robots.
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// Whether there is no robot.
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// Assigns a behaviour to a robot. It is called every `period` seconds, rounded to whole ticks, until it
    /// breaks.
    pub fn control(
        &mut self,
        robot: usize,
        period: f64,
        behaviour: impl FnMut(&mut FleetRobot<'_>) -> Result<ControlFlow<()>> + 'a,
    ) -> Result<()> {
        require_positive("control period", period)?;
        let robots = self.members.len();
        let due = self.engine.tick;
        let member = self.members.get_mut(robot).ok_or_else(|| no_robot(robot, robots))?;
        let period = ticks_in(period).max(1);
        *member = Some(Member { behaviour: Box::new(behaviour), period, due });
        Ok(())
    }

    /// Runs the world and the due behaviours for `seconds` or until all behaviours have ended. The first
    /// error of a behaviour ends the run and leaves the robots unchanged.
    pub fn run_for(&mut self, seconds: f64) -> Result<()> {
        check_duration("duration", seconds)?;
        let end = self.engine.tick + ticks_in(seconds.max(0.0));
        while self.engine.tick < end {
            self.step_behaviours()?;
            if self.members.iter().all(Option::is_none) {
                return Ok(());
            }
            let due = self.members.iter().flatten().map(|member| member.due).min();
            self.engine.run(due.unwrap_or(end).min(end) - self.engine.tick);
        }
        Ok(())
    }

    fn step_behaviours(&mut self) -> Result<()> {
        let tick = self.engine.tick;
        for (index, slot) in self.members.iter_mut().enumerate() {
            let Some(member) = slot else { continue };
            if member.due > tick {
                continue;
            }
            member.due = tick.saturating_add(member.period);
            let mut robot = FleetRobot::new(&mut self.engine, index);
            if (member.behaviour)(&mut robot)?.is_break() {
                *slot = None;
            }
        }
        Ok(())
    }

    /// Schedules a key press on a robot, in seconds since the start; a past time means at once.
    pub fn press_key(&mut self, robot: usize, time: f64, key: Key) -> Result<()> {
        self.engine.press_key(robot, time, key)
    }

    /// Time since the start (s).
    pub fn time(&self) -> f64 {
        self.engine.time()
    }

    /// A robot's true pose in the world.
    pub fn pose(&self, robot: usize) -> Option<Pose> {
        self.engine.bodies.get(robot).map(Body::pose)
    }

    /// Complete ground truth of a robot.
    pub fn truth(&self, robot: usize) -> Result<RobotTruth> {
        robot_truth(&self.engine, robot)
    }
}

impl<'e> FleetRobot<'e> {
    pub(super) fn new(engine: &'e mut Engine, index: usize) -> Self {
        Self { engine, index }
    }

    pub(super) fn call<T>(&mut self, ask: impl FnOnce(&mut Engine, usize) -> Result<T>) -> Result<T> {
        if self.engine.options.time_limit.is_some_and(|limit| self.engine.time() >= limit) {
            return Err(time_is_over());
        }
        ask(self.engine, self.index)
    }

    pub(super) fn own_time(&self) -> f64 {
        self.engine.time()
    }

    pub(super) fn time(&mut self) -> Result<f64> {
        self.call(|engine, _| Ok(engine.time()))
    }

    #[allow(clippy::unused_self, reason = "The blocking robot's counterpart needs it")]
    pub(super) fn pause(&mut self, _seconds: f64) -> Result<()> {
        Err(cannot_wait())
    }

    pub(super) fn poll<T>(
        &mut self,
        mut ask: impl FnMut(&mut Engine, usize) -> Result<Option<T>>,
    ) -> Result<T> {
        self.call(&mut ask)?.ok_or_else(cannot_wait)
    }
}

fn cannot_wait() -> Error {
    Error::new(
        ErrorKind::Unsupported,
        "a behaviour in a fleet cannot wait; it is called again when it is due",
    )
}

impl<'a> FleetIo<'a> for Fleet<'a> {
    fn robots(&self) -> usize {
        self.len()
    }

    fn control(&mut self, robot: usize, period: f64, mut behaviour: fleet::FleetStep<'a>) -> Result<()> {
        Fleet::control(self, robot, period, move |robot| behaviour(robot))
    }

    fn run_for(&mut self, seconds: f64) -> Result<()> {
        Fleet::run_for(self, seconds)
    }

    fn time(&mut self) -> Result<f64> {
        Ok(Fleet::time(self))
    }

    fn pose(&mut self, robot: usize) -> Result<Pose> {
        Fleet::pose(self, robot).ok_or_else(|| fleet::no_robot(robot, self.len()))
    }

    fn truth(&mut self, robot: usize) -> Result<RobotTruth> {
        Fleet::truth(self, robot)
    }
}
