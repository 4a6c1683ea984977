//! Craft in water: rigid bodies with six degrees of freedom (book, chapter 8).
//!
//! # The model
//!
//! A [`Craft`] moves by the equations of Fossen's handbook: rigid-body and added mass, the Coriolis and centripetal
//! forces of both, linear and quadratic damping on the speed through the water, weight, and the buoyancy of the
//! exact volume of the hull's parts that is under water. [`Thruster`]s follow their commands with a lag, push by the
//! square of their speed, weaker backwards, and lose their grip at the surface.
//!
//! [`Craft::advance`] integrates in fixed steps by the classic fourth-order method of Runge and Kutta, with the
//! attitude as a quaternion. The same numbers come out on every platform.
//!
//! # Where it does not hold
//!
//! Added mass and damping are constants, not functions of frequency or attitude; a craft that leaves the water keeps
//! its added mass, and its damping fades with what of its hull is wet. The water is not moved by the craft. A
//! current is the same all along the hull, and a wave is a plane across it.
//!
//! Reference: T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and CraftMotion Control*, second edition, 2021.

mod allocation;
mod capsule;
mod comparison;
mod craft;
mod derived;
mod hull;
mod integrate;
mod presets;
mod spec;
#[cfg(test)]
mod tests;

pub use allocation::{Allocated, Allocation};
pub use comparison::{Otter, Remus100};
pub use craft::{Craft, CraftMotion, LocalWater, Wrench};
pub use hull::{Displaced, HullPart};
pub use integrate::CraftState;
pub use spec::{CraftSpec, Thruster};

/// The acceleration of gravity, in m/s².
pub const GRAVITY: f64 = 9.81;
/// The most thrusters of a craft.
pub const MAX_THRUSTERS: usize = 8;
