use std::ops::ControlFlow;

use crate::io::Result;

/// Decides how a robot moves, step by step.
///
/// `time` is the robot's clock (s); it increases from step to step.
///
/// # For implementers
///
/// `step` decides from its arguments and its own state alone: no clock, no robot, no global state.
/// `period` is positive and constant. A step may come late.
pub trait Behaviour {
    /// Input of a step, in a reused buffer.
    type Observation: Default;
    /// Command that applies until the next step.
    type Command;
    /// Outcome of a run, including the time limit and a stop by the observer.
    type Outcome: From<Halt>;

    /// Control period (s).
    fn period(&self) -> f64;

    /// The next command, or an outcome, after which the robot stops.
    fn step(&mut self, time: f64, seen: &Self::Observation) -> Decision<Self>;

    /// The outcome of a run ended from outside.
    fn halt(&mut self, halt: Halt) -> Self::Outcome {
        halt.into()
    }
}

/// Result of a [`Behaviour`]'s step.
pub type Decision<B> = Result<ControlFlow<<B as Behaviour>::Outcome, <B as Behaviour>::Command>>;

/// A behaviour that reads its observations from robots of type `R`.
///
/// # For implementers
///
/// Bound `R` by the traits that the sensors need, and no more. Overwrite the whole observation: the
/// buffer holds the last one. Do not wait and do not move the robot.
pub trait Senses<R: ?Sized>: Behaviour {
    /// Sets up the robot before the first step, such as its camera's resolution.
    fn prepare(&mut self, _robot: &mut R) -> Result<()> {
        Ok(())
    }

    /// Reads the observation for the next step.
    fn sense(&mut self, robot: &mut R, time: f64, seen: &mut Self::Observation) -> Result<()>;
}

/// A command for robots of type `R`.
///
/// # For implementers
///
/// `apply` must return at once. `stop` must stop everything that commands of the type can move; it is
/// also called after errors.
pub trait Command<R: ?Sized> {
    /// Applies the command.
    fn apply(&self, robot: &mut R) -> Result<()>;

    /// Stops whatever commands of this type move.
    fn stop(robot: &mut R) -> Result<()>;
}

/// End of a run from outside its behaviour. Behaviours without an end of their own use it as outcome.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Halt {
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

/// Implements `From<Halt>` and `Display` for an outcome with the variants `TimedOut` and `Stopped`.
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

/// Return value of an observer after a step: nothing, whether to continue, or an error.
///
/// # For implementers
///
/// The library implements it for everything that an observer may return; other types need not.
pub trait Verdict {
    /// Whether to continue.
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

/// Verdict of an observer that stops a run once a condition holds.
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
/// assert_eq!(outcome, AToBOutcome::Stopped, "the observer stopped it after two seconds");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
pub fn until(enough: bool) -> ControlFlow<()> {
    if enough { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}
