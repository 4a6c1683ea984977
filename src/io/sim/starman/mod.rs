//! Starman, a walking robot with a round body and five limbs (book, chapter 12; feature `physics`).
//!
//! It moves in a vertical plane, on a floor with friction and under gravity. The physics engine `rapier2d`,
//! whose results are the same on every platform, moves its body; the servos with their speed and limits are
//! our own. A [`BodyPlan`] describes other bodies that walk.
//!
//! ```
//! use roverlab::io::sim::starman::{Starman, StarmanSpec};
//! use roverlab::io::{Clock, Odometry, Servos};
//!
//! # fn main() -> roverlab::io::Result<()> {
//! // The book's shuffle: one of the two supporting limbs swings forth and back.
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
mod plan;
mod robot;
mod servo;
mod spec;

pub use physics::{StarmanPosture, StarmanTruth};
pub use plan::{BodyPlan, LimbPlan};
pub use robot::Starman;
pub use spec::StarmanSpec;

/// Number of limbs of the star.
pub const LIMBS: usize = 5;
