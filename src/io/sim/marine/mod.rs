//! Craft in the water of a world: how it moves around them, how they move, and what stops them.
//!
//! The motion is that of [`kinematics::marine`](crate::kinematics::marine). Hulls meet the ground at points
//! of their parts: impulses stop them there, without bounce and with Coulomb friction. Walls, objects and
//! other craft stop the outline, as they do that of every robot. Wind pushes the part of a hull above the water.

mod drive;
mod swimmer;
mod waters;

pub(super) use drive::CraftDrive;
pub(super) use swimmer::Swimmer;
pub(super) use waters::Waters;
