//! The simulated camera: a software rasteriser of the world's scene.
//!
//! A picture is made in three steps. [`ground`] fills it with sky and floor. Objects on the floor are split
//! into flat [`face`]s and balls, drawn with a depth test.
//! Water veils what is in it ([`murk`]). [`film`] converts it to bytes, with the room's
//! light and the errors of a real camera. [`fisheye`] samples such pictures through its lens. All arithmetic
//! is identical on every platform, so the same scene gives the same bytes.

mod ball;
mod canvas;
mod device;
mod face;
mod film;
mod fisheye;
mod ground;
mod light;
mod model;
mod murk;
mod poster;
mod relief;
mod run;
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
