use std::f64::consts::PI;

use crate::geometry::{Point3, Vector3, math};

/// Displaced water: its volume and first moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Displaced {
    /// Volume (m³).
    pub volume: f64,
    /// First moment about the craft's origin, volume times centre (m⁴).
    pub moment: Vector3,
}

impl Displaced {
    /// No water.
    pub const NOTHING: Self = Self { volume: 0.0, moment: Vector3::new(0.0, 0.0, 0.0) };

    /// The water that something displaces whose sizes or place are not finite.
    pub(super) const UNKNOWN: Self =
        Self { volume: f64::NAN, moment: Vector3::new(f64::NAN, f64::NAN, f64::NAN) };

    /// Centre of buoyancy; the origin if no water is displaced.
    pub fn centre(&self) -> Point3 {
        if self.volume <= 0.0 { Point3::origin() } else { Point3::from(self.moment / self.volume) }
    }

    /// The same relative to another origin.
    pub(super) fn seen_from(self, origin: Vector3) -> Self {
        Self { moment: self.moment - origin * self.volume, ..self }
    }
}

impl std::ops::Add for Displaced {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { volume: self.volume + other.volume, moment: self.moment + other.moment }
    }
}

impl std::iter::Sum for Displaced {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        parts.fold(Self::NOTHING, |sum, part| sum + part)
    }
}

/// The part of the centred unit ball below a plane.
pub(super) fn cap(up: &Vector3, depth: f64) -> Displaced {
    let depth = depth.clamp(-1.0, 1.0);
    let left = 1.0 - depth * depth;
    let volume = PI / 3.0 * (2.0 + depth * (3.0 - depth * depth));
    Displaced { volume, moment: up * (-0.25 * PI * left * left) }
}

/// Area of the part of a disc in which one coordinate is at most `d`.
pub(super) fn segment(radius: f64, d: f64) -> f64 {
    let d = d.clamp(-radius, radius);
    let half_chord = (radius * radius - d * d).max(0.0).sqrt();
    radius * radius * (std::f64::consts::FRAC_PI_2 + math::asin((d / radius).clamp(-1.0, 1.0)))
        + d * half_chord
}
