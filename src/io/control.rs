//! The loop that runs every behaviour.
//!
//! A [`Behaviour`] decides: its [`step`](Behaviour::step) is given what was observed, and answers with a command or with
//! an outcome, without a robot. What it observes is read from a robot by [`Senses`], and its commands are given to one by
//! [`Command`]. [`run`] puts these together on a robot that can wait; [`Run`] does the same step by step, for a
//! [`Fleet`](super::sim::Fleet), a page or a program with a loop of its own.
//!
//! ```
//! use std::ops::ControlFlow;
//! use roverlab::geometry::{Pose, Twist};
//! use roverlab::io::control::{Behaviour, Decision, Halt, Senses, run};
//! use roverlab::io::{DistanceSensors, MockRobot, Psd, Result};
//!
//! /// Drives up to a wall.
//! struct Approach;
//!
//! impl Behaviour for Approach {
//!     type Observation = f64;
//!     type Command = Twist;
//!     type Outcome = Halt;
//!
//!     fn period(&self) -> f64 {
//!         0.1
//!     }
//!
//!     fn step(&mut self, _time: f64, ahead: &f64) -> Decision<Self> {
//!         Ok(ControlFlow::Continue(Twist::new((ahead - 0.2).clamp(-0.3, 0.3), 0.0)))
//!     }
//! }
//!
//! impl<R: DistanceSensors + ?Sized> Senses<R> for Approach {
//!     fn sense(&mut self, robot: &mut R, _time: f64, ahead: &mut f64) -> Result<()> {
//!         *ahead = robot.distance(Psd::FRONT)?;
//!         Ok(())
//!     }
//! }
//!
//! # fn main() -> Result<()> {
//! let mut robot = MockRobot::new().with_ideal_drive().with_distance(Psd::FRONT, vec![1.0, 0.7, 0.4]);
//! assert_eq!(run(&mut robot, &mut Approach, 2.0, |_, _, _| {})?, Halt::TimedOut);
//! # Ok(())
//! # }
//! ```

mod clock;
mod parts;

use std::ops::ControlFlow;

use super::{Clock, Result};
use crate::parameter::require_positive;
pub(crate) use clock::Stopwatch;
pub use parts::{LidarObservation, Manoeuvre, SensedBy};

/// What decides how a robot moves, step by step.
///
/// `time` is the robot's clock, in seconds; a step later shows more.
pub trait Behaviour {
    /// What a step is given, in a buffer that is used again.
    type Observation: Default;
    /// What a step tells the robot to do until the next one.
    type Command;
    /// How it may end; by the time limit and by who watches it, too.
    type Outcome: From<Halt>;

    /// Seconds from one step to the next.
    fn period(&self) -> f64;

    /// What to do now: a command, or an outcome, after which the robot stops.
    fn step(&mut self, time: f64, seen: &Self::Observation) -> Decision<Self>;

    /// Takes an end from outside.
    fn halt(&mut self, halt: Halt) -> Self::Outcome {
        halt.into()
    }
}

/// The answer of a [`Behaviour`]'s step.
pub type Decision<B> = Result<ControlFlow<<B as Behaviour>::Outcome, <B as Behaviour>::Command>>;

/// A behaviour that reads its observations from a robot of a kind.
pub trait Senses<R: ?Sized>: Behaviour {
    /// Sets up the robot before the first step, such as its camera's resolution.
    fn prepare(&mut self, _robot: &mut R) -> Result<()> {
        Ok(())
    }

    /// Reads what the next step is given.
    fn sense(&mut self, robot: &mut R, time: f64, seen: &mut Self::Observation) -> Result<()>;
}

/// What a robot of a kind can be told.
pub trait Command<R: ?Sized> {
    /// Tells it.
    fn apply(&self, robot: &mut R) -> Result<()>;

    /// Stops what commands of this kind move.
    fn stop(robot: &mut R) -> Result<()>;
}

/// An end that comes from outside of a behaviour. It is the outcome of those that have no end of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Halt {
    /// The time was over.
    TimedOut,
    /// Who watches has seen enough.
    Stopped,
}

/// Makes ends from outside outcomes of an enum with variants of their names.
macro_rules! halts {
    ($outcome:ty) => {
        impl From<crate::io::control::Halt> for $outcome {
            fn from(halt: crate::io::control::Halt) -> Self {
                match halt {
                    crate::io::control::Halt::TimedOut => Self::TimedOut,
                    crate::io::control::Halt::Stopped => Self::Stopped,
                }
            }
        }
    };
}
pub(crate) use halts;

/// What who watches a run says after a step: nothing, to go on or not, or that something is wrong.
pub trait Verdict {
    /// Whether to go on.
    fn verdict(self) -> Result<ControlFlow<()>>;
}

impl Verdict for () {
    fn verdict(self) -> Result<ControlFlow<()>> {
        Ok(ControlFlow::Continue(()))
    }
}

impl Verdict for ControlFlow<()> {
    fn verdict(self) -> Result<ControlFlow<()>> {
        Ok(self)
    }
}

impl<V: Verdict> Verdict for Result<V> {
    fn verdict(self) -> Result<ControlFlow<()>> {
        self.and_then(V::verdict)
    }
}

/// The verdict of who watches until something is so.
pub fn until(enough: bool) -> ControlFlow<()> {
    if enough { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

/// A step as who watches a run sees it.
#[derive(Debug)]
pub struct Step<'a, O> {
    /// When it began, by the robot's clock.
    pub time: f64,
    /// What it was given: at a halt, the last observation before.
    pub seen: &'a O,
}

/// Runs a behaviour on a robot for at most `time_limit` seconds, infinity for any time. `watch` is called at each step,
/// before the robot is told what was decided, and at the end; if it breaks or fails, that ends the run.
///
/// Steps are a period apart. One that is late begins the next one at once, and what was missed is not made up for. At the
/// end, however it comes, the robot is stopped; an error while it stops does not hide an earlier one.
///
/// Fails if the robot does, or if its clock stands still, runs backwards or shows no number. A clock that jumps ahead is time
/// that has passed.
pub fn run<R, B, V>(
    robot: &mut R,
    behaviour: &mut B,
    time_limit: f64,
    mut watch: impl FnMut(&mut R, &mut B, Step<'_, B::Observation>) -> V,
) -> Result<B::Outcome>
where
    R: Clock + ?Sized,
    B: Senses<R> + ?Sized,
    B::Command: Command<R>,
    V: Verdict,
{
    let mut run = Run::new(behaviour, time_limit)?;
    let ended = loop {
        let decision = match run.decide(robot, behaviour) {
            Ok(decision) => decision,
            Err(error) => break Err(error),
        };
        let step = Step { time: run.clock.map_or(0.0, |clock| clock.time()), seen: &run.seen };
        match (watch(robot, behaviour, step).verdict(), decision) {
            (Err(error), _) => break Err(error),
            (Ok(_), ControlFlow::Break(outcome)) => break Ok(outcome),
            (Ok(ControlFlow::Break(())), _) => break Ok(behaviour.halt(Halt::Stopped)),
            (Ok(ControlFlow::Continue(())), ControlFlow::Continue(command)) => {
                if let Err(error) = command.apply(robot).and_then(|()| run.rest(robot)) {
                    break Err(error);
                }
            }
        }
    };
    stopping::<_, B::Command, _>(robot, ended)
}

/// Stops a robot with what has come of its run.
pub(crate) fn stopping<R: ?Sized, C: Command<R>, T>(robot: &mut R, result: Result<T>) -> Result<T> {
    let stopped = C::stop(robot);
    result.and_then(|value| stopped.map(|()| value))
}

/// A run of a behaviour whose steps someone else paces, such as a [`Fleet`](super::sim::Fleet):
///
/// ```
/// use roverlab::drive::{RandomDrive, RandomDriveParameters};
/// use roverlab::geometry::Pose;
/// use roverlab::io::control::{Behaviour, Run};
/// use roverlab::io::sim::{Fleet, SimOptions};
/// use roverlab::random::Stream;
/// use roverlab::world::{RobotSpec, Scene, World};
///
/// # fn main() -> roverlab::io::Result<()> {
/// let scene = Scene::with_robot(World::walled(1.5, 1.5), RobotSpec::s4(), Pose::new(0.7, 0.7, 0.3));
/// let mut fleet = Fleet::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let mut drive = RandomDrive::new(RandomDriveParameters::default(), Stream::new(1))?;
/// let mut run = Run::new(&drive, 20.0)?;
/// fleet.control(0, drive.period(), move |robot| Ok(run.step(robot, &mut drive)?.map_break(|_| ())))?;
/// fleet.run_for(60.0)?;
/// assert!((fleet.time() - 20.0).abs() < 0.1, "the run was over, and the fleet's with it");
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Run<B: Behaviour + ?Sized> {
    seen: B::Observation,
    period: f64,
    limit: f64,
    /// From the first step on.
    clock: Option<Stopwatch>,
    due: f64,
}

impl<B: Behaviour + ?Sized> Run<B> {
    /// A run that begins at its first step and takes at most `time_limit` seconds. Fails unless both that and the
    /// behaviour's period make sense.
    pub fn new(behaviour: &B, time_limit: f64) -> Result<Self> {
        let period = behaviour.period();
        require_positive("control period", period)?;
        Stopwatch::check_limit(time_limit)?;
        Ok(Self { seen: B::Observation::default(), period, limit: time_limit, clock: None, due: 0.0 })
    }

    /// Makes one step: reads, decides, and tells the robot. The robot is stopped at the end and at an error.
    pub fn step<R>(&mut self, robot: &mut R, behaviour: &mut B) -> Result<ControlFlow<B::Outcome>>
    where
        R: Clock + ?Sized,
        B: Senses<R>,
        B::Command: Command<R>,
    {
        let applied = self.decide(robot, behaviour).and_then(|decision| match decision {
            ControlFlow::Continue(command) => command.apply(robot).map(ControlFlow::Continue),
            ControlFlow::Break(outcome) => Ok(ControlFlow::Break(outcome)),
        });
        match applied {
            Ok(ControlFlow::Continue(())) => applied,
            ended => stopping::<_, B::Command, _>(robot, ended),
        }
    }

    /// Reads and decides, unless the time is over.
    fn decide<R>(&mut self, robot: &mut R, behaviour: &mut B) -> Decision<B>
    where
        R: Clock + ?Sized,
        B: Senses<R>,
    {
        let clock = match &mut self.clock {
            Some(clock) => clock,
            clock => {
                behaviour.prepare(robot)?;
                let begun = clock.insert(Stopwatch::start(robot, self.limit)?);
                self.due = begun.time();
                begun
            }
        };
        let time = clock.step(robot)?;
        if clock.is_over() {
            return Ok(ControlFlow::Break(behaviour.halt(Halt::TimedOut)));
        }
        behaviour.sense(robot, time, &mut self.seen)?;
        behaviour.step(time, &self.seen)
    }

    /// Waits until the next step is due or the time is over.
    fn rest<R: Clock + ?Sized>(&mut self, robot: &mut R) -> Result<()> {
        if let Some(clock) = &mut self.clock {
            self.due = clock.wait_until(robot, self.due + self.period)?;
        }
        Ok(())
    }
}
