//! Two craft of Fossen's Python Vehicle Simulator, with its parameters, to compare the equations of this
//! module with that program.
//!
//! Formulas and signs follow the program: x forward, y to the right, z down.

use std::f64::consts::PI;

use super::craft::{split, stack};
use super::{Craft, CraftMotion, CraftSpec, GRAVITY, HullPart, Thruster, Wrench};
use crate::ParameterError;
use crate::geometry::{Point3, Vector3, math};

/// Water density in the program's drag formulas (kg/m³).
const SEA: f64 = 1026.0;
/// Hoerner's drag coefficients of cross-sections, in the range of the two craft: half beam over draught, and
/// coefficient.
const HOERNER: [(f64, f64); 3] = [(0.4933, 1.2108), (0.5585, 1.0836), (0.6464, 0.9986)];

/// Converts between y right, z down and y left, z up.
fn over(vector: Vector3) -> Vector3 {
    Vector3::new(vector.x, -vector.y, -vector.z)
}

/// The REMUS 100: a torpedo-shaped underwater craft with a propeller, a rudder and stern planes.
#[derive(Debug, Clone)]
pub struct Remus100 {
    /// The body. [`Remus100::forces`] adds damping in surge and sway, lift, fins and propeller.
    pub craft: Craft,
    fading: [f64; 2],
}

impl Remus100 {
    /// Length and diameter (m).
    const SIZE: [f64; 2] = [1.6, 0.19];

    /// The craft, with an integration step in seconds.
    ///
    /// # Errors
    ///
    /// If the step is out of range.
    pub fn new(step: f64) -> Result<Self, ParameterError> {
        let (a, b) = (0.5 * Self::SIZE[0], 0.5 * Self::SIZE[1]);
        let mass = 4.0 / 3.0 * PI * SEA * a * b * b;
        let (ix, iy) = (0.4 * mass * b * b, 0.2 * mass * (a * a + b * b));
        let below = 0.02;
        let e = (1.0 - (b / a) * (b / a)).sqrt();
        let log = math::ln((1.0 + e) / (1.0 - e));
        let cube = e * e * e;
        let alpha = 2.0 * (1.0 - e * e) / cube * (0.5 * log - e);
        let beta = 1.0 / (e * e) - (1.0 - e * e) / (2.0 * cube) * log;
        let (k1, k2) = (alpha / (2.0 - alpha), beta / (2.0 - beta));
        let turning =
            cube * e * (beta - alpha) / ((2.0 - e * e) * (2.0 * e * e - (2.0 - e * e) * (beta - alpha)));
        let added = [mass * k1, mass * k2, mass * k2, 0.3 * ix, turning * iy, turning * iy];
        let lever = mass * below * below;
        let total = [
            mass + added[0],
            mass + added[1],
            mass + added[2],
            ix + lever + added[3],
            iy + lever + added[4],
            iy + added[5],
        ];
        let swing = |inertia: f64| (mass * GRAVITY * below / inertia).sqrt();
        let linear = [
            0.0,
            0.0,
            total[2] / 20.0,
            total[3] * 2.0 * 0.3 * swing(total[3]),
            total[4] * 2.0 * 0.8 * swing(total[4]),
            total[5],
        ];
        let hull = HullPart::Ellipsoid { half_axes: Vector3::new(a, b, b), centre: Point3::origin() };
        let spec = CraftSpec {
            mass,
            centre_of_mass: Point3::new(0.0, 0.0, -below),
            inertia: [[ix, 0.0, 0.0], [0.0, iy, 0.0], [0.0, 0.0, iy]],
            hull: vec![hull],
            added_mass: added,
            munk: false,
            linear_damping: linear,
            quadratic_damping: [0.0; 6],
            thrusters: Vec::new(),
        };
        let fading = [total[0] / 20.0, total[1] / 20.0];
        Ok(Self { craft: Craft::new(&spec, step)?, fading })
    }

    /// All forces except weight, buoyancy, inertia and the body's damping, from the motion through the water
    /// and the speed over ground (m/s). Controls: rudder and stern planes (rad), propeller (turns/s).
    pub fn forces(
        &self,
        through_water: &CraftMotion,
        speed: f64,
        [rudder, stern, turns]: [f64; 3],
    ) -> Wrench {
        let flow = over(through_water.linear);
        let (fins, propeller) = (fins(&flow, rudder, stern), propeller(speed, turns));
        let mut force = fins.force + propeller.force + lift_and_drag(&flow);
        let fade = math::exp(-3.0 * flow.norm());
        force.x -= self.fading[0] * fade * flow.x;
        force.y -= self.fading[1] * fade * flow.y;
        let [length, across] = Self::SIZE;
        let strips = cross_flow(length, across, across, flow.y, over(through_water.angular).z);
        let moment = fins.moment + propeller.moment + strips.moment;
        Wrench { force: over(force + strips.force), moment: over(moment) }
    }
}

/// Rudder and stern planes of the REMUS 100.
fn fins(flow: &Vector3, rudder: f64, stern: f64) -> Wrench {
    let (area, tail) = (2.0 * 0.00665, -0.5 * Remus100::SIZE[0]);
    let (level, upright) = (flow.x * flow.x + flow.y * flow.y, flow.x * flow.x + flow.z * flow.z);
    let (across, down) =
        (-0.5 * SEA * level * area * 0.5 * rudder, -0.5 * SEA * upright * area * 0.7 * stern);
    let force = Vector3::new(across * rudder + down * stern, across, down);
    Wrench { force, moment: Vector3::new(0.0, -tail * down, tail * across) }
}

/// The propeller of the REMUS 100.
fn propeller(speed: f64, turns: f64) -> Wrench {
    let (diameter, square) = (0.14_f64, turns * turns.abs());
    let area = diameter * diameter;
    let advance = if turns > 0.0 { 0.944 * speed / diameter * turns.abs() / 0.6632 } else { 0.0 };
    let thrust = SEA * area * area * (0.4566 * square + (0.1798 - 0.4566) * advance);
    let torque = SEA * area * area * diameter * (0.0700 * square + (0.0312 - 0.0700) * advance);
    Wrench { force: Vector3::x() * (0.9 * thrust), moment: Vector3::x() * (0.1 * torque) }
}

/// Lift and drag of the REMUS 100's body, modelled as a wing.
fn lift_and_drag(flow: &Vector3) -> Vector3 {
    let [length, across] = Remus100::SIZE;
    let area = 0.7 * length * across;
    let parasitic = 0.42 * PI * 0.25 * across * across / area;
    let ratio = across * across / area;
    let attack = math::atan2(flow.z, flow.x);
    let lift = PI * ratio / (1.0 + (1.0 + 0.25 * ratio * ratio).sqrt()) * attack;
    let drag = parasitic + lift * lift / (PI * 0.7 * ratio);
    let pressure = 0.5 * SEA * flow.norm_squared() * area;
    let (sin, cos) = math::sin_cos(attack);
    Vector3::new(sin * lift - cos * drag, 0.0, -sin * drag - cos * lift) * pressure
}

/// Cross-flow drag of a long body, by strip theory (Fossen 2021, section 6.4).
fn cross_flow(length: f64, beam: f64, draught: f64, aside: f64, turning: f64) -> Wrench {
    let coefficient = hoerner(0.5 * beam / draught);
    let strip = length / 20.0;
    let mut sum = Wrench::NONE;
    for number in 0..=20 {
        let ahead = -0.5 * length + strip * f64::from(number);
        let speed = aside + ahead * turning;
        let force = -0.5 * SEA * draught * coefficient * speed * speed.abs() * strip;
        sum = sum + Wrench::at(Vector3::x() * ahead, Vector3::y() * force);
    }
    sum
}

fn hoerner(ratio: f64) -> f64 {
    let (a, b) = if ratio < HOERNER[1].0 { (HOERNER[0], HOERNER[1]) } else { (HOERNER[1], HOERNER[2]) };
    a.1 + (b.1 - a.1) / (b.0 - a.0) * (ratio - a.0)
}

/// The Otter: a surface catamaran with two propellers.
#[derive(Debug, Clone)]
pub struct Otter {
    /// The body. It has no hull: [`Otter::forces`] models buoyancy by springs.
    pub craft: Craft,
    draught: f64,
    springs: [f64; 3],
}

impl Otter {
    /// Load (kg).
    const LOAD: f64 = 25.0;
    /// Position of the load (m).
    const LOAD_AT: Vector3 = Vector3::new(0.05, 0.0, -0.35);
    /// Length, beam of a pontoon, and lateral position of the pontoons' centres (m).
    const SIZE: [f64; 3] = [2.0, 0.25, 0.395];
    /// Longitudinal position of the waterplane's centre (m).
    const FLOATS_AT: f64 = -0.2;
    /// Thrust per squared propeller speed, forward and backward (N s²).
    pub const THRUST: [f64; 2] = [0.02216 / 2.0, 0.01289 / 2.0];

    /// The craft, with an integration step in seconds.
    ///
    /// # Errors
    ///
    /// If the step is out of range.
    pub fn new(step: f64) -> Result<Self, ParameterError> {
        let (empty, density) = (55.0, 1025.0);
        let mass = empty + Self::LOAD;
        let [length, beam, aside] = Self::SIZE;
        let centre = (Vector3::new(0.2, 0.0, -0.2) * empty + Self::LOAD_AT * Self::LOAD) / mass;
        let squares = [0.4 * 1.08, 0.25 * length, 0.25 * length].map(|radius| empty * radius * radius);
        let spread = |at: Vector3, kg: f64| at.cross_matrix() * at.cross_matrix() * kg;
        let inertia = nalgebra::Matrix3::from_diagonal(&squares.into())
            - spread(centre, empty)
            - spread(Self::LOAD_AT, Self::LOAD);
        let added = [
            0.1 * empty,
            1.5 * empty,
            empty,
            0.2 * inertia[(0, 0)],
            0.8 * inertia[(1, 1)],
            1.7 * inertia[(2, 2)],
        ];
        let lever = |a: f64, b: f64| mass * (a * a + b * b);
        let total = [
            mass + added[0],
            mass + added[1],
            mass + added[2],
            inertia[(0, 0)] + lever(centre.y, centre.z) + added[3],
            inertia[(1, 1)] + lever(centre.x, centre.z) + added[4],
            inertia[(2, 2)] + lever(centre.x, centre.y) + added[5],
        ];
        let volume = mass / density;
        let draught = volume / (2.0 * 0.4 * beam * length);
        let springs = springs(density, volume, draught, centre.z);
        let relative = |ratio: f64, axis: usize| 2.0 * ratio * (springs[axis - 2] * total[axis]).sqrt();
        let linear = [
            24.4 * GRAVITY / (6.0 * 0.5144),
            total[1],
            relative(0.3, 2),
            relative(0.2, 3),
            relative(0.4, 4),
            total[5],
        ];
        let full = (0.5 * 24.4 * GRAVITY / Self::THRUST[0]).sqrt();
        let propeller = |name: &str, y: f64| Thruster {
            back: Self::THRUST[1] * full * full,
            lag: 0.1,
            ..Thruster::new(name, Point3::new(0.0, y, 0.0), Vector3::x(), Self::THRUST[0] * full * full)
        };
        let spec = CraftSpec {
            mass,
            centre_of_mass: over(centre).into(),
            inertia: std::array::from_fn(|row| {
                let sign = |axis: usize| if axis == 0 { 1.0 } else { -1.0 };
                std::array::from_fn(|column| sign(row) * sign(column) * inertia[(row, column)])
            }),
            hull: Vec::new(),
            added_mass: added,
            munk: true,
            linear_damping: linear,
            quadratic_damping: [0.0, 0.0, 0.0, 0.0, 0.0, 10.0 * total[5]],
            thrusters: vec![propeller("left", aside), propeller("right", -aside)],
        };
        Ok(Self { craft: Craft::new(&spec, step)?, draught, springs })
    }

    /// Maximum propeller speed (rad/s).
    pub fn full_speed() -> f64 {
        (0.5 * 24.4 * GRAVITY / Self::THRUST[0]).sqrt()
    }

    /// All forces except thrust, inertia and damping, from the motion through the water, the height above
    /// rest (m), and roll and pitch (rad).
    pub fn forces(&self, through_water: &CraftMotion, height: f64, [roll, pitch]: [f64; 2]) -> Wrench {
        let (pitch, depth) = (-pitch, -height);
        let [heave, rolling, pitching] = self.springs;
        let up = heave * (depth - Self::FLOATS_AT * pitch);
        let moment = Vector3::new(-rolling * roll, Self::FLOATS_AT * up - pitching * pitch, 0.0);
        let ((sr, cr), (sp, cp)) = (math::sin_cos(roll), math::sin_cos(pitch));
        let weight = Vector3::new(-sp, cp * sr, cp * cr) * (Self::LOAD * GRAVITY);
        let (flow, turning) = (over(through_water.linear), over(through_water.angular));
        let [length, beam, _] = Self::SIZE;
        let strips = cross_flow(length, beam, self.draught, flow.y, turning.z);
        let sum = Wrench { force: Vector3::z() * -up, moment } + Wrench::at(Self::LOAD_AT, weight) + strips;
        Wrench { force: over(sum.force), moment: over(sum.moment) }
    }
}

/// Hydrostatic stiffness of the Otter in heave, roll and pitch.
fn springs(density: f64, volume: f64, draught: f64, centre: f64) -> [f64; 3] {
    let [length, beam, aside] = Otter::SIZE;
    let fullness = 0.75;
    let plane = fullness * length * beam;
    let shape = 6.0 * fullness * fullness * fullness / ((1.0 + fullness) * (1.0 + 2.0 * fullness));
    let across = 2.0 / 12.0 * length * beam * beam * beam * shape + 2.0 * plane * aside * aside;
    let along = 0.8 * 2.0 / 12.0 * beam * length * length * length;
    let buoyancy = (2.5 * draught - 0.5 * volume / (length * beam)) / 3.0;
    let weight = draught - centre;
    let metacentric = |moment: f64| buoyancy + moment / volume - weight;
    [2.0 * plane, volume * metacentric(across), volume * metacentric(along)]
        .map(|value| density * GRAVITY * value)
}

impl CraftMotion {
    /// The motion after some time (s) at a constant acceleration.
    #[must_use]
    pub fn after(&self, acceleration: &CraftMotion, seconds: f64) -> Self {
        let moved =
            stack(&self.linear, &self.angular) + stack(&acceleration.linear, &acceleration.angular) * seconds;
        let (linear, angular) = split(&moved);
        Self { linear, angular }
    }
}
