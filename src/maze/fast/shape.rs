use crate::ParameterError;
use crate::parameter::require;
use std::f64::consts::PI;

use crate::geometry::{Pose, math};

/// A curve whose curvature rises linearly from 0, stays constant, and falls back symmetrically; the two ramps
/// account for half of its angle. It starts at the origin along x and turns left.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shape {
    /// Arc length (m).
    pub(super) length: f64,
    /// Length of either ramp (m).
    pub(super) ramp: f64,
    /// Maximum curvature (1/m).
    pub(super) peak: f64,
    /// Poses at equal distances.
    poses: Vec<Pose>,
}

/// Name of the parameter that determines the size of turns.
pub(super) const CELL: &str = "size of a cell";

/// Fraction of the angle that is turned in the two ramps.
const RAMPS: f64 = 0.5;
/// Number of intervals between the poses.
const INTERVALS: usize = 256;

impl Shape {
    /// A turn by less than half a turn, between two lines that meet `tangent` (m) from either end.
    pub(super) fn turn(angle: f64, tangent: f64) -> Result<Self, ParameterError> {
        let unit = Self::with_peak(angle, 1.0);
        Self::scaled(angle, tangent, unit.end().y / math::sin(angle))
    }

    /// A half turn that ends `width` (m) to the side.
    pub(super) fn u_turn(width: f64) -> Result<Self, ParameterError> {
        let unit = Self::with_peak(PI, 1.0);
        Self::scaled(PI, width, unit.end().y)
    }

    fn scaled(angle: f64, size: f64, unit_size: f64) -> Result<Self, ParameterError> {
        let scale = size / unit_size;
        require(CELL, size, scale.is_finite() && scale > 0.0, "a size that turns can have")?;
        Ok(Self::with_peak(angle, 1.0 / scale))
    }

    fn with_peak(angle: f64, peak: f64) -> Self {
        let ramp = RAMPS * angle / peak;
        let length = ramp + angle / peak;
        let mut shape = Self { length, ramp, peak, poses: vec![Pose::default()] };
        let step = length / INTERVALS as f64;
        let mut pose = Pose::default();
        for i in 0..INTERVALS {
            // Simpson's rule: heading at three points of the step, integral of its direction.
            let headings = [0.0, 0.5, 1.0].map(|part| shape.heading_at((i as f64 + part) * step));
            let [a, b, c] = headings.map(math::sin_cos);
            pose.x += step / 6.0 * (a.1 + 4.0 * b.1 + c.1);
            pose.y += step / 6.0 * (a.0 + 4.0 * b.0 + c.0);
            pose.heading = headings[2];
            shape.poses.push(pose);
        }
        shape
    }

    /// Curvature at an arc length.
    pub(super) fn curvature_at(&self, s: f64) -> f64 {
        let from_end = s.min(self.length - s).max(0.0);
        self.peak * (from_end / self.ramp).min(1.0)
    }

    /// Angle turned up to an arc length.
    pub(super) fn heading_at(&self, s: f64) -> f64 {
        let Self { length, ramp, peak, .. } = *self;
        let s = s.clamp(0.0, length);
        if s < ramp {
            0.5 * peak * s * s / ramp
        } else if s <= length - ramp {
            peak * (s - 0.5 * ramp)
        } else {
            let rest = length - s;
            peak * (length - ramp) - 0.5 * peak * rest * rest / ramp
        }
    }

    /// Pose at an arc length.
    pub(super) fn pose_at(&self, s: f64) -> Pose {
        let place = (s / self.length).clamp(0.0, 1.0) * INTERVALS as f64;
        let index = (place as usize).min(INTERVALS - 1);
        let (a, b) = (self.poses[index], self.poses[index + 1]);
        let part = place - index as f64;
        Pose::new(a.x + part * (b.x - a.x), a.y + part * (b.y - a.y), self.heading_at(s))
    }

    /// Pose at the end.
    pub(super) fn end(&self) -> Pose {
        self.poses[INTERVALS]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    #[test]
    fn a_turn_joins_its_tangents() {
        for angle in [FRAC_PI_4, FRAC_PI_2, 3.0 * FRAC_PI_4] {
            let shape = Shape::turn(angle, 0.1).unwrap();
            let (sin, cos) = math::sin_cos(angle);
            let end = shape.end();
            assert!((end.x - 0.1 * (1.0 + cos)).abs() < 1e-9 && (end.y - 0.1 * sin).abs() < 1e-9, "{end:?}");
            assert!((end.heading - angle).abs() < 1e-12);
            let middle = shape.pose_at(0.5 * shape.length);
            assert!((middle.heading - 0.5 * angle).abs() < 1e-12);
        }
    }

    #[test]
    fn a_half_turn_ends_beside_its_beginning() {
        let end = Shape::u_turn(0.18).unwrap().end();
        assert!(end.x.abs() < 1e-9 && (end.y - 0.18).abs() < 1e-9 && (end.heading - PI).abs() < 1e-12);
    }

    #[test]
    fn curvature_is_continuous_and_the_heading_its_integral() {
        let shape = Shape::turn(FRAC_PI_2, 0.09).unwrap();
        let n = 10_000;
        let step = shape.length / f64::from(n);
        let mut heading = 0.0;
        for i in 0..n {
            let s = (f64::from(i) + 0.5) * step;
            heading += shape.curvature_at(s) * step;
            assert!((heading - shape.heading_at(s + 0.5 * step)).abs() < 1e-6);
            let jump = shape.curvature_at(s + step) - shape.curvature_at(s);
            assert!(jump.abs() <= 1.01 * shape.peak * step / shape.ramp);
        }
        assert_eq!(shape.curvature_at(0.0), 0.0);
        assert!(Shape::turn(FRAC_PI_2, 0.0).is_err());
    }
}
