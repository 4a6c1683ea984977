//! Craft in water: rigid bodies with six degrees of freedom (book, chapter 8).
//!
//! # The model
//!
//! A [`Craft`] moves by the equations of Fossen's handbook: rigid-body and added mass, the Coriolis and
//! centripetal forces of both, linear and quadratic damping on the speed through the water, weight, and the
//! buoyancy of the exact submerged volume of the hull's parts. [`Thruster`]s follow their commands with a lag;
//! their thrust grows with the square of their speed, is weaker backwards, and fades near the surface.
//!
//! [`Craft::advance`] integrates in fixed steps by the classic fourth-order method of Runge and Kutta, with
//! the attitude as a quaternion. Results are equal to the last bit on every platform.
//!
//! # Limits of the model
//!
//! Added mass and damping are constants, not functions of frequency or attitude. A craft that leaves the water
//! keeps its added mass; its damping decreases with the wetted part of its hull. The craft does not move the
//! water. A current is uniform along the hull, and a wave is a plane across it; the simulator averages each wave
//! over the hull's length and width.
//!
//! Reference: T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, second edition,
//! 2021.
//!
//! ```
//! use roverlab::geometry::{Point3, Pose3, Vector3};
//! use roverlab::kinematics::marine::{
//!     Craft, CraftMotion, CraftSpec, CraftState, HullPart, LocalWater, Otter, Remus100, Thruster, Wrench,
//! };
//! // A raft of 8 kg with a motor of 5 N at its stern.
//! let deck = HullPart::Box { size: Vector3::new(0.6, 0.4, 0.1), centre: Point3::origin() };
//! let mut spec = CraftSpec::of_hull(8.0, Point3::origin(), vec![deck]);
//! spec.thrusters.push(Thruster::new("stern", Point3::new(-0.3, 0.0, -0.05), Vector3::x(), 5.0));
//! let (raft, water) = (Craft::new(&spec, 0.01)?, LocalWater::still(0.0));
//! let mut state = CraftState::at_rest(&raft, &Pose3::default());
//! for _ in 0..1000 {
//!     raft.advance(&mut state, &[1.0], &water);
//! }
//! assert!(state.position.x > 1.0 && state.position.z.abs() < 0.1, "it drives ahead and floats");
//! // A force at a point has a moment about the centre.
//! let push = Wrench::at(Vector3::new(0.0, 1.0, 0.0), Vector3::new(2.0, 0.0, 0.0));
//! assert_eq!(push.moment, Vector3::new(0.0, 0.0, -2.0));
//! // Two vehicles from the literature, for comparison.
//! let (torpedo, boat) = (Remus100::new(0.02)?, Otter::new(0.02)?);
//! assert!(torpedo.craft.mass() < boat.craft.mass());
//! let ahead = CraftMotion { linear: Vector3::new(1.5, 0.0, 0.0), ..CraftMotion::STILL };
//! assert!(torpedo.forces(&ahead, 1.5, [0.2, 0.0, 0.0]).moment.z != 0.0, "its rudder turns it");
//! # Ok::<(), roverlab::ParameterError>(())
//! ```

mod allocation;
mod capsule;
mod comparison;
mod craft;
mod derived;
mod displaced;
mod hull;
mod integrate;
mod presets;
mod spec;
#[cfg(test)]
mod tests;

pub use allocation::{Allocated, Allocation};
pub use comparison::{Otter, Remus100};
pub use craft::{Craft, CraftMotion, CraftState, LocalWater, Wrench};
pub use displaced::Displaced;
pub use hull::HullPart;
pub use spec::{CraftSpec, Thruster};

/// Gravitational acceleration (m/s²).
pub const GRAVITY: f64 = 9.81;
/// Maximum number of thrusters of a craft.
pub const MAX_THRUSTERS: usize = 8;
