//! A real EyeBot, or any other RoBIOS system: a robot behind the traits of [`io`](crate::io) that calls a C
//! library loaded at run time.
//!
//! RoBIOS uses whole millimetres, degrees, milliseconds and percent, scans clockwise from behind, and 9999
//! for nothing in range. All of this is converted here, so a behaviour for a simulated robot drives this one
//! unchanged. [`Quantised`](crate::io::wrappers::Quantised) is a simulated robot with the same numbers.
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
//! Libraries differ in their functions. Calling a missing function is an error that names it; only a library
//! without any driving function is rejected.

#![allow(unsafe_code)]

mod call;
mod library;
mod numbers;
mod panel;
mod robot;
mod truth;

pub use robot::RobiosRobot;
pub use truth::RobiosTruth;
