//! Conversion of the millimetres and degrees that the book, EyeSim's files, RoBIOS and the command line use.
//!
//! ```
//! use roverlab::geometry::units::{from_deg, from_mm, to_deg, to_mm};
//! assert_eq!((from_mm(1500.0), to_mm(1.5)), (1.5, 1500.0));
//! assert_eq!((from_deg(180.0), to_deg(std::f64::consts::PI)), (std::f64::consts::PI, 180.0));
//! ```

use std::f64::consts::PI;

/// Standard gravity, 9.80665, rounded as usual (m/s²).
pub const GRAVITY: f64 = 9.81;

/// Maximum distance from the origin (m); larger numbers are mistakes.
pub(crate) const FARTHEST: f64 = 1e6;

/// Weight of a turn where distances and turns are added, as in the detection of stalled robots (m/rad).
pub(crate) const ARM: f64 = 0.1;

/// Lengths, angles and speeds below this count as zero (m, rad, m/s, rad/s).
pub(crate) const NEGLIGIBLE: f64 = 1e-6;

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
