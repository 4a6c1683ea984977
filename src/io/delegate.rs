//! Macros for wrappers: robots that change one capability and forward the rest.
//!
//! Each macro forwards one capability to a field through the `ambassador` crate's derive macro. The wrapper
//! then has this capability if the robot inside has it. A glob import brings the types that the macros need:
//!
//! ```
//! use ambassador::Delegate;
//! use roverlab::io::delegate::*;
//! use roverlab::io::{Clock, Drive, Keys, MockRobot, Odometry};
//!
//! /// A robot whose clock runs twice as fast.
//! #[derive(Delegate)]
//! #[delegate(Drive, target = "inner")]
//! #[delegate(Odometry, target = "inner")]
//! #[delegate(Keys, target = "inner")]
//! struct Hasty<R> {
//!     inner: R,
//! }
//!
//! impl<R: Clock> Clock for Hasty<R> {
//!     fn now(&mut self) -> Result<f64> {
//!         Ok(2.0 * self.inner.now()?)
//!     }
//!
//!     fn wait(&mut self, seconds: f64) -> Result<()> {
//!         self.inner.wait(0.5 * seconds)
//!     }
//! }
//!
//! # fn main() -> Result<()> {
//! let mut robot = Hasty { inner: MockRobot::new().with_ideal_drive() };
//! robot.set_speed(Twist::new(0.1, 0.0))?;
//! robot.wait(2.0)?;
//! assert_eq!((robot.now()?, robot.pose()?.x), (2.0, 0.1));
//! # Ok(())
//! # }
//! ```

// A macro names the types of its methods as the trait does, so they must be in scope at its use.
pub use super::{
    Attitude, DisplayImage, DisplayOption, Fill, Font, Key, LidarScan, LidarSettings, Pixel, Psd,
    RadioMessage, Resolution, Result, Viewport,
};
pub use crate::geometry::{Pose, Twist, Vector3};
pub use crate::world::Colour;
pub use image::{GrayImage, RgbImage};

pub use super::actuators::{ambassador_impl_Encoders, ambassador_impl_Motors, ambassador_impl_Servos};
pub use super::camera::ambassador_impl_Camera;
pub use super::clock::ambassador_impl_Clock;
pub use super::depth::ambassador_impl_DepthSensor;
pub use super::display::ambassador_impl_Display;
pub use super::drive::{
    ambassador_impl_Drive, ambassador_impl_Manoeuvres, ambassador_impl_Odometry,
    ambassador_impl_StallDetector,
};
pub use super::inertial::ambassador_impl_Inertial;
pub use super::keys::ambassador_impl_Keys;
pub use super::lidar::ambassador_impl_Lidar;
pub use super::psd::ambassador_impl_DistanceSensors;
pub use super::radio::ambassador_impl_Radio;
