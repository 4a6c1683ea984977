//! A capsule, cut obliquely by the water surface.

use std::f64::consts::{FRAC_PI_2, PI};

use super::displaced::{Displaced, cap, segment};
use crate::geometry::{Vector3, math};

/// The part of a centred capsule below a plane: a cylinder of length `2 half`, and two half balls.
pub(super) fn cut(radius: f64, half: f64, axis: usize, up: &Vector3, depth: f64) -> Displaced {
    let mut along = Vector3::zeros();
    along[axis] = 1.0;
    let ends = [along, -along].map(|outward| {
        let end = half_ball(&outward, up, (depth - half * up.dot(&outward)) / radius);
        let volume = end.volume * radius * radius * radius;
        Displaced {
            volume,
            moment: end.moment * (radius * radius * radius * radius) + outward * (half * volume),
        }
    });
    ends[0] + ends[1] + cylinder(radius, half, axis, up, depth)
}

/// The part of half of the unit ball, on the side of `outward`, below a plane.
///
/// The plane and the flat face bound a region of the sphere by two arcs. Its area follows from the
/// Gauss–Bonnet theorem; the volume follows from the areas by the divergence theorem.
fn half_ball(outward: &Vector3, up: &Vector3, depth: f64) -> Displaced {
    let half = Displaced { volume: 2.0 / 3.0 * PI, moment: outward * (0.25 * PI) };
    if depth >= 1.0 {
        return half;
    }
    if depth <= -1.0 {
        return Displaced::NOTHING;
    }
    let face = -outward;
    let cosine = up.dot(&face);
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    if depth.abs() >= sine {
        return uncrossed(half, up, depth, cosine);
    }
    let rim = (1.0 - depth * depth).sqrt();
    // Position of the line where water plane and flat face meet, in the plane and in the face.
    let (across_plane, across_face) = (-depth * cosine / sine, depth / sine);
    let arc = 2.0 * (FRAC_PI_2 + math::asin((across_plane / rim).clamp(-1.0, 1.0)));
    let corner = FRAC_PI_2 + math::asin((cosine / rim).clamp(-1.0, 1.0));
    let sphere = depth * arc + 2.0 * corner;
    let volume = (sphere + depth * segment(rim, across_plane)) / 3.0;
    let moment = up * roundness(rim, across_plane) + face * roundness(1.0, across_face);
    Displaced { volume, moment: moment * -0.5 }
}

/// A half ball whose flat face the water plane does not cross.
fn uncrossed(half: Displaced, up: &Vector3, depth: f64, cosine: f64) -> Displaced {
    let is_cut = depth * cosine <= 0.0;
    match (is_cut, depth > 0.0) {
        (true, true) => {
            let dry = cap(&-up, -depth);
            Displaced { volume: half.volume - dry.volume, moment: half.moment - dry.moment }
        }
        (true, false) => cap(up, depth),
        (false, true) => half,
        (false, false) => Displaced::NOTHING,
    }
}

/// Integral of `radius² - r²` over the part of a disc in which one coordinate is at most `d`; `r` is the
/// distance from the centre.
fn roundness(radius: f64, d: f64) -> f64 {
    let t = (d / radius).clamp(-1.0, 1.0);
    let s = (1.0 - t * t).sqrt();
    let integral = t * (5.0 - 2.0 * t * t) * s / 8.0 + 0.375 * (math::asin(t) + FRAC_PI_2);
    4.0 / 3.0 * radius * radius * radius * radius * integral
}

/// The part of a centred cylinder of length `2 half` along an axis, below a plane.
fn cylinder(radius: f64, half: f64, axis: usize, up: &Vector3, depth: f64) -> Displaced {
    if half <= 0.0 {
        return Displaced::NOTHING;
    }
    let slope = up[axis];
    let mut across = *up;
    across[axis] = 0.0;
    let steepness = across.norm().max(f64::MIN_POSITIVE);
    // Water level in the cross-section at a position along the axis, in radii.
    let rise = |x: f64| (depth - slope * x) / steepness / radius;
    let (low, high) = if slope > 0.0 { (half, -half) } else { (-half, half) };
    let place = |level: f64| ((depth - level * radius * steepness) / slope).clamp(-half, half);
    let (dry, full) = if rise(low) < -1.0 && rise(high) > 1.0 {
        (place(-1.0), place(1.0))
    } else {
        let dry = if rise(low) < -1.0 { place(-1.0) } else { low };
        (dry, if rise(high) > 1.0 { place(1.0) } else { high })
    };
    let area = PI * radius * radius;
    let whole = (high - full).abs() * area;
    let cross = Section::between(rise(dry).clamp(-1.0, 1.0), rise(full).clamp(-1.0, 1.0));
    let length = full - dry;
    let partial = length.abs() * radius * radius * cross.area;
    let mut moment = Vector3::zeros();
    moment[axis] = whole * 0.5 * (high + full)
        + partial * 0.5 * (dry + full)
        + length.abs() * length * radius * radius * cross.lean;
    moment += across * (length.abs() * radius * radius * radius * cross.sideways / steepness);
    Displaced { volume: whole + partial, moment }
}

/// Means over the cross-sections of a cylinder of radius 1, in which the water level rises linearly.
struct Section {
    area: f64,
    /// Mean of area times position along the axis, from -1/2 to 1/2.
    lean: f64,
    /// Mean first moment in the direction of the rising level.
    sideways: f64,
}

/// Below this difference of levels, Gauss–Legendre quadrature avoids cancellation in the closed forms.
const NEAR: f64 = 0.02;
/// Nodes and weights of the five-point Gauss–Legendre rule on -1/2 to 1/2.
const GAUSS: [(f64, f64); 5] = [
    (-0.453_089_922_969_332, 0.118_463_442_528_094_54),
    (-0.269_234_655_052_841_54, 0.239_314_335_249_683_24),
    (0.0, 0.284_444_444_444_444_44),
    (0.269_234_655_052_841_54, 0.239_314_335_249_683_24),
    (0.453_089_922_969_332, 0.118_463_442_528_094_54),
];

impl Section {
    fn between(from: f64, to: f64) -> Self {
        let way = to - from;
        let middle = 0.5 * (from + to);
        if way.abs() < NEAR {
            let mut sum = Self { area: 0.0, lean: 0.0, sideways: 0.0 };
            for (place, weight) in GAUSS {
                let t = (middle + place * way).clamp(-1.0, 1.0);
                let s = (1.0 - t * t).sqrt();
                let area = FRAC_PI_2 + math::asin(t) + t * s;
                sum.area += weight * area;
                sum.lean += weight * area * place;
                sum.sideways -= weight * 2.0 / 3.0 * s * s * s;
            }
            return sum;
        }
        let (a, b) = (Antiderivatives::at(from), Antiderivatives::at(to));
        let area = (b.area - a.area) / way;
        let first = (b.first - a.first) / way;
        Self { area, lean: (first - middle * area) / way, sideways: (b.sideways - a.sideways) / way }
    }
}

/// Integrals from 0 to a level: of a segment's area, of area times level, and of its first moment.
struct Antiderivatives {
    area: f64,
    first: f64,
    sideways: f64,
}

impl Antiderivatives {
    fn at(t: f64) -> Self {
        let s = (1.0 - t * t).max(0.0).sqrt();
        let arc = math::asin(t);
        let power = t * (5.0 - 2.0 * t * t) * s / 8.0 + 0.375 * arc;
        Self {
            area: FRAC_PI_2 * t + t * arc + s - s * s * s / 3.0,
            first: 0.25 * PI * t * t + (0.5 * t * t - 0.125) * arc + t * s * (1.0 + 2.0 * t * t) / 8.0,
            sideways: -2.0 / 3.0 * power,
        }
    }
}
