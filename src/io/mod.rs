//! What any robot can be asked to do, whatever it is made of.
//!
//! One capability is one small trait. An algorithm asks for what it uses, `fn run(robot: &mut (impl Clock + Drive +
//! Lidar))`, and so runs on a simulated robot, on a recording and on a real one. [`RobotIo`] is all of them at once.
//! Every trait works behind `&mut R`, `Box<R>` and `dyn`.
//!
//! # Robots of one's own
//!
//! A robot implements what it has, and nothing else. [`Clock`] and [`Drive`] are enough for a behaviour that looks at
//! nothing; [`Odometry`], if the robot measures how it moves, and the traits of its sensors open the others. A
//! behaviour that needs more than the robot has does not compile. [`Manoeuvres`] and a [`StallDetector`], if it has
//! none of its own, come with [`wrappers::Manoeuvring`]. No method makes up a value: where a program wants a full
//! [`RobotIo`], what is missing answers [`Error::unsupported`].

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
pub use truth::{GroundTruth, RobotTruth, TrailPoint};

/// A full robot: every capability at once.
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
