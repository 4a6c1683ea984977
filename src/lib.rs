//! Every system of a robotics textbook as a library.

pub mod geometry;
pub mod io;
pub mod kinematics;
pub mod nav;
#[cfg(feature = "picture")]
pub mod picture;
pub mod random;
pub mod world;
