use std::ops::ControlFlow;

use crate::io::Result;

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
    ($outcome:ident { $($variant:ident: $sentence:literal),* $(,)? }) => {
        impl From<crate::io::control::Halt> for $outcome {
            fn from(halt: crate::io::control::Halt) -> Self {
                match halt {
                    crate::io::control::Halt::TimedOut => Self::TimedOut,
                    crate::io::control::Halt::Stopped => Self::Stopped,
                }
            }
        }

        impl std::fmt::Display for $outcome {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(match self {
                    $(Self::$variant => $sentence,)*
                    Self::TimedOut => "the time is over",
                    Self::Stopped => "the run was stopped by its observer",
                })
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
///
/// ```
/// use roverlab::drive::{AToB, AToBOutcome, AToBParameters, Goal, Method};
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::io::control::{run, until};
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::world::{RobotSpec, Scene, World};
/// let scene = Scene::with_robot(World::empty(3.0, 3.0), RobotSpec::s4(), Pose::default());
/// let simulation = Simulation::new(&scene, SimOptions::ideal())?;
/// let mut drive = AToB::new(Method::Arc, Goal::point(Point::new(2.0, 1.0)), AToBParameters::default())?;
/// let outcome = run(&mut simulation.robot(0)?, &mut drive, 60.0, |_, _, step| until(step.time > 2.0))?;
/// assert_eq!(outcome, AToBOutcome::Stopped, "who watches had seen enough after two seconds");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
pub fn until(enough: bool) -> ControlFlow<()> {
    if enough { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}
