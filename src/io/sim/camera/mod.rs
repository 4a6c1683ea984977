//! The simulated camera: a software rasteriser of the world's scene.
//!
//! A picture is made in three steps. The [`ground`] fills it with sky and floor; what stands on the floor is
//! cut into flat [`face`]s and balls, each drawn where it is nearer than what was drawn before; and the
//! [`film`] makes an image of bytes of it, with the light of the room and the flaws of a real camera. A
//! [`fisheye`] looks at such pictures through its lens. Everything is plain arithmetic on numbers that are
//! the same on every platform, so the same scene gives the same bytes.

mod ball;
mod canvas;
mod device;
mod face;
mod film;
mod fisheye;
mod ground;
mod light;
mod model;
mod poster;
mod relief;
mod scenery;
mod slanted;
mod solids;
mod studio;
#[cfg(test)]
mod tests;
mod texture;
mod view;

pub(super) use device::{CameraDevice, Moment};
pub(super) use studio::Studio;
