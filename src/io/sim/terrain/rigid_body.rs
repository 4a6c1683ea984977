use nalgebra::{Quaternion, UnitQuaternion};

use super::undercarriage::{Foot, GRAVITY, Grip, Undercarriage};
use crate::geometry::{Point3, Pose, Pose3, Vector3, math};
use crate::kinematics::PlanarTwist;
use crate::world::HeightField;

/// A robot's body with mass 1 on its feet.
#[derive(Debug, Clone)]
pub(super) struct RigidBody {
    /// Centre of mass and attitude of the body.
    place: Point3,
    attitude: UnitQuaternion<f64>,
    velocity: Vector3,
    /// Angular velocity about each axis of the world (rad/s).
    spin: Vector3,
    /// Impulse of each foot in the last tick: along the ground's normal and two tangents.
    impulses: Vec<Vector3>,
    contacts: Vec<Contact>,
    /// Elastic energy of its feet (J/kg).
    strain: f64,
    /// Whether it did not move in the last tick.
    asleep: bool,
}

/// A foot on the ground, or about to reach it.
#[derive(Debug, Clone)]
struct Contact {
    foot: usize,
    /// Speed along the normal below which the ground presses (m/s).
    least_speed: f64,
    /// Speed by which the ground yields to an impulse, per impulse of a unit mass.
    softness: f64,
    /// Height above the ground at the start of the tick (m).
    gap: f64,
    /// Along the normal, and along the directions in which it is held.
    axes: [Axis; 3],
    held: usize,
    /// The rim's speeds along the latter.
    rim: [f64; 2],
    /// Impulses along the axes.
    impulse: Vector3,
}

/// Effect of an impulse at a foot on a body, along one direction.
#[derive(Debug, Clone, Copy, Default)]
struct Axis {
    direction: Vector3,
    /// Its moment about the centre of mass, and the change of angular velocity.
    moment: Vector3,
    spin: Vector3,
    /// The change of the foot's speed.
    effort: f64,
}

/// Maximum number of solver iterations per contact search of a tick: the first search estimates the positions
/// of the feet, and the second one uses them.
const ROUNDS: [usize; 2] = [10, 60];
/// Change of an impulse at which the iteration ends (m/s).
const SETTLED: f64 = 1e-9;
/// Height above which feet of a body at rest are not considered (m).
const MARGIN: f64 = 2e-3;
/// Depth of a foot above which its point of entry into the ground is computed (m).
const DEEP: f64 = 1.5e-3;
/// Kinetic energy of a body at rest (J/kg): 10 µm/s.
const ASLEEP: f64 = 5e-11;
/// Speed at which a body placed in the ground leaves it (m/s).
const EMERGING: f64 = 0.25;

impl RigidBody {
    /// A body at rest with its robot's frame at a pose.
    pub(super) fn new(carriage: &Undercarriage, pose: &Pose3) -> Self {
        Self {
            place: pose.to_world(Point3::from(carriage.centre)),
            attitude: pose.attitude,
            velocity: Vector3::zeros(),
            spin: Vector3::zeros(),
            impulses: vec![Vector3::zeros(); carriage.feet.len()],
            contacts: Vec::with_capacity(carriage.feet.len()),
            strain: 0.0,
            asleep: false,
        }
    }

    /// Pose of the robot's frame.
    pub(super) fn pose(&self, carriage: &Undercarriage) -> Pose3 {
        Pose3::new(self.place - self.attitude * carriage.centre, self.attitude)
    }

    /// Centre of mass.
    pub(super) fn middle(&self) -> Point3 {
        self.place
    }

    /// Velocity of the centre of mass (m/s).
    pub(super) fn velocity(&self) -> Vector3 {
        self.velocity
    }

    /// Angular velocity about each axis of the world (rad/s).
    pub(super) fn spin(&self) -> Vector3 {
        self.spin
    }

    /// Whether it is at rest and only a drive can move it.
    pub(super) fn is_asleep(&self) -> bool {
        self.asleep
    }

    /// Whether a foot supported it in the last tick.
    pub(super) fn is_carried(&self) -> bool {
        self.impulses.iter().any(|impulse| impulse.x > 0.0)
    }

    /// Energy above that at rest at height 0 (J/kg).
    pub(super) fn energy(&self, carriage: &Undercarriage) -> f64 {
        GRAVITY * self.place.z + self.kinetic(carriage) + self.strain
    }

    fn kinetic(&self, carriage: &Undercarriage) -> f64 {
        0.5 * (self.velocity.norm_squared() + carriage.gyration * self.spin.norm_squared())
    }

    /// Moves the body for `tick` seconds. `drive` is the speed at which its wheels would move it on level
    /// ground.
    pub(super) fn step(
        &mut self,
        ground: &HeightField,
        carriage: &Undercarriage,
        drive: &PlanarTwist,
        tick: f64,
    ) {
        let (before, place, attitude, strain) =
            (self.energy(carriage), self.place, self.attitude, self.strain);
        self.advance(ground, carriage, drive, tick);
        let driven = *drive != PlanarTwist::STOP;
        if !driven && !self.keeps_energy(before, carriage) {
            (self.place, self.attitude, self.strain) = (place, attitude, strain);
        }
        self.asleep = !driven && self.is_carried() && self.kinetic(carriage) < ASLEEP;
    }

    fn advance(&mut self, ground: &HeightField, carriage: &Undercarriage, drive: &PlanarTwist, tick: f64) {
        let free = self.velocity - Vector3::z() * (GRAVITY * tick);
        let (mut velocity, mut spin) = (self.velocity, self.spin);
        for rounds in ROUNDS {
            self.look(ground, carriage, drive, (velocity, spin), tick);
            (velocity, spin) = self.solve(carriage, (free, self.spin), rounds);
        }
        (self.velocity, self.spin) = (velocity, spin);
        self.strain =
            self.contacts.iter().map(|contact| contact.strain(carriage, &(velocity, spin), tick)).sum();
        self.place += velocity * tick;
        self.attitude = UnitQuaternion::new_normalize((turn(spin * tick) * self.attitude).into_inner());
    }

    /// Slows the body down if its energy has increased without a motor, because of a ground edge unknown to
    /// the tick. Returns whether its position is valid.
    fn keeps_energy(&mut self, before: f64, carriage: &Undercarriage) -> bool {
        let (more, kinetic) = (self.energy(carriage) - before, self.kinetic(carriage));
        if more <= 0.0 {
            return true;
        }
        let left = if kinetic > more { (1.0 - more / kinetic).sqrt() } else { 0.0 };
        self.velocity *= left;
        self.spin *= left;
        kinetic >= more
    }

    /// Finds the feet that meet the ground in this tick if the body moves at approximately these speeds.
    fn look(
        &mut self,
        ground: &HeightField,
        carriage: &Undercarriage,
        drive: &PlanarTwist,
        (velocity, spin): (Vector3, Vector3),
        tick: f64,
    ) {
        // Arms and rims are taken at the middle of the tick, so that arcs are exact.
        let middle = turn(spin * (0.5 * tick)) * self.attitude;
        let forward = middle * Vector3::x();
        // A body that hits the ground on one side turns its other side towards it within the tick.
        let margin = MARGIN + tick * self.velocity.norm();
        self.contacts.clear();
        for (number, foot) in carriage.feet.iter().enumerate() {
            let start = self.place + self.attitude * foot.place;
            let arm = middle * foot.place;
            let way = (velocity + spin.cross(&arm)) * tick;
            let Some((normal, gap)) = plane(ground, start, way) else { continue };
            if gap + normal.dot(&way) > margin {
                self.impulses[number] = Vector3::zeros();
                continue;
            }
            let relaxation = foot.relaxation();
            let mut contact = Contact {
                foot: number,
                least_speed: least_speed(gap, tick, relaxation),
                softness: foot.softness / (tick * (tick + relaxation)),
                gap,
                axes: [Axis::default(); 3],
                held: 0,
                rim: [0.0; 2],
                impulse: self.impulses[number],
            };
            contact.hold(foot.grip, (arm, normal), forward, drive, carriage.gyration);
            self.contacts.push(contact);
        }
    }

    /// Speeds at the end of the tick from those without the ground.
    fn solve(
        &mut self,
        carriage: &Undercarriage,
        mut speeds: (Vector3, Vector3),
        rounds: usize,
    ) -> (Vector3, Vector3) {
        for contact in &self.contacts {
            for (axis, impulse) in contact.axes.iter().zip(contact.impulse.iter()) {
                axis.push(*impulse, &mut speeds);
            }
        }
        for _ in 0..rounds {
            let mut change = 0.0_f64;
            for contact in &mut self.contacts {
                change = change.max(contact.press(&mut speeds));
                // No friction without pressure.
                if contact.held > 0 && contact.impulse != Vector3::zeros() {
                    change = change.max(contact.rub(&mut speeds, carriage.friction));
                }
            }
            if change < SETTLED {
                break;
            }
        }
        for contact in &self.contacts {
            self.impulses[contact.foot] = contact.impulse;
        }
        speeds
    }

    /// Displaces the body like an obstacle in the way of its outline, and removes the speed in that
    /// direction.
    pub(super) fn shove(&mut self, aside: crate::geometry::Vector, turned: f64, tick: f64) {
        let way = Vector3::new(aside.x, aside.y, 0.0);
        self.place += way;
        self.attitude = turn(Vector3::z() * turned) * self.attitude;
        self.asleep = false;
        self.velocity += way / tick;
        self.spin.z += turned / tick;
    }

    /// A body at rest on the ground with its robot's frame at a pose in the plane. Beyond the ground it
    /// starts level, at height 0, and falls.
    pub(super) fn resting(ground: &HeightField, carriage: &Undercarriage, pose: Pose, tick: f64) -> Self {
        let (level, slope) = ground.height_and_gradient(pose.position()).unwrap_or_default();
        let forward = Vector3::new(pose.forward().x, pose.forward().y, slope.dot(&pose.forward()));
        let left = Vector3::new(-slope.x, -slope.y, 1.0).cross(&forward).normalize();
        let pitch = -math::atan(forward.z);
        let roll = math::asin((left.z / math::cos(pitch)).clamp(-1.0, 1.0));
        let start = Point3::new(pose.x, pose.y, level);
        // Where it finds no rest, it begins on its lowest feet, and tips over or slides.
        let mut body = Self::new(carriage, &Pose3::from_angles(start, roll, pitch, pose.heading));
        body.place.z += body.depth(ground, carriage);
        body.settled(ground, carriage, tick).unwrap_or(body)
    }

    /// Depth of the deepest foot below the ground (m), at least 0.
    fn depth(&self, ground: &HeightField, carriage: &Undercarriage) -> f64 {
        let below = |foot: &Foot| {
            let at = self.place + self.attitude * foot.place;
            ground.height(at.xy()).map_or(0.0, |level| level - at.z)
        };
        carriage.feet.iter().map(below).fold(0.0, f64::max)
    }

    /// This body at rest, to which it has come without sliding; `None` if it finds no rest.
    fn settled(&self, ground: &HeightField, carriage: &Undercarriage, tick: f64) -> Option<Self> {
        let held = Undercarriage { friction: f64::MAX, ..carriage.clone() };
        let goal = self.pose(carriage).position.xy();
        let mut body = self.clone();
        for _ in 0..MOST_SETTLING {
            let before = body.place;
            body.advance(ground, &held, &PlanarTwist::STOP, tick);
            let aside = goal - body.pose(carriage).position.xy();
            body.place += Vector3::new(aside.x, aside.y, 0.0);
            if (body.place - before).norm() < 1e-9 && body.is_carried() {
                (body.velocity, body.spin) = (Vector3::zeros(), Vector3::zeros());
                return Some(body);
            }
            body.velocity *= CALMING;
            body.spin *= CALMING;
        }
        None
    }
}

/// Largest number of ticks in which a placed body comes to rest.
const MOST_SETTLING: u32 = 400;
/// Fraction of its speed that remains after each of these ticks.
const CALMING: f64 = 0.8;

/// Speed along the normal below which the ground presses a foot at a height above it (m/s).
///
/// The ground is a spring and a damper under each foot, integrated by backward Euler: a foot under the
/// surface returns with the time constant of both, and one above it is stopped when it arrives.
fn least_speed(gap: f64, tick: f64, relaxation: f64) -> f64 {
    if gap > 0.0 { -gap / tick } else { (-gap / (tick + relaxation)).min(EMERGING) }
}

/// Normal of the ground where a foot arrives on its way, and the foot's initial distance from that plane;
/// `None` beyond the ground.
///
/// It goes through the ground's place at the end, but lies as the ground does in the middle of the way: as
/// arms and rims do, so that halving the tick quarters the error and does not halve it.
fn plane(ground: &HeightField, start: Point3, way: Vector3) -> Option<(Vector3, f64)> {
    let at = |end: Point3| {
        let (level, slope) = ground.height_and_gradient(end.xy())?;
        let middle = ground.gradient(nalgebra::center(&start, &end).xy());
        let slope = middle.unwrap_or(slope);
        let normal = Vector3::new(-slope.x, -slope.y, 1.0).normalize();
        let below = start.z - level - slope.dot(&(start.xy() - end.xy()));
        Some((normal, below * normal.z))
    };
    let (normal, gap) = at(start + way)?;
    if gap + normal.dot(&way) > -DEEP {
        return Some((normal, gap));
    }
    // The ground under the end point may be behind a face that the foot runs into.
    let clear = ground.height(start.xy()).map_or(0.0, |level| start.z - level);
    let length = way.norm();
    if clear < -DEEP || length == 0.0 {
        return Some((normal, gap));
    }
    let lifted = start + Vector3::z() * (DEEP - clear.min(0.0));
    let direction = way / length;
    let hit = ground.cast_ray(lifted, direction, length + DEEP);
    if hit.is_finite() { at(lifted + direction * (hit + 1e-9)) } else { Some((normal, gap)) }
}

/// Rotation about a vector by its length.
fn turn(by: Vector3) -> UnitQuaternion<f64> {
    let angle = by.norm();
    if angle == 0.0 {
        return UnitQuaternion::identity();
    }
    let (sin, cos) = math::sin_cos(0.5 * angle);
    let axis = by * (sin / angle);
    UnitQuaternion::new_unchecked(Quaternion::new(cos, axis.x, axis.y, axis.z))
}

impl Axis {
    /// The axis along a direction at a foot with a lever arm from the centre of mass.
    fn new(direction: Vector3, arm: &Vector3, gyration: f64) -> Self {
        let moment = arm.cross(&direction);
        let effort = 1.0 + moment.norm_squared() / gyration;
        Self { direction, moment, spin: moment / gyration, effort }
    }

    /// Speed of a foot along the axis (m/s).
    #[inline]
    fn speed(&self, (velocity, spin): &(Vector3, Vector3)) -> f64 {
        self.direction.dot(velocity) + self.moment.dot(spin)
    }

    #[inline]
    fn push(&self, impulse: f64, (velocity, spin): &mut (Vector3, Vector3)) {
        *velocity += self.direction * impulse;
        *spin += self.spin * impulse;
    }
}

impl Contact {
    /// Finds the directions in which a foot is held, and how fast its rim moves along them.
    fn hold(
        &mut self,
        grip: Grip,
        (arm, normal): (Vector3, Vector3),
        forward: Vector3,
        drive: &PlanarTwist,
        gyration: f64,
    ) {
        let along = forward - normal * forward.dot(&normal);
        // If the robot's nose points along the normal, any direction is valid.
        let along = along
            .try_normalize(1e-9)
            .unwrap_or_else(|| Vector3::z().cross(&normal).try_normalize(1e-9).unwrap_or_else(Vector3::x));
        let left = normal.cross(&along);
        let rim = grip.rim_speed(drive);
        let single = |axis: crate::geometry::Vector| (along * axis.x + left * axis.y, axis.dot(&rim));
        let mut tangents = [Vector3::zeros(); 2];
        match grip {
            Grip::Free => {}
            Grip::Driven(_) | Grip::Body => {
                (tangents, self.held, self.rim) = ([along, left], 2, [rim.x, rim.y]);
            }
            Grip::Rolling(_) => {
                let rolls = rim.try_normalize(1e-6).unwrap_or_else(crate::geometry::Vector::x);
                let across = crate::geometry::Vector::new(-rolls.y, rolls.x);
                (tangents[0], self.rim[0]) = single(across);
                self.held = 1;
            }
            Grip::Roller(_, axis) => {
                (tangents[0], self.rim[0]) = single(axis);
                self.held = 1;
            }
        }
        self.axes[0] = Axis::new(normal, &arm, gyration);
        for (axis, tangent) in self.axes[1..].iter_mut().zip(tangents).take(self.held) {
            *axis = Axis::new(tangent, &arm, gyration);
        }
        let held = [self.held > 0, self.held > 1].map(|held| f64::from(u8::from(held)));
        self.impulse.component_mul_assign(&Vector3::new(1.0, held[0], held[1]));
    }

    /// Elastic energy at the end of the tick (J/kg).
    fn strain(&self, carriage: &Undercarriage, speeds: &(Vector3, Vector3), tick: f64) -> f64 {
        let depth = (self.gap + self.axes[0].speed(speeds) * tick).min(0.0);
        0.5 * depth * depth / carriage.feet[self.foot].softness
    }

    /// Applies the normal force required by the foot's speed; returns the change of the impulse.
    #[inline]
    fn press(&mut self, speeds: &mut (Vector3, Vector3)) -> f64 {
        let (axis, softness) = (&self.axes[0], self.softness);
        let missing = self.least_speed - axis.speed(speeds) - softness * self.impulse.x;
        let pressed = (self.impulse.x + missing / (axis.effort + softness)).max(0.0);
        let change = pressed - self.impulse.x;
        if change != 0.0 {
            self.impulse.x = pressed;
            axis.push(change, speeds);
        }
        change.abs()
    }

    /// Applies the friction required by the foot's sliding, up to its limit; returns the change of the
    /// impulse.
    #[inline]
    fn rub(&mut self, speeds: &mut (Vector3, Vector3), friction: f64) -> f64 {
        let limit = friction * self.impulse.x;
        let [_, along, left] = &self.axes;
        let (before_y, before_z) = (self.impulse.y, self.impulse.z);
        let mut y = before_y - (along.speed(speeds) - self.rim[0]) / along.effort;
        let mut z = 0.0;
        if self.held > 1 {
            z = before_z - (left.speed(speeds) - self.rim[1]) / left.effort;
        }
        let squared = y * y + z * z;
        if squared > limit * limit {
            let share = limit / squared.sqrt();
            (y, z) = (y * share, z * share);
        }
        (self.impulse.y, self.impulse.z) = (y, z);
        let (dy, dz) = (y - before_y, z - before_z);
        along.push(dy, speeds);
        if self.held > 1 {
            left.push(dz, speeds);
        }
        dy.abs().max(dz.abs())
    }
}
