//! Wrappers around robots: noise, faults, limits, quantisation, tracing and more.
//!
//! A wrapper has the capabilities of the wrapped robot, changes some and forwards the rest. So wrappers
//! stack, and work on simulated, recorded and real robots alike. The program calls the outermost one:
//! `Traced<Noisy<R>>` records the noisy readings, `Noisy<Traced<R>>` the clean ones.
//!
//! ```
//! use roverlab::io::wrappers::{Fault, Faulty, Noise, Noisy, Traced};
//! use roverlab::io::{Clock, DistanceSensors, ErrorKind, MockRobot, Psd};
//! use roverlab::random::Stream;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let robot = MockRobot::new().with_distance(Psd::FRONT, 0.5);
//! let robot = Noisy::new(robot, Noise::default(), &Stream::new(7))?;
//! let robot = Faulty::new(robot, vec!["lost:front@2".parse::<Fault>()?]);
//! let mut robot = Traced::new(robot, Vec::new());
//!
//! assert!((robot.distance(Psd::FRONT)? - 0.5).abs() < 0.1);
//! robot.wait(2.0)?;
//! assert_eq!(robot.distance(Psd::FRONT).unwrap_err().kind(), ErrorKind::Disconnected);
//!
//! let (_robot, written) = robot.finish();
//! assert_eq!(String::from_utf8(written?)?.lines().nth(1), Some("0.0 wait(2.0) -> ok"));
//! # Ok(())
//! # }
//! ```

#[macro_use]
mod signatures;

mod deadman;
mod fault;
mod faulty;
mod limited;
mod manoeuvring;
mod memory;
mod noisy;
mod quantised;
mod trace_text;
mod traced;

pub(crate) use signatures::signatures;

pub use deadman::Deadman;
pub use fault::{Fault, FaultKind, Sensor};
pub use faulty::Faulty;
pub use limited::{Excess, Limited, Limits};
pub use manoeuvring::{Manoeuvring, ManoeuvringParameters};
pub use noisy::{Noise, Noisy};
pub use quantised::Quantised;
pub use traced::{Stamp, Traced};

#[cfg(test)]
mod tests;
