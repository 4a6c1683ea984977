//! RoBIOS's numbers: whole millimetres and degrees.

use std::ffi::c_int;

use crate::geometry::units;
use crate::io::{Error, Result};

/// RoBIOS's reading for nothing in range.
pub(super) const NOTHING: c_int = 9999;

/// A number rounded for RoBIOS.
pub(super) fn whole(name: &str, value: f64) -> Result<c_int> {
    let rounded = value.round();
    if rounded.abs() <= f64::from(c_int::MAX) {
        return Ok(rounded as c_int);
    }
    Err(Error::invalid_input(name, value, "a number that RoBIOS can hold"))
}

pub(super) fn millimetres(name: &str, metres: f64) -> Result<c_int> {
    whole(name, units::to_mm(metres))
}

pub(super) fn degrees(name: &str, radians: f64) -> Result<c_int> {
    whole(name, units::to_deg(radians))
}

pub(super) fn metres(millimetres: c_int) -> f64 {
    units::from_mm(millimetres.into())
}

pub(super) fn radians(degrees: c_int) -> f64 {
    units::from_deg(degrees.into())
}

pub(super) fn range(distance: c_int) -> f64 {
    if distance >= NOTHING { f64::INFINITY } else { metres(distance.max(0)) }
}
