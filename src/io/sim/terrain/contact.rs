use nalgebra::{Matrix6, Vector2, Vector6};

use super::undercarriage::{Foot, Grip};
use crate::geometry::{Vector, Vector3};
use crate::kinematics::PlanarTwist;

/// Velocity of a body of mass 1, and its angular velocity times its radius of gyration. An impulse at a point
/// changes it by the same vector whose product with it is the point's speed.
pub(super) type Motion = Vector6<f64>;

/// A foot on the ground, or about to reach it.
#[derive(Debug, Clone)]
pub(super) struct Contact {
    pub(super) foot: usize,
    /// Height above the ground at the start of the tick (m).
    gap: f64,
    /// Speed along the normal below which the ground presses (m/s).
    least_speed: f64,
    /// Impulse on a unit mass per speed by which the ground yields.
    firmness: f64,
    /// Coefficient of friction.
    friction: f64,
    normal: Motion,
    /// Directions in which it is held; zero if it is not.
    tangents: [Motion; 2],
    /// The rim's speeds along them (m/s).
    rim: Vector2<f64>,
    /// Impulse that stops a slide, per speed of it, at most.
    ease: f64,
    guess: Load,
    pub(super) load: Load,
    /// Speed at which it slides (m/s).
    slide: Vector2<f64>,
    law: Law,
}

/// Impulses on a foot in a tick: along the normal, and along the directions in which it is held.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Load {
    pub(super) pressure: f64,
    friction: Vector2<f64>,
}

/// Friction near a guess as a linear function: `share` of its limit, less `hardness` times the speed of the
/// slide across it. The share is zero, and any slide is across it, where friction holds the foot.
#[derive(Debug, Clone, Copy, Default)]
struct Law {
    share: Vector2<f64>,
    hardness: f64,
}

/// Where and how a foot meets the ground: its arm from the centre of mass, the ground's normal and its height
/// above the ground (m).
#[derive(Debug, Clone, Copy)]
pub(super) struct Meeting {
    pub(super) arm: Vector3,
    pub(super) normal: Vector3,
    pub(super) gap: f64,
}

/// What all feet of a body have in common in a tick.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ride<'a> {
    /// The robot's direction, and the speed of its drive.
    pub(super) forward: Vector3,
    pub(super) drive: &'a PlanarTwist,
    pub(super) friction: f64,
    /// Inverse of the radius of gyration (1/m).
    pub(super) per_radius: f64,
    pub(super) tick: f64,
}

/// Steps of Newton's method in which almost all ticks are solved.
const MOST_STEPS: usize = 10;
/// Coefficient of friction up to which it is used: with much more, a body can wedge itself between its feet,
/// which solves the equations too. Up to 4, no run on hills did.
const MOST_FRICTION: f64 = 5.0;
/// Change of a speed after which no further step is made (m/s), as that one would be about its square, and
/// impulse on a unit mass by which friction may exceed its limit.
const LAST_STEP: f64 = 1e-5;
/// Rounds over all feet for the others.
const MOST_ROUNDS: usize = 60;
/// Change of a speed at which the iteration ends (m/s).
const SETTLED: f64 = 1e-7;
/// Sliding speed per impulse of a foot that friction holds, far below any speed that matters.
const CREEP: f64 = 1e-6;
/// Speed at which a body placed in the ground leaves it (m/s).
const EMERGING: f64 = 0.25;

/// Motion of a body at the end of a tick from that without the ground, `free`; `start` is a guess.
pub(super) fn solve(contacts: &mut [Contact], free: &Motion, start: Motion) -> Motion {
    let wedges = contacts.iter().any(|contact| contact.friction > MOST_FRICTION);
    let found = if wedges { None } else { newton(contacts, free, start) };
    found.unwrap_or_else(|| relaxed(contacts, free))
}

/// Newton's method on the six equations of the body: each foot's impulse is a function of the motion, smooth
/// but for the places where it lifts off, or begins to slide. Whether it slides is judged by its friction and
/// its slide together, as in an augmented Lagrangian (Alart and Curnier 1991). `None` if it does not end
/// soon.
fn newton(contacts: &mut [Contact], free: &Motion, start: Motion) -> Option<Motion> {
    let mut motion = start;
    for contact in contacts.iter_mut() {
        contact.move_at(&motion);
    }
    for _ in 0..MOST_STEPS {
        let (mut excess, mut stiffness) = (motion - free, Matrix6::identity());
        for contact in contacts.iter_mut() {
            contact.resist(&mut excess, &mut stiffness);
        }
        let change = stiffness.lu().solve(&excess)?;
        motion -= change;
        for contact in contacts.iter_mut() {
            contact.move_at(&motion);
            contact.load.friction = contact.friction_by_law();
        }
        if change.amax() < LAST_STEP && contacts.iter().all(Contact::is_within_limit) {
            return Some(motion);
        }
    }
    None
}

/// One foot after the other, in rounds: slower, but it does not go round in circles (projected Gauss-Seidel).
fn relaxed(contacts: &mut [Contact], free: &Motion) -> Motion {
    let mut motion = *free;
    for contact in contacts.iter_mut() {
        contact.load = contact.guess;
        contact.load.friction = contact.held_back(contact.load.friction);
        motion += contact.impulse();
    }
    for _ in 0..MOST_ROUNDS {
        let before = motion;
        for contact in contacts.iter_mut() {
            contact.relax(&mut motion);
        }
        if (motion - before).amax() < SETTLED {
            break;
        }
    }
    motion
}

impl Contact {
    /// The contact of a foot, the `number`th one; `guess` are its impulses in the last tick.
    pub(super) fn new(number: usize, foot: &Foot, at: &Meeting, ride: &Ride, guess: Load) -> Self {
        let (tangents, rim) = held(foot.grip, &at.normal, ride);
        let axis = |direction: Vector3| {
            let moment = at.arm.cross(&direction) * ride.per_radius;
            Motion::new(direction.x, direction.y, direction.z, moment.x, moment.y, moment.z)
        };
        let tangents = tangents.map(axis);
        Self {
            foot: number,
            gap: at.gap,
            least_speed: least_speed(at.gap, ride.tick, foot.relaxation),
            firmness: ride.tick * (ride.tick + foot.relaxation) / foot.softness,
            friction: ride.friction,
            normal: axis(at.normal),
            tangents,
            rim,
            ease: 1.0 / (1.0 + tangents[0].norm_squared() + tangents[1].norm_squared()),
            guess,
            load: guess,
            slide: Vector2::zeros(),
            law: Law::default(),
        }
    }

    /// Takes over the pressure and the slide at a motion of the body.
    #[inline]
    fn move_at(&mut self, motion: &Motion) {
        self.load.pressure = self.pressure(motion);
        self.slide = self.slide(motion);
    }

    /// Subtracts the foot's impulse from `excess`, and adds what the foot resists a change of the body's
    /// motion to `stiffness`.
    #[inline]
    fn resist(&mut self, excess: &mut Motion, stiffness: &mut Matrix6<f64>) {
        let pressure = self.load.pressure;
        if pressure == 0.0 && self.load.friction == Vector2::zeros() {
            self.law = Law::default();
            return;
        }
        self.law = self.law();
        let Law { share, hardness } = self.law;
        let [ahead, left] = &self.tangents;
        let force = self.friction_by_law();
        *excess -= self.normal * pressure + ahead * force.x + left * force.y;
        if pressure > 0.0 {
            // The limit of friction rises with the pressure.
            let along = self.normal + (ahead * share.x + left * share.y) * self.friction;
            add_product(stiffness, &along, &(self.normal * self.firmness));
        }
        if self.law.holds() {
            add_product(stiffness, ahead, &(ahead * hardness));
            add_product(stiffness, left, &(left * hardness));
        } else {
            let across = left * share.x - ahead * share.y;
            add_product(stiffness, &across, &(across * hardness));
        }
    }

    /// Friction near the present one. A foot that slides is held against its slide only.
    fn law(&self) -> Law {
        let (limit, trial) = (self.friction * self.load.pressure, self.trial(&self.slide));
        let size = trial.norm();
        if size <= limit {
            return Law { share: Vector2::zeros(), hardness: 1.0 / CREEP };
        }
        Law { share: trial / size, hardness: limit * self.ease / (size - limit) }
    }

    /// Whether friction keeps within its limit: the linear law of the last step need not. A body at rest
    /// hardly moves, however much holds it.
    fn is_within_limit(&self) -> bool {
        self.load.friction.norm() < self.friction * self.load.pressure + LAST_STEP
    }

    /// The friction that a slide asks for, without its limit.
    #[inline]
    fn trial(&self, slide: &Vector2<f64>) -> Vector2<f64> {
        self.load.friction - slide * self.ease
    }

    /// Friction up to its limit.
    fn held_back(&self, friction: Vector2<f64>) -> Vector2<f64> {
        friction.cap_magnitude(self.friction * self.load.pressure)
    }

    /// Effect of the foot on a body.
    fn impulse(&self) -> Motion {
        let Load { pressure, friction } = self.load;
        self.normal * pressure + self.tangents[0] * friction.x + self.tangents[1] * friction.y
    }

    /// Replaces the foot's impulse by the one that its speed requires.
    fn relax(&mut self, motion: &mut Motion) {
        let (before, yielding) = (self.impulse(), 1.0 / self.firmness);
        let missing = self.least_speed - self.normal.dot(motion) - self.load.pressure * yielding;
        let change = missing / (self.normal.norm_squared() + yielding);
        self.load.pressure = (self.load.pressure + change).max(0.0);
        self.load.friction = self.held_back(self.trial(&self.slide(motion)));
        *motion += self.impulse() - before;
    }

    /// Friction that the linear law has at the present pressure and slide.
    #[inline]
    fn friction_by_law(&self) -> Vector2<f64> {
        let Law { share, hardness } = self.law;
        let across = self.slide - share * share.dot(&self.slide);
        share * (self.friction * self.load.pressure) - across * hardness
    }

    #[inline]
    fn pressure(&self, motion: &Motion) -> f64 {
        ((self.least_speed - self.normal.dot(motion)) * self.firmness).max(0.0)
    }

    #[inline]
    fn slide(&self, motion: &Motion) -> Vector2<f64> {
        let [ahead, left] = &self.tangents;
        Vector2::new(ahead.dot(motion), left.dot(motion)) - self.rim
    }

    /// Elastic energy of the foot at the end of the tick (J/kg).
    pub(super) fn strain(&self, foot: &Foot, motion: &Motion, tick: f64) -> f64 {
        let depth = (self.gap + self.normal.dot(motion) * tick).min(0.0);
        0.5 * depth * depth / foot.softness
    }
}

impl Law {
    fn holds(&self) -> bool {
        self.share == Vector2::zeros()
    }
}

/// Adds `column * row^T`.
#[inline]
fn add_product(sums: &mut Matrix6<f64>, column: &Motion, row: &Motion) {
    for (sums, factor) in sums.data.0.iter_mut().zip(row) {
        for (sum, value) in sums.iter_mut().zip(column) {
            *sum += value * factor;
        }
    }
}

/// Directions in which a foot is held, and how fast its rim moves along them.
fn held(grip: Grip, normal: &Vector3, ride: &Ride) -> ([Vector3; 2], Vector2<f64>) {
    let along = ride.forward - normal * ride.forward.dot(normal);
    // If the robot's nose points along the normal, any direction is valid.
    let along = along
        .try_normalize(1e-9)
        .unwrap_or_else(|| Vector3::z().cross(normal).try_normalize(1e-9).unwrap_or_else(Vector3::x));
    let left = normal.cross(&along);
    let rim = grip.rim_speed(ride.drive);
    let single = |axis: Vector| {
        ([along * axis.x + left * axis.y, Vector3::zeros()], Vector2::new(axis.dot(&rim), 0.0))
    };
    match grip {
        Grip::Free => ([Vector3::zeros(); 2], Vector2::zeros()),
        Grip::Driven(_) | Grip::Body => ([along, left], rim),
        Grip::Rolling(_) => {
            let rolls = rim.try_normalize(1e-6).unwrap_or_else(Vector::x);
            single(Vector::new(-rolls.y, rolls.x))
        }
        Grip::Roller(_, axis) => single(axis),
    }
}

/// Speed along the normal below which the ground presses a foot at a height above it (m/s).
///
/// The ground is a spring and a damper under each foot, integrated by backward Euler: a foot under the
/// surface returns with the time constant of both, and one above it is stopped when it arrives.
fn least_speed(gap: f64, tick: f64, relaxation: f64) -> f64 {
    if gap > 0.0 { -gap / tick } else { (-gap / (tick + relaxation)).min(EMERGING) }
}
