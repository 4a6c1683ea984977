//! Starman, a walking robot with a round body and five limbs (book, chapter 12; feature `physics`).
//!
//! It lives in an upright plane: gravity pulls it onto a floor with friction, and its limbs push. Its body is moved
//! by the physics engine `rapier2d`, whose results are the same on every platform; the servos, their speed and limits
//! are ours.
//!
//! ```
//! use roverlab::io::sim::starman::{Starman, StarmanSpec};
//! use roverlab::io::{Clock, Odometry, Servos};
//!
//! # fn main() -> roverlab::io::Result<()> {
//! // The book's shuffle: one of the two limbs that it stands on goes forth and back.
//! let mut starman = Starman::new(&StarmanSpec::default())?;
//! for _ in 0..5 {
//!     starman.set_servo(3, 0.9)?;
//!     starman.wait(1.0)?;
//!     starman.set_servo(3, 0.0)?;
//!     starman.wait(1.0)?;
//! }
//! assert!(starman.pose()?.x < -0.001);
//! # Ok(())
//! # }
//! ```

mod physics;
mod robot;
mod servo;
mod spec;

pub use physics::{StarmanPosture, StarmanTruth};
pub use robot::Starman;
pub use spec::StarmanSpec;

/// How many limbs it has.
pub const LIMBS: usize = 5;
