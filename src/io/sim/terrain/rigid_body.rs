use nalgebra::{Quaternion, UnitQuaternion};

use super::contact::{Contact, Load, Meeting, Motion, Ride, solve};
use super::undercarriage::{Foot, GRAVITY, Undercarriage};
use crate::geometry::{Point3, Pose, Pose3, Vector, Vector3, angle_difference, math};
use crate::io::sim::shove::stopping;
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
    /// Forces at each foot in the last tick.
    loads: Vec<Load>,
    contacts: Vec<Contact>,
    /// Elastic energy of its feet (J/kg).
    strain: f64,
    /// Whether it did not move in the last tick.
    asleep: bool,
}

/// Largest number of searches for contacts in a tick.
const SEARCHES: usize = 2;
/// Difference from the expected position at the end of a tick that needs no further search (m). A curve of
/// 2 m ends 2 µm elsewhere than with two searches always.
const AS_EXPECTED: f64 = 1e-5;
/// Height above which feet of a body at rest are not considered (m).
const MARGIN: f64 = 2e-3;
/// Depth of a foot above which its point of entry into the ground is computed (m).
const DEEP: f64 = 1.5e-3;
/// Kinetic energy of a body at rest (J/kg): 10 µm/s.
const ASLEEP: f64 = 5e-11;

impl RigidBody {
    /// A body at rest with its robot's frame at a pose.
    pub(super) fn new(carriage: &Undercarriage, pose: &Pose3) -> Self {
        Self {
            place: pose.to_world(Point3::from(carriage.centre)),
            attitude: pose.attitude,
            velocity: Vector3::zeros(),
            spin: Vector3::zeros(),
            loads: vec![Load::default(); carriage.feet.len()],
            contacts: Vec::with_capacity(carriage.feet.len()),
            strain: 0.0,
            asleep: false,
        }
    }

    /// A body at rest with its robot's frame at a pose, or so far above it that no foot is in the ground.
    pub(super) fn above(ground: &HeightField, carriage: &Undercarriage, pose: &Pose3) -> Self {
        let mut body = Self::new(carriage, pose);
        body.place.z += body.depth(ground, carriage);
        body
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
        self.loads.iter().any(|load| load.pressure > 0.0)
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
        let radius = carriage.gyration.sqrt();
        let mut motion = stacked(&self.velocity, &(self.spin * radius));
        let free = motion - stacked(&(Vector3::z() * (GRAVITY * tick)), &Vector3::zeros());
        // The first search expects the body to move on as it did. If it does not, the second one knows more.
        for _ in 0..SEARCHES {
            let (velocity, spin) = split(&motion);
            self.look(ground, carriage, drive, (velocity, spin / radius), tick);
            let expected = motion;
            motion = solve(&mut self.contacts, &free, expected);
            for contact in &self.contacts {
                self.loads[contact.foot] = contact.load;
            }
            if (motion - expected).norm() * tick < AS_EXPECTED {
                break;
            }
        }
        let strain = |contact: &Contact| contact.strain(&carriage.feet[contact.foot], &motion, tick);
        self.strain = self.contacts.iter().map(strain).sum();
        let (velocity, spin) = split(&motion);
        (self.velocity, self.spin) = (velocity, spin / radius);
        self.place += self.velocity * tick;
        self.attitude = UnitQuaternion::new_normalize((turn(self.spin * tick) * self.attitude).into_inner());
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
        let start = self.attitude.to_rotation_matrix();
        let middle = (turn(spin * (0.5 * tick)) * self.attitude).to_rotation_matrix();
        let ride = Ride {
            forward: middle * Vector3::x(),
            drive,
            friction: carriage.friction,
            per_radius: 1.0 / carriage.gyration.sqrt(),
            tick,
        };
        // A body that hits the ground on one side turns its other side towards it within the tick.
        let margin = MARGIN + tick * self.velocity.norm();
        self.contacts.clear();
        for (number, foot) in carriage.feet.iter().enumerate() {
            let arm = middle * foot.place;
            let way = (velocity + spin.cross(&arm)) * tick;
            let Some((normal, gap)) = plane(ground, self.place + start * foot.place, way, margin) else {
                self.loads[number] = Load::default();
                continue;
            };
            let meeting = Meeting { arm, normal, gap };
            self.contacts.push(Contact::new(number, foot, &meeting, &ride, self.loads[number]));
        }
    }

    /// Displaces the body like an obstacle in the way of its outline, and removes the speed that led there.
    pub(super) fn shove(&mut self, aside: Vector, turned: f64, tick: f64) {
        let way = Vector3::new(aside.x, aside.y, 0.0);
        self.place += way;
        self.attitude = turn(Vector3::z() * turned) * self.attitude;
        self.asleep = false;
        self.velocity += stopping(&self.velocity, &(way / tick));
        self.spin += stopping(&self.spin, &(Vector3::z() * (turned / tick)));
    }

    /// Throws the body.
    #[cfg(test)]
    pub(super) fn throw(&mut self, velocity: Vector3, spin: Vector3) {
        (self.velocity, self.spin) = (velocity, spin);
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
        let body = Self::above(ground, carriage, &Pose3::from_angles(start, roll, pitch, pose.heading));
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
        let goal = self.pose(carriage).pose();
        let mut body = self.clone();
        for _ in 0..MOST_SETTLING {
            body.advance(ground, &held, &PlanarTwist::STOP, tick);
            let still = body.velocity.norm() * tick < 1e-9;
            // A tilt about the centre of mass moves the robot's origin aside, and may turn it.
            let now = body.pose(carriage).pose();
            body.attitude = turn(Vector3::z() * angle_difference(goal.heading, now.heading)) * body.attitude;
            let aside = goal.position() - body.pose(carriage).position.xy();
            body.place += Vector3::new(aside.x, aside.y, 0.0);
            if still && aside.norm() < 1e-9 && body.is_carried() {
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

/// Normal of the ground where a foot arrives on its way, and the foot's initial distance from that plane;
/// `None` if it arrives more than `margin` above the ground, or beyond it.
///
/// It goes through the ground's place at the end, but lies as the ground does in the middle of the way: as
/// arms and rims do, so that halving the tick quarters the error and does not halve it.
fn plane(ground: &HeightField, start: Point3, way: Vector3, margin: f64) -> Option<(Vector3, f64)> {
    let at = |end: Point3| {
        let level = ground.height(end.xy())?;
        if end.z - level > margin {
            return None;
        }
        let middle = ground.gradient(nalgebra::center(&start, &end).xy());
        let slope = middle.or_else(|| ground.gradient(end.xy()))?;
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

/// A motion of two parts.
fn stacked(velocity: &Vector3, spin: &Vector3) -> Motion {
    Motion::new(velocity.x, velocity.y, velocity.z, spin.x, spin.y, spin.z)
}

/// Parts of a motion.
fn split(motion: &Motion) -> (Vector3, Vector3) {
    (motion.fixed_rows::<3>(0).into_owned(), motion.fixed_rows::<3>(3).into_owned())
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
