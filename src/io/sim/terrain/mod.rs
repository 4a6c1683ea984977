//! How robots drive, slide, tip and fall on hills.
//!
//! # The model
//!
//! A robot is one rigid body on *feet*: points of its wheels, castors or tracks, and the corners of its outline. Each
//! foot that meets the ground is carried by the triangle under it and held by Coulomb friction, which works against
//! the speed at which the foot slides: that of the body less that of the wheel's rim or of the track's belt. A foot's
//! ground is stiff, not rigid, so that loads have one distribution: the body sinks in by a tenth of a millimetre.
//!
//! In each tick the speeds are found with which the body ends on the ground, not in it, and no friction is beyond its
//! limit (time stepping after Moreau; projected Gauss-Seidel with warm starts). From these alone follow resting
//! attitudes, loads, slip under a drive, sliding and skidding, high-centring, tipping over, free fall and impacts
//! without bounce. Drives turn their wheels as on level ground, so encoders and odometry drift as they slip.
//!
//! # Where it does not hold
//!
//! Motors are as strong as the friction. Nothing bounces, no suspension gives way, and the ground is never soft. The
//! body turns as a ball of its mean radius of gyration, without precession. Feet do not know of edges of the ground
//! between them. Air and water do not carry it.
//!
//! # Accuracy
//!
//! Ground normals, lever arms and rim directions are those of the middle of the tick (a midpoint rule). On smooth hills,
//! halving the tick moves the end of a 10 m drive by less than 0.2 mm for robots on three wheels and for cars, if the
//! drive accelerates as motors do. Rigid bodies on four Mecanum wheels or on belts rock from three feet to three others,
//! and slip differently each time: there the end of a drive depends on the tick by millimetres to centimetres.

mod hills;
mod mishap;
mod rigid_body;
#[cfg(test)]
mod tests;
mod undercarriage;

pub use mishap::Mishap;

pub(super) use hills::Hills;
use mishap::Watch;
use rigid_body::RigidBody;
pub(super) use undercarriage::GRAVITY;
use undercarriage::Undercarriage;
