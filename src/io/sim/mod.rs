//! Robots in a simulated world, in virtual time.
//!
//! A [`Simulation`] hands out robots that ordinary blocking programs drive, one thread each when there are several.
//! A [`Fleet`] steps any number of behaviours in one thread. Both run the same engine: wheels with motor lag,
//! encoders with whole ticks, slip, collisions, ray-cast sensors with noise. The world advances in ticks of 10 ms;
//! nothing sleeps, and the same seed gives the same run on every platform and under every scheduling.
//!
//! ```
//! use roverlab::geometry::Pose;
//! use roverlab::io::{DistanceSensors, Manoeuvres, Psd};
//! use roverlab::io::sim::{SimOptions, Simulation};
//! use roverlab::world::{RobotSpec, Scene, World};
//!
//! # fn main() -> Result<(), roverlab::io::Error> {
//! let scene = Scene::with_robot(World::walled(2.0, 1.0), RobotSpec::s4(), Pose::new(0.5, 0.5, 0.0));
//! let simulation = Simulation::new(&scene, SimOptions::ideal())?;
//! let mut robot = simulation.robot(0)?;
//! robot.straight(1.0, 0.3)?;
//! robot.wait_done()?;
//! assert!((robot.distance(Psd::FRONT)? - 0.435).abs() < 0.005);
//! assert_eq!(simulation.truth().robot(0)?.contacts, 0);
//! # Ok(())
//! # }
//! ```

mod autopilot;
mod bicycle;
mod body;
mod camera;
mod car;
mod collision;
mod course;
mod depth_gauge;
mod drive_errors;
mod drive_mechanics;
mod drivetrain;
mod engine;
mod fleet;
mod inertial_unit;
mod lockstep;
mod marine;
mod mechanics;
mod movable;
mod noise;
mod omni;
mod options;
mod pushing;
mod robot;
mod robot_traits;
mod simulation;
mod sliding;
#[cfg(feature = "physics")]
pub mod starman;
mod terrain;
mod truth;
mod watch;
mod wheels;

pub use super::Mishap;
pub use fleet::{Fleet, FleetRobot};
pub use noise::NoiseModel;
pub use options::SimOptions;
pub use robot::SimRobot;
pub use simulation::Simulation;
pub use truth::Truth;
pub use watch::{Onlooking, Watcher};

pub use super::{Lcd, RobotTruth, TrailPoint};

/// Seconds in which the world advances at a time.
pub const TICK: f64 = 0.010;
/// How many of them make a second; the inverse, which is exact.
const TICKS_PER_SECOND: f64 = 100.0;
/// Degrees per second at which a servo turns.
const SERVO_RATE: f64 = 30.0;

/// The longest time, in seconds, that one call may let pass: twelve days. Beyond it a program waits by mistake.
const LONGEST: f64 = 1e6;
