//! Capabilities of any robot, simulated or real.
//!
//! Each capability is one small trait. An algorithm requires only what it uses, `fn run(robot: &mut (impl
//! Clock + Drive + Lidar))`, and so runs on simulated, recorded and real robots. [`RobotIo`] combines all
//! traits. Every trait works behind `&mut R`, `Box<R>` and `dyn`.
//!
//! # Your own robot
//!
//! Implement the traits of the devices that the robot has, and no others. [`Clock`] and [`Drive`] suffice for
//! a behaviour without sensing; [`Odometry`] and the traits of the sensors enable the others. A behaviour
//! that needs more than the robot has does not compile. [`wrappers::Manoeuvring`] adds [`Manoeuvres`] and a
//! [`StallDetector`]. No method makes up a value: where a program requires a full [`RobotIo`], missing
//! devices return [`Error::unsupported`].

mod actuators;
mod camera;
mod clock;
pub mod control;
pub mod delegate;
mod depth;
mod display;
mod drive;
pub(crate) mod error;
mod inertial;
mod keys;
mod lcd;
mod lidar;
mod mock;
mod psd;
mod radio;
#[macro_use]
pub mod wrappers;
mod fleet;
#[cfg(feature = "log")]
pub mod log;
#[cfg(feature = "robios")]
pub mod robios;
pub mod sim;
mod truth;

pub use actuators::{Encoders, Motors, Servos};
pub use camera::{Camera, Resolution};
pub use clock::Clock;
pub use depth::DepthSensor;
pub use display::{Display, DisplayImage, DisplayOption, Fill, Font, FontFamily, FontStyle, Pixel, Viewport};
pub use drive::{Drive, Manoeuvres, Odometry, StallDetector};
pub use error::{Error, ErrorKind, Result};
pub use fleet::{FleetIo, FleetStep};
pub use inertial::{Attitude, Inertial};
pub use keys::{Key, Keys};
pub use lcd::Lcd;
pub use lidar::{Lidar, LidarScan, LidarSettings};
pub use mock::{Call, MockRobot, Script};
pub use psd::{DistanceSensors, Psd};
pub use radio::{Radio, RadioMessage};
pub use truth::{GroundTruth, Mishap, RobotTruth, TrailPoint, TruthInSpace};

/// A full robot with every capability.
pub trait RobotIo:
    Clock
    + Drive
    + Odometry
    + Manoeuvres
    + StallDetector
    + DistanceSensors
    + Lidar
    + Camera
    + Display
    + Keys
    + Radio
    + Motors
    + Servos
    + Encoders
    + Inertial
    + DepthSensor
{
}

impl<R> RobotIo for R where
    R: Clock
        + Drive
        + Odometry
        + Manoeuvres
        + StallDetector
        + DistanceSensors
        + Lidar
        + Camera
        + Display
        + Keys
        + Radio
        + Motors
        + Servos
        + Encoders
        + Inertial
        + DepthSensor
        + ?Sized
{
}
