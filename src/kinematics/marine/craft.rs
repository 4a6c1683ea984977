use nalgebra::{Matrix3, Matrix6, Rotation3, UnitQuaternion, Vector6};

use super::{CraftSpec, Displaced, GRAVITY, HullPart, MAX_THRUSTERS, Thruster};
use crate::ParameterError;
use crate::geometry::{Point3, Pose3, Vector, Vector3, math};
use crate::parameter::{require, require_positive};

/// Velocity of a craft in its own frame, at the centre of volume of its hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CraftMotion {
    /// Linear velocity (m/s).
    pub linear: Vector3,
    /// Angular velocity about each axis (rad/s).
    pub angular: Vector3,
}

/// A force and a moment on a craft in its own frame, about the centre of volume of its hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench {
    /// Force (N).
    pub force: Vector3,
    /// Moment (N m).
    pub moment: Vector3,
}

impl CraftMotion {
    /// Rest.
    pub const STILL: Self =
        Self { linear: Vector3::new(0.0, 0.0, 0.0), angular: Vector3::new(0.0, 0.0, 0.0) };
}

impl Wrench {
    /// No force.
    pub const NONE: Self = Self { force: Vector3::new(0.0, 0.0, 0.0), moment: Vector3::new(0.0, 0.0, 0.0) };

    /// A force that acts at a point.
    pub fn at(place: Vector3, force: Vector3) -> Self {
        Self { force, moment: place.cross(&force) }
    }
}

impl std::ops::Add for Wrench {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { force: self.force + other.force, moment: self.moment + other.moment }
    }
}

/// The water around a craft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalWater {
    /// Density (kg/m³).
    pub density: f64,
    /// Height of the surface above the world's origin, at the craft (m); -∞ without water.
    pub level: f64,
    /// Slope of the surface along x and y.
    pub slope: Vector,
    /// Velocity in the world's frame (m/s).
    pub velocity: Vector3,
}

impl LocalWater {
    /// Still fresh water with its surface at a level (m).
    pub fn still(level: f64) -> Self {
        Self { density: 1000.0, level, slope: Vector::zeros(), velocity: Vector3::zeros() }
    }

    /// No water: craft fall.
    pub fn none() -> Self {
        Self::still(f64::NEG_INFINITY)
    }
}

/// A body with six degrees of freedom in water.
#[derive(Debug, Clone)]
pub struct Craft {
    /// The middle of the hull's volume, about which everything else is.
    pub(super) origin: Vector3,
    pub(super) mass: f64,
    pub(super) mass_centre: Vector3,
    hull: Box<[HullPart]>,
    pub(super) whole: Displaced,
    /// No part of the hull is farther from the origin.
    reach: f64,
    wet: Inertia,
    dry: Inertia,
    linear_damping: Vector6<f64>,
    quadratic_damping: Vector6<f64>,
    /// More damping than this would turn a speed around within a step.
    most_damping: Vector6<f64>,
    pub(super) thrusters: Box<[Thruster]>,
    /// What the lag leaves of each thruster's difference to its command after half a step.
    pub(super) decays: [f64; MAX_THRUSTERS],
    /// Seconds.
    pub(super) step: f64,
}

#[derive(Debug, Clone)]
struct Inertia {
    matrix: Matrix6<f64>,
    inverse: Matrix6<f64>,
    /// The added mass of a craft that it does not turn across the flow.
    straightened: Option<Vector3>,
}

/// Pose and motion of a craft, and the speeds of its thrusters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CraftState {
    /// Position of the hull's centre of volume.
    pub position: Point3,
    /// Rotation from the craft's frame to the world's.
    pub attitude: UnitQuaternion<f64>,
    /// Velocity of that centre over ground, in the craft's own frame.
    pub velocity: CraftMotion,
    /// Speed of each thruster, as a fraction of its full speed.
    pub shafts: [f64; MAX_THRUSTERS],
}

impl CraftState {
    /// A craft at rest with its own frame at a pose.
    pub fn at_rest(craft: &Craft, pose: &Pose3) -> Self {
        Self {
            position: pose.to_world(craft.middle()),
            attitude: pose.attitude,
            velocity: CraftMotion::STILL,
            shafts: [0.0; MAX_THRUSTERS],
        }
    }

    /// The pose of the craft's own frame.
    pub fn pose(&self, craft: &Craft) -> Pose3 {
        Pose3::new(self.position - self.attitude * craft.origin, self.attitude)
    }

    /// Whether every component is a finite number.
    pub fn is_finite(&self) -> bool {
        let speed = stack(&self.velocity.linear, &self.velocity.angular);
        let place = self.position.iter().chain(self.attitude.coords.iter());
        place.chain(speed.iter()).chain(&self.shafts).all(|part| part.is_finite())
    }
}

impl Craft {
    /// Creates a craft that is integrated in steps of `step` seconds.
    ///
    /// Fails for parameters out of range, for an inertia that no rigid body has, and for a step above 0.1 s.
    pub fn new(spec: &CraftSpec, step: f64) -> Result<Self, ParameterError> {
        spec.validate()?;
        require_positive("step", step)?;
        require("step", step, step <= 0.1, "at most 0.1 s")?;
        let whole: Displaced =
            spec.hull.iter().map(|part| part.displaced(&Vector3::z(), f64::INFINITY)).sum();
        let origin = whole.centre().coords;
        let hull: Box<[HullPart]> = spec.hull.iter().map(|part| part.seen_from(origin)).collect();
        let reach = hull.iter().map(|part| part.centre().coords.norm() + part.half_size().norm());
        let thrusters: Box<[Thruster]> =
            spec.thrusters.iter().map(|thruster| about(thruster, origin)).collect();
        let mass_centre = spec.centre_of_mass.coords - origin;
        let rigid = rigid(spec.mass, &mass_centre, &spec.inertia);
        let wet = rigid + Matrix6::from_diagonal(&Vector6::from(spec.added_mass));
        let straightened = (!spec.munk).then(|| Vector3::from_column_slice(&spec.added_mass[..3]));
        let mut decays = [0.0; MAX_THRUSTERS];
        for (decay, thruster) in decays.iter_mut().zip(&thrusters) {
            *decay = if thruster.lag > 0.0 { math::exp(-0.5 * step / thruster.lag) } else { 0.0 };
        }
        Ok(Self {
            origin,
            mass: spec.mass,
            mass_centre,
            whole: whole_about(whole, origin),
            reach: reach.fold(0.0, f64::max),
            hull,
            most_damping: rigid.diagonal() / step,
            wet: Inertia { straightened, ..Inertia::new(&wet)? },
            dry: Inertia::new(&rigid)?,
            linear_damping: Vector6::from(spec.linear_damping),
            quadratic_damping: Vector6::from(spec.quadratic_damping),
            thrusters,
            decays,
            step,
        })
    }

    /// Integration step (s).
    pub fn step(&self) -> f64 {
        self.step
    }

    /// The thrusters, with positions relative to the hull's centre of volume.
    pub fn thrusters(&self) -> &[Thruster] {
        &self.thrusters
    }

    /// The hull's centre of volume in the frame of the description.
    pub fn middle(&self) -> Point3 {
        Point3::from(self.origin)
    }

    /// Mass and moments of inertia including added mass: kg along the three axes, kg m² about them.
    pub fn inertia(&self) -> [f64; 6] {
        self.wet.matrix.diagonal().into()
    }

    /// Depth of the hull's lowest point below its centre of volume, at an attitude (m).
    pub fn lowest(&self, attitude: &UnitQuaternion<f64>) -> f64 {
        let up = attitude.inverse() * Vector3::z();
        let end = |part: &HullPart| up.dot(&part.centre().coords) - part.reach(&up);
        self.hull.iter().map(end).fold(0.0, f64::min)
    }

    /// Mass (kg).
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Height of the hull's highest point above its centre of volume, at an attitude (m).
    pub fn highest(&self, attitude: &UnitQuaternion<f64>) -> f64 {
        let up = attitude.inverse() * Vector3::z();
        let end = |part: &HullPart| up.dot(&part.centre().coords) + part.reach(&up);
        self.hull.iter().map(end).fold(0.0, f64::max)
    }

    /// Radius around the hull's centre of volume that encloses the hull (m).
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// The parts of the hull, relative to its centre.
    pub fn hull(&self) -> &[HullPart] {
        &self.hull
    }

    /// Change of speed of a point of the craft along a direction, per impulse along it (m/s per N s).
    pub fn mobility(&self, place: &Vector3, direction: &Vector3) -> f64 {
        let push = stack(direction, &place.cross(direction));
        push.dot(&(self.wet.inverse * push))
    }

    /// The motion after an impulse (N s) at a point of the craft, in its frame.
    #[must_use]
    pub fn struck(&self, velocity: &CraftMotion, place: &Vector3, impulse: &Vector3) -> CraftMotion {
        let change = self.wet.inverse * stack(impulse, &place.cross(impulse));
        let (linear, angular) = split(&change);
        CraftMotion { linear: velocity.linear + linear, angular: velocity.angular + angular }
    }

    /// Buoyancy of the submerged hull minus weight (N).
    pub fn reserve(&self, density: f64) -> f64 {
        GRAVITY * (density * self.whole.volume - self.mass)
    }

    /// Damping force and moment at a velocity through the water, each axis by itself: the thrust that keeps that
    /// velocity (N, N m).
    pub fn drag(&self, through_water: &CraftMotion) -> Wrench {
        let speed = stack(&through_water.linear, &through_water.angular);
        split(&self.damping(&speed)).into()
    }

    /// Acceleration relative to the water of a submerged craft, under a force and a moment in addition to inertia
    /// and damping. In a current, the rotation of the craft's frame adds to it.
    pub fn response(&self, through_water: &CraftMotion, wrench: &Wrench) -> CraftMotion {
        let speed = stack(&through_water.linear, &through_water.angular);
        let force = stack(&wrench.force, &wrench.moment);
        let (linear, angular) = split(&self.accelerate(&self.wet, &speed, 1.0, &force));
        CraftMotion { linear, angular }
    }

    /// Weight and buoyancy; zero for a craft without a hull.
    pub fn restoring(&self, state: &CraftState, water: &LocalWater) -> Wrench {
        self.restoring_at(&state.position, &state.attitude.to_rotation_matrix(), water).0
    }

    /// The displaced water, relative to the hull's centre of volume.
    pub fn displaced(&self, state: &CraftState, water: &LocalWater) -> Displaced {
        let attitude = state.attitude.to_rotation_matrix();
        self.displaced_at(&state.position, &attitude, water)
    }

    /// Mechanical energy in still water: kinetic energy, and the potential energy of weight and buoyancy (J); zero
    /// for a craft at rest at the surface that displaces no water. Damping reduces it; only thrusters and moving
    /// water increase it.
    pub fn energy(&self, state: &CraftState, water: &LocalWater) -> f64 {
        let kinetic = self.kinetic(state, water);
        let height = |place: Vector3| (state.position + state.attitude * place).z;
        let weight = self.mass * GRAVITY * height(self.mass_centre);
        let displaced = self.displaced(state, water);
        if displaced.volume == 0.0 {
            return kinetic + weight;
        }
        // Displaced water has come from its place to the surface.
        let raised = water.level - height(displaced.centre().coords);
        kinetic + weight + water.density * GRAVITY * displaced.volume * raised
    }

    pub(super) fn kinetic(&self, state: &CraftState, water: &LocalWater) -> f64 {
        let speed = stack(&state.velocity.linear, &state.velocity.angular);
        0.5 * speed.dot(&(self.inertia_in(water).matrix * speed))
    }

    /// Whether the surface may cross the hull.
    pub(super) fn is_at_surface(&self, state: &CraftState, water: &LocalWater) -> bool {
        (water.level - state.position.z).abs()
            < self.reach * (1.0 + water.slope.x.abs() + water.slope.y.abs())
    }

    pub(super) fn displaced_at(
        &self,
        position: &Point3,
        attitude: &Rotation3<f64>,
        water: &LocalWater,
    ) -> Displaced {
        let depth = water.level - position.z;
        let steep = 1.0 + water.slope.x.abs() + water.slope.y.abs();
        if depth >= self.reach * steep {
            return self.whole;
        }
        if depth <= -self.reach * steep {
            return Displaced::NOTHING;
        }
        let normal = Vector3::new(-water.slope.x, -water.slope.y, 1.0).normalize();
        let (up, level) = (attitude.inverse() * normal, depth * normal.z);
        self.hull.iter().map(|part| part.displaced(&up, level)).sum()
    }

    /// Weight and buoyancy, and how much of the hull is under water. A craft without a hull has neither.
    #[inline]
    fn restoring_at(
        &self,
        position: &Point3,
        attitude: &Rotation3<f64>,
        water: &LocalWater,
    ) -> (Wrench, f64) {
        if self.hull.is_empty() {
            return (Wrench::NONE, 0.0);
        }
        let up = attitude.inverse() * Vector3::new(0.0, 0.0, GRAVITY);
        let displaced = self.displaced_at(position, attitude, water);
        let weight = up * -self.mass;
        let pressure = if water.slope == Vector::zeros() {
            up
        } else {
            attitude.inverse() * Vector3::new(-water.slope.x, -water.slope.y, 1.0) * GRAVITY
        };
        let lift = pressure * water.density;
        let force = weight + lift * displaced.volume;
        let moment = self.mass_centre.cross(&weight) + displaced.moment.cross(&lift);
        (Wrench { force, moment }, displaced.volume)
    }

    /// The acceleration in a state, without thrusters.
    #[inline]
    pub(super) fn rates(
        &self,
        position: &Point3,
        attitude: &Rotation3<f64>,
        speed: &Vector6<f64>,
        wrench: &Vector6<f64>,
        water: &LocalWater,
    ) -> Vector6<f64> {
        let (restoring, volume) = self.restoring_at(position, attitude, water);
        let current = attitude.inverse() * water.velocity;
        let mut relative = *speed;
        relative.fixed_rows_mut::<3>(0).zip_apply(&current, |speed, current| *speed -= current);
        let share = self.share(volume, water.density);
        let total = wrench + stack(&restoring.force, &restoring.moment);
        let mut rates = self.accelerate(self.inertia_in(water), &relative, share, &total);
        let (_, angular) = split(speed);
        let turned = current.cross(&angular);
        rates.fixed_rows_mut::<3>(0).zip_apply(&turned, |rate, turned| *rate += turned);
        rates
    }

    /// The share of the damping that a craft has of which so much is under water: all of it, if that is what
    /// carries it or all there is.
    fn share(&self, volume: f64, density: f64) -> f64 {
        let most = self.whole.volume.min(self.mass / density);
        if volume >= most || most == 0.0 { 1.0 } else { volume / most }
    }

    fn inertia_in(&self, water: &LocalWater) -> &Inertia {
        if water.level == f64::NEG_INFINITY { &self.dry } else { &self.wet }
    }

    #[inline]
    fn accelerate(
        &self,
        inertia: &Inertia,
        speed: &Vector6<f64>,
        share: f64,
        force: &Vector6<f64>,
    ) -> Vector6<f64> {
        let (linear, angular) = split(speed);
        let (impulse, spin) = split(&(inertia.matrix * speed));
        let mut coriolis = stack(&angular.cross(&impulse), &(angular.cross(&spin) + linear.cross(&impulse)));
        if let Some(added) = inertia.straightened {
            // As Fossen's REMUS 100: of the added mass's forces, those of rolling stay.
            let carried = added.component_mul(&linear);
            let (swung, moment) = (Vector3::new(0.0, angular.y, angular.z), linear.cross(&carried));
            coriolis -= stack(&swung.cross(&carried), &Vector3::new(0.0, moment.y, moment.z));
        }
        inertia.inverse * (force - coriolis - self.damping(speed) * share)
    }

    #[inline]
    fn damping(&self, speed: &Vector6<f64>) -> Vector6<f64> {
        let slope = self.linear_damping + self.quadratic_damping.component_mul(&speed.abs());
        slope.inf(&self.most_damping).component_mul(speed)
    }
}

impl From<(Vector3, Vector3)> for Wrench {
    fn from((force, moment): (Vector3, Vector3)) -> Self {
        Self { force, moment }
    }
}

impl Inertia {
    fn new(matrix: &Matrix6<f64>) -> Result<Self, ParameterError> {
        let least = least_pivot(*matrix);
        require("least principal inertia", least, least > 1e-12, "the inertia of a body with some size")?;
        let inverse = matrix.try_inverse().unwrap_or_else(Matrix6::identity);
        Ok(Self { matrix: *matrix, inverse, straightened: None })
    }
}

/// The least pivot of a symmetric matrix: positive if and only if it is positive definite. NaN if there is
/// one.
fn least_pivot(mut matrix: Matrix6<f64>) -> f64 {
    let mut least = f64::INFINITY;
    for k in 0..6 {
        let pivot = matrix[(k, k)];
        if pivot.is_nan() || pivot <= 0.0 {
            return pivot;
        }
        least = least.min(pivot);
        for row in k + 1..6 {
            let factor = matrix[(row, k)] / pivot;
            for column in k..6 {
                matrix[(row, column)] -= factor * matrix[(k, column)];
            }
        }
    }
    least
}

/// The inertia of a rigid body about a place from which the middle of its mass is at `centre`.
fn rigid(mass: f64, centre: &Vector3, inertia: &[[f64; 3]; 3]) -> Matrix6<f64> {
    let cross = centre.cross_matrix();
    let own = Matrix3::from_fn(|row, column| 0.5 * (inertia[row][column] + inertia[column][row]));
    let mut matrix = Matrix6::zeros();
    matrix.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(mass);
    matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-mass * cross));
    matrix.fixed_view_mut::<3, 3>(3, 0).copy_from(&(mass * cross));
    matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(&(own - mass * cross * cross));
    matrix
}

fn whole_about(whole: Displaced, origin: Vector3) -> Displaced {
    Displaced { moment: whole.moment - origin * whole.volume, ..whole }
}

fn about(thruster: &Thruster, origin: Vector3) -> Thruster {
    let place = thruster.place - origin;
    Thruster { place, direction: thruster.direction.normalize(), ..thruster.clone() }
}

#[inline]
pub(super) fn stack(first: &Vector3, last: &Vector3) -> Vector6<f64> {
    Vector6::new(first.x, first.y, first.z, last.x, last.y, last.z)
}

#[inline]
pub(super) fn split(both: &Vector6<f64>) -> (Vector3, Vector3) {
    (Vector3::new(both[0], both[1], both[2]), Vector3::new(both[3], both[4], both[5]))
}
