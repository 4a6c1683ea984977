//! Geometry of a world, indexed for the frequent queries of a simulator.
//!
//! A [`Space`] contains upright static walls and upright moving [`Solid`]s: objects and robots. It computes
//! ray hits, scans of a laser [`Scanner`], contacts of an outline, and distances. It does not model time,
//! sensor noise or forces.
//!
//! ```
//! use roverlab::geometry::{Point, Pose, Vector};
//! use roverlab::world::{Footprint, World, space::{Solid, Space}};
//!
//! let mut space = Space::new(&World::walled(4.0, 2.0).walls);
//! let can = Solid::new(Footprint::Disc { radius: 0.1 }, Pose::new(3.0, 1.0, 0.0), 0.0, 0.2);
//! let can = space.add(can);
//! let range = |space: &Space| space.cast_ray(Point::new(1.0, 1.0), Vector::x(), 0.05, 10.0, None);
//! assert!((range(&space) - 1.9).abs() < 1e-12);
//! space.set_pose(can, Pose::new(3.0, 1.5, 0.0));
//! assert!((range(&space) - 2.995).abs() < 1e-12); // the wall is 10 mm thick
//! ```
//!
//! # How it works
//!
//! Rays and contacts use a uniform grid whose cells list the walls and solids in them; a ray visits cells in
//! order until it has a hit nearer than the next cell. A level scan is rasterised instead: every beam keeps
//! the inverse of the nearest range so far, which is linear in the beam's direction along a straight face.
//! Walls are grouped in small clusters, processed from near to far, so that hidden clusters are skipped.
//! Neither method affects results: a scan equals the same number of rays, and no answer depends on the order
//! in which solids moved.

mod cluster;
mod contact;
mod fan;
mod grid;
mod hills;
mod lattice;
mod polar;
mod ray;
mod scanner;
mod shape;
mod solid;
mod store;

pub use contact::Contact;
pub use scanner::Scanner;
pub use solid::{Solid, SolidId, Span};
pub use store::Space;
