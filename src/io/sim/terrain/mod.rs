//! Driving, sliding, tipping and falling of robots on hills.
//!
//! # The model
//!
//! A robot is one rigid body on *feet*: points of its wheels, castors or tracks, and the corners of its
//! outline. Each foot in contact is supported by the triangle under it and held by Coulomb friction against
//! its sliding speed, the difference between the speed of the body and that of the wheel rim or track belt.
//! The ground at a foot is a stiff spring with critical damping rather than rigid, which makes the
//! distribution of loads unique and keeps feet from chattering: the body sinks in by a tenth of a millimetre.
//! Mecanum wheels are on softer springs, as all four of them have to carry load, and belts yield like rubber, by
//! a millimetre, so that the load goes from point to point more slowly than a tick.
//!
//! In each tick, speeds are computed such that the body ends on the ground, not in it, and no friction
//! exceeds its limit or acts aside from the slide (Moreau time stepping, solved by Newton's method). Resting
//! attitudes, loads, slip under drive, sliding and skidding, high-centring, tipping, free fall and inelastic
//! impacts follow from that. Drives turn their wheels as on level ground, so encoders and odometry drift with
//! slip.
//!
//! # Limits of the model
//!
//! Motors are as strong as friction. There is no restitution, only Mecanum wheels have a suspension, and the
//! ground is never soft. The body rotates like a ball of its mean radius of gyration, without precession. Feet
//! do not detect the ground between them: a post or a wall as thin as the gap between two belts passes
//! through the body. Air and water exert no forces. A belt touches the ground at eight
//! points. How its load is shared among them decides how a tracked robot turns: beside belts of road wheels on
//! springs, curves of 1.9 m end 0.6 to 6.4 mm apart, and beside rigid belts, which a crest carries at one
//! line, 17 mm to 1.8 m apart (`benches/judge`).
//!
//! # Accuracy
//!
//! Ground normals, lever arms and rim directions are those of the middle of the tick (a midpoint rule). On
//! smooth hills, halving the tick moves the end of a 10 m drive by at most 1 mm and 0.1 degrees, if the drive
//! accelerates as motors do.

mod contact;
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
