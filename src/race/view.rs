//! Visibility of cones from the car: near enough, ahead, and not hidden.

use super::cone::APART;
use super::sight::ConeSighting;
use crate::geometry::{Vector, cross, math};

/// Distance from the sensor (m) and angle from straight ahead (rad) within which an undetected cone counts as missing.
pub(super) const VIEW: (f64, f64) = (9.0, 0.8);

/// Whether a cone at a position relative to the sensor would be seen.
pub(super) fn in_view(place: Vector) -> bool {
    let distance = place.norm();
    distance < VIEW.0 && distance > 1.0 && math::atan2(place.y, place.x).abs() < VIEW.1
}

/// Whether an object hides a position; `place` is relative to the sensor, `thing` in the car frame.
pub(super) fn hides(thing: &ConeSighting, sensor: f64, place: Vector) -> bool {
    let beside = APART + if thing.is_cone() { 0.0 } else { 0.5 * thing.size };
    let thing = thing.position.coords - Vector::new(sensor, 0.0);
    let (distance, along) = (place.norm(), thing.dot(&place) / place.norm());
    along > 0.0 && along < distance - APART && (cross(place, thing) / distance).abs() < beside
}
