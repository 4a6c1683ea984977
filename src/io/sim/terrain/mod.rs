//! Driving, sliding, tipping and falling of robots on hills.
//!
//! # The model
//!
//! A robot is one rigid body on *feet*: points of its wheels, castors or tracks, and the corners of its
//! outline. Each foot in contact is supported by the triangle under it and held by Coulomb friction against
//! its sliding speed, the difference between the speed of the body and that of the wheel rim or track belt.
//! The ground at a foot is stiff rather than rigid, which makes the distribution of loads unique: the body
//! sinks in by a tenth of a millimetre.
//!
//! In each tick, speeds are computed such that the body ends on the ground, not in it, and no friction
//! exceeds its limit (Moreau time stepping; projected Gauss-Seidel with warm starts). Resting attitudes,
//! loads, slip under drive, sliding and skidding, high-centring, tipping, free fall and inelastic impacts
//! follow from that. Drives turn their wheels as on level ground, so encoders and odometry drift with slip.
//!
//! # Limits of the model
//!
//! Motors are as strong as friction. There is no restitution and no suspension, and the ground is never soft.
//! The body rotates like a ball of its mean radius of gyration, without precession. Feet do not detect ground
//! edges between them. Air and water exert no forces.
//!
//! # Accuracy
//!
//! Ground normals, lever arms and rim directions are those of the middle of the tick (a midpoint rule). On
//! smooth hills, halving the tick moves the end of a 10 m drive by less than 0.2 mm for robots on three
//! wheels and for cars, if the drive accelerates as motors do. Rigid bodies on four Mecanum wheels or on
//! belts rock from three feet to three others, and slip differently each time: there the end of a drive
//! depends on the tick by millimetres to centimetres. The springs under their feet have no damping but that of
//! the time step (backward Euler), which is ample at 10 ms; at a fraction of that, feet chatter and belts slip
//! more, so shorter ticks do not converge.

mod hills;
mod mishap;
mod rigid_body;
#[cfg(test)]
mod tests;
mod undercarriage;

pub(super) use hills::Hills;
use mishap::Watch;
use rigid_body::RigidBody;
pub(super) use undercarriage::GRAVITY;
use undercarriage::Undercarriage;
