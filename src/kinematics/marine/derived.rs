//! What follows from a hull: inertia, added mass and damping of a craft whose description states none.

use super::{CraftSpec, HullPart};
use crate::geometry::{Point3, Vector3, math};

/// The density of fresh water, in kg/m³.
const FRESH: f64 = 1000.0;
/// Drag coefficient of a body that is no longer along the flow than across it.
const BLUNT: f64 = 1.1;
/// Drag coefficient of a slender body; the ratio of width to length leads from this one to `BLUNT`.
const SLENDER: f64 = 0.3;
/// The speed, in m/s or rad/s, at which linear damping is as large as quadratic damping.
const CREEP: f64 = 0.1;

impl CraftSpec {
    /// A craft without thrusters whose inertia, added mass and damping follow from its hull.
    ///
    /// The mass is distributed evenly over the parts. Each part has the added mass of an ellipsoid of its
    /// size (Lamb) and the drag of a body of its length and width, in proportion to its submerged fraction
    /// when the craft floats at rest. Parts do not shield each other from the flow.
    pub fn of_hull(mass: f64, centre_of_mass: Point3, hull: Vec<HullPart>) -> Self {
        let whole: f64 = hull.iter().map(HullPart::volume).sum();
        let centre: Vector3 = hull.iter().map(|part| part.centre().coords * (part.volume() / whole)).sum();
        let mut spec = Self {
            mass,
            centre_of_mass,
            inertia: [[0.0; 3]; 3],
            added_mass: [0.0; 6],
            munk: false,
            linear_damping: [0.0; 6],
            quadratic_damping: [0.0; 6],
            thrusters: Vec::new(),
            hull: Vec::new(),
        };
        let level = floats_at(&hull, mass, FRESH);
        for part in &hull {
            let arm = part.centre().coords - centre;
            let own = mass * part.volume() / whole;
            let half = part.half_size();
            for axis in 0..3 {
                let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
                let gyration = solidity(part) * (half[b] * half[b] + half[c] * half[c]);
                spec.inertia[axis][axis] += own * (gyration + arm[b] * arm[b] + arm[c] * arm[c]);
            }
            let wet = part.displaced(&Vector3::z(), level).volume / part.volume();
            add_water(&mut spec, part, &arm, wet);
        }
        spec.linear_damping = spec.quadratic_damping.map(|quadratic| CREEP * quadratic);
        Self { hull, ..spec }
    }

    /// Height of the waterline in the craft's own frame (m), when it floats level in still water of a density
    /// (kg/m³). Above the hull for a craft that sinks; NaN if that cannot be told, as of a hull without finite
    /// sizes.
    ///
    /// ```
    /// use roverlab::kinematics::marine::CraftSpec;
    /// let mako = CraftSpec::mako();
    /// assert!(mako.waterline(1025.0) < mako.waterline(1000.0), "salt water carries more");
    /// ```
    pub fn waterline(&self, density: f64) -> f64 {
        floats_at(&self.hull, self.mass, density)
    }

    /// Area exposed to wind when the craft floats at rest in fresh water, seen from ahead and from the side
    /// (m²).
    pub fn windage(&self) -> [f64; 2] {
        let level = self.waterline(FRESH);
        [0, 1].map(|axis| {
            let dry = |part: &HullPart| 1.0 - part.displaced(&Vector3::z(), level).volume / part.volume();
            self.hull.iter().map(|part| dry(part) * frontal(part, axis)).sum()
        })
    }
}

/// The square of a radius of gyration, for the squares of the half sizes across the axis.
fn solidity(part: &HullPart) -> f64 {
    match part {
        HullPart::Box { .. } => 1.0 / 3.0,
        HullPart::Capsule { .. } => 0.3,
        HullPart::Ellipsoid { .. } => 0.2,
    }
}

/// The level of water at which a hull carries a mass; above the hull if it cannot. NaN if it cannot be told.
fn floats_at(hull: &[HullPart], mass: f64, density: f64) -> f64 {
    let end = |part: &HullPart, sign: f64| part.centre().z + sign * part.half_size().z;
    let mut low = hull.iter().map(|part| end(part, -1.0)).fold(f64::INFINITY, f64::min);
    let mut high = hull.iter().map(|part| end(part, 1.0)).fold(f64::NEG_INFINITY, f64::max);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        let carried: f64 = hull.iter().map(|part| part.displaced(&Vector3::z(), middle).volume).sum();
        if (density * carried).is_nan() || mass.is_nan() {
            return f64::NAN;
        }
        if density * carried < mass { low = middle } else { high = middle }
    }
    high
}

/// Adds the added mass and the quadratic damping of a part whose middle is at `arm`, and of which a share is
/// wet.
fn add_water(spec: &mut CraftSpec, part: &HullPart, arm: &Vector3, wet: f64) {
    let half = part.half_size();
    let lamb = lamb(&half);
    let mass = FRESH * part.volume() * wet;
    let added = lamb.map(|share| mass * share / (2.0 - share));
    let drag = Vector3::from_fn(|axis, _| {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let across = (half[b] * half[c]).sqrt();
        let coefficient = SLENDER + (BLUNT - SLENDER) * (across / half[axis]).min(1.0);
        0.5 * FRESH * coefficient * frontal(part, axis) * wet
    });
    for axis in 0..3 {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        spec.added_mass[axis] += added[axis];
        spec.quadratic_damping[axis] += drag[axis];
        // Turning about the axis: the part turns, and its middle moves along the two others.
        let (bb, cc) = (half[b] * half[b], half[c] * half[c]);
        let (difference, more) = (bb - cc, lamb[c] - lamb[b]);
        let denominator = 2.0 * difference - (bb + cc) * more;
        let turned = if difference == 0.0 { 0.0 } else { difference * difference * more / denominator };
        let carried = added[b] * arm[c] * arm[c] + added[c] * arm[b] * arm[b];
        spec.added_mass[axis + 3] += 0.2 * mass * turned + carried;
        // A strip at a distance along b moves along c: the mean of the cube of the distance is a quarter of
        // half's.
        let strips = 0.25 * (drag[c] * cube(half[b]) + drag[b] * cube(half[c]));
        let moved = drag[b] * cube(arm[c]) + drag[c] * cube(arm[b]);
        spec.quadratic_damping[axis + 3] += strips + moved;
    }
}

fn cube(length: f64) -> f64 {
    (length * length * length).abs()
}

/// The area that a part shows along an axis.
fn frontal(part: &HullPart, axis: usize) -> f64 {
    use std::f64::consts::PI;
    let half = part.half_size();
    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
    match *part {
        HullPart::Box { .. } => 4.0 * half[b] * half[c],
        HullPart::Ellipsoid { .. } => PI * half[b] * half[c],
        HullPart::Capsule { radius, length, axis: along, .. } if along != axis => {
            2.0 * radius * (length - 2.0 * radius) + PI * radius * radius
        }
        HullPart::Capsule { radius, .. } => PI * radius * radius,
    }
}

/// Lamb's numbers of an ellipsoid for its three axes, which sum to 2: `abc` times the integral from 0 of
/// `1 / ((a² + s) √((a² + s)(b² + s)(c² + s)))`. By 4,000 midpoints after `s = m² t² / (1 - t)²`.
fn lamb(half: &Vector3) -> Vector3 {
    const POINTS: usize = 4000;
    let squares = half.component_mul(half);
    let size = math::pow(half.product(), 1.0 / 3.0);
    let mut sum = Vector3::zeros();
    for point in 0..POINTS {
        let t = (point as f64 + 0.5) / POINTS as f64;
        let root = size * t / (1.0 - t);
        let widened = squares.add_scalar(root * root);
        let step = 2.0 * root * size / ((1.0 - t) * (1.0 - t));
        sum += widened.map(|square| step / (square * widened.product().sqrt()));
    }
    sum * (half.product() / POINTS as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lambs_numbers_are_those_of_balls_and_spheroids() {
        let ball = lamb(&Vector3::repeat(0.3));
        assert!((ball - Vector3::repeat(2.0 / 3.0)).norm() < 1e-5, "{ball}");
        // A spheroid eight times as long as wide, in closed form.
        let e = (1.0_f64 - 1.0 / 64.0).sqrt();
        let log = crate::geometry::math::ln((1.0 + e) / (1.0 - e));
        let along = 2.0 * (1.0 - e * e) / (e * e * e) * (0.5 * log - e);
        let long = lamb(&Vector3::new(0.8, 0.1, 0.1));
        assert!((long.x - along).abs() < 1e-4 && (long.sum() - 2.0).abs() < 1e-4, "{long} {along}");
    }

    #[test]
    fn a_ball_carries_half_of_its_water_along() {
        let ball = HullPart::Ellipsoid { half_axes: Vector3::repeat(0.2), centre: Point3::origin() };
        let spec = CraftSpec::of_hull(40.0, Point3::origin(), vec![ball]);
        let half = 0.5 * FRESH * ball.volume();
        assert!((spec.added_mass[0] / half - 1.0).abs() < 1e-3 && spec.added_mass[3] == 0.0, "{spec:?}");
        assert!((spec.inertia[0][0] - 0.4 * 40.0 * 0.04).abs() < 1e-12);
    }
}
