//! The loop that runs every behaviour.
//!
//! A [`Behaviour`] decides without a robot: its [`step`](Behaviour::step) takes an observation and returns a
//! command or an outcome. [`Senses`] reads observations from a robot, [`Command`] applies commands to one.
//! [`run`] loops these on a robot that can wait; [`Run`] does single steps, for a
//! [`Fleet`](super::sim::Fleet), a web page or a program with its own loop.
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
//! assert_eq!(run(&mut robot, &mut Approach, 0.3, |_, _, _| {})?, Halt::TimedOut);
//! # Ok(())
//! # }
//! ```

mod behaviour;
mod clock;
mod parts;
mod run;

pub(crate) use behaviour::halts;
pub use behaviour::{Behaviour, Command, Decision, Halt, Senses, Verdict, until};
pub(crate) use clock::Stopwatch;
pub use parts::{LidarObservation, Manoeuvre, SensedBy};
pub(crate) use run::stopping;
pub use run::{Run, Step, run};
