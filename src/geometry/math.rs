//! Elementary functions with identical bits on every platform.
//!
//! `sin`, `ln` and the like differ in the last bit between C libraries, which is enough to make two simulated
//! runs diverge. These functions use the `libm` crate. Square roots are exact by IEEE 754 and need no
//! replacement.
//!
//! ```
//! use roverlab::geometry::math::{acos, asin, atan, atan2, cos, exp, hypot, ln, pow, sin, sin_cos, tan};
//! let is = |a: f64, b: f64| (a - b).abs() < 1e-12;
//! let third = std::f64::consts::FRAC_PI_3;
//! assert!(is(cos(third), 0.5) && is(acos(0.5), third) && is(sin(third), 0.75_f64.sqrt()));
//! assert!(is(tan(third), 3.0_f64.sqrt()) && is(atan(3.0_f64.sqrt()), third) && is(asin(1.0), 1.5 * third));
//! assert_eq!(sin_cos(third), (sin(third), cos(third)));
//! assert!(is(atan2(-1.0, -1.0), -0.75 * std::f64::consts::PI), "the angle of the vector (-1, -1)");
//! assert!(is(hypot(3.0, 4.0), 5.0) && is(ln(exp(2.0)), 2.0) && is(pow(9.0, 0.5), 3.0));
//! ```

/// Sine of an angle (rad).
#[inline]
pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// Cosine of an angle (rad).
#[inline]
pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// Sine and cosine of an angle (rad).
#[inline]
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// Tangent of an angle (rad).
#[inline]
pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// Arc sine, in `-pi/2..=pi/2`.
#[inline]
pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

/// Arc cosine, in `0..=pi`.
#[inline]
pub fn acos(x: f64) -> f64 {
    libm::acos(x)
}

/// Arc tangent, in `-pi/2..=pi/2`.
#[inline]
pub fn atan(x: f64) -> f64 {
    libm::atan(x)
}

/// Angle of the vector `(x, y)`, in `-pi..=pi`.
#[inline]
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// Natural exponential.
#[inline]
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// Natural logarithm.
#[inline]
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// `x` to the power of `y`.
#[inline]
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// Length of the vector `(x, y)`, without protection against overflow.
#[inline]
pub fn hypot(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}
