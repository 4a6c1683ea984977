//! Millimetres and degrees, as the book, EyeSim's files, RoBIOS and the command line use them.

use std::f64::consts::PI;

/// What gravity accelerates by, in m/s²: standard gravity, 9.80665, as it is usually rounded.
pub const GRAVITY: f64 = 9.81;

/// Millimetres to metres.
#[inline]
pub fn from_mm(millimetres: f64) -> f64 {
    millimetres / 1000.0
}

/// Metres to millimetres.
#[inline]
pub fn to_mm(metres: f64) -> f64 {
    metres * 1000.0
}

/// Degrees to radians.
#[inline]
pub fn from_deg(degrees: f64) -> f64 {
    degrees * (PI / 180.0)
}

/// Radians to degrees.
#[inline]
pub fn to_deg(radians: f64) -> f64 {
    radians * (180.0 / PI)
}
