//! A real EyeBot, or anything else that speaks RoBIOS: a robot behind the traits of [`io`](crate::io) that calls a
//! C library, loaded at run time.
//!
//! RoBIOS knows whole millimetres, degrees, milliseconds and percent, scans clockwise from behind, and 9999 for nothing
//! within range. All of that is converted here, so a behaviour that drives a simulated robot drives this one as it is.
//! [`Quantised`](crate::io::wrappers::Quantised) is a simulated robot with the same numbers.
//!
//! ```no_run
//! use roverlab::io::robios::RobiosRobot;
//! use roverlab::io::{DistanceSensors, Manoeuvres, Psd};
//!
//! # fn main() -> roverlab::io::Result<()> {
//! let mut robot = RobiosRobot::open("libeyebot.so")?;
//! let ahead = robot.distance(Psd::FRONT)?;
//! robot.straight(ahead - 0.1, 0.2)?;
//! robot.wait_done()?;
//! # Ok(())
//! # }
//! ```
//!
//! Libraries differ in what they have. A function that is missing is an error that names it, when it is called; only
//! a library that has none of those that drive is refused.

#![allow(unsafe_code)]

mod library;
mod numbers;
mod robot;
mod truth;

pub use robot::RobiosRobot;
pub use truth::RobiosTruth;
