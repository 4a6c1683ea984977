//! Robots in a simulated world, in virtual time.
//!
//! A [`Simulation`] provides robots for ordinary blocking programs; several robots need one thread each. A
//! [`Fleet`] steps any number of behaviours in one thread; a [`Stepped`] world leaves the loop to its caller.
//! All use the same engine, with motor lag, encoders with whole ticks, slip, collisions, and ray-cast sensors
//! with noise. The world advances in ticks of 10 ms without real waiting. The same seed gives the same run on
//! every platform and with every thread scheduling.
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
mod machine;
mod marine;
mod mechanics;
mod movable;
mod noise;
mod options;
mod pushing;
mod robot;
mod robot_traits;
mod shove;
mod simulation;
mod sliding;
#[cfg(feature = "physics")]
pub mod starman;
mod stepped;
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
pub use stepped::Stepped;
pub use truth::Truth;
pub use watch::{Onlooking, Watcher};

pub use super::{Lcd, RobotTruth, TrailPoint};

/// Duration of a tick (s).
pub const TICK: f64 = 0.010;
/// Ticks per second; the inverse, which is exact.
const TICKS_PER_SECOND: f64 = 100.0;
/// Degrees per second at which a servo turns.
const SERVO_RATE: f64 = 30.0;

/// Longest duration of a single call (s): twelve days. A longer wait is considered an error.
const LONGEST: f64 = 1e6;
