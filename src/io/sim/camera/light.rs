use super::canvas::Packed;
use super::view::Place;
use crate::world::Colour;

/// Direction towards the light, a unit vector.
pub(super) const SUN: Place = [0.36, 0.48, 0.8];
/// Ambient fraction of the light.
const AMBIENT: f64 = 0.55;

/// Brightness of a surface whose normal is at an angle with `cosine` to the sun.
#[inline]
pub(super) fn shade(cosine: f64) -> f64 {
    AMBIENT + (1.0 - AMBIENT) * cosine.max(0.0)
}

/// Colour of a surface with a unit normal.
pub(super) fn lit(colour: Colour, normal: Place) -> Packed {
    let cosine = normal[0] * SUN[0] + normal[1] * SUN[1] + normal[2] * SUN[2];
    scaled(colour, shade(cosine))
}

/// A colour with all channels times a factor from 0 to 1.
#[inline]
pub(super) fn scaled(colour: Colour, factor: f64) -> Packed {
    let channel = |value: u8| (f64::from(value) * factor + 0.5) as u32;
    channel(colour.red) << 16 | channel(colour.green) << 8 | channel(colour.blue)
}

/// Converts a colour without changes.
pub(super) fn packed(colour: Colour) -> Packed {
    u32::from(colour.red) << 16 | u32::from(colour.green) << 8 | u32::from(colour.blue)
}
