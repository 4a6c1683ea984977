//! What any robot can be asked to do, whatever it is made of.
//!
//! One capability is one small trait. An algorithm asks for what it uses, `fn run(robot: &mut (impl Clock + Drive +
//! Lidar))`, and so runs on a simulated robot, on a recording and on a real one. [`RobotIo`] is all of them at once.
//! Every trait works behind `&mut R`, `Box<R>` and `dyn`.

mod actuators;
mod camera;
mod clock;
pub mod control;
pub mod delegate;
mod display;
mod drive;
pub(crate) mod error;
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
pub use display::{Display, DisplayImage, DisplayOption, Fill, Font, FontFamily, FontStyle, Pixel, Viewport};
pub use drive::Drive;
pub use error::{Error, ErrorKind, Result};
pub use fleet::{FleetIo, FleetStep};
pub use keys::{Key, Keys};
pub use lcd::Lcd;
pub use lidar::{Lidar, LidarScan, LidarSettings};
pub use mock::{Call, MockRobot, Script};
pub use psd::{DistanceSensors, Psd};
pub use radio::{Radio, RadioMessage};
pub use truth::{GroundTruth, RobotTruth, TrailPoint};

/// A full robot: every capability at once.
pub trait RobotIo:
    Clock + Drive + DistanceSensors + Lidar + Camera + Display + Keys + Radio + Motors + Servos + Encoders
{
}

impl<R> RobotIo for R where
    R: Clock
        + Drive
        + DistanceSensors
        + Lidar
        + Camera
        + Display
        + Keys
        + Radio
        + Motors
        + Servos
        + Encoders
        + ?Sized
{
}
