use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt;

use nalgebra::Unit;

use rapier2d_f64::math::Rotation;
use rapier2d_f64::prelude::{
    ColliderBuilder, Group, ImpulseJointHandle, InteractionGroups, InteractionTestMode, JointAxesMask,
    JointAxis, MotorModel, PhysicsWorld, Pose as Placement, RevoluteJointBuilder, RigidBodyBuilder,
    RigidBodyHandle, RigidBodySet, Vector,
};

use super::LIMBS;
use super::servo::Servo;
use super::spec::StarmanSpec;
use crate::geometry::{math, units};
use crate::io::sim::lockstep::Ticking;

/// Positions of a Starman's parts in the vertical plane: x along the floor, y up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StarmanPosture {
    /// Middle of the body: position along the floor and height (m).
    pub body: (f64, f64),
    /// Roll angle of the body, counter-clockwise (rad).
    pub roll: f64,
    /// Angle of each limb from its middle position (rad).
    pub limbs: [f64; LIMBS],
    /// Hinge and tip of each limb.
    pub segments: [[(f64, f64); 2]; LIMBS],
}

/// Ground truth of a Starman.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StarmanTruth {
    /// Positions of its parts.
    pub posture: StarmanPosture,
    /// Widest gap of a hinge (m); 0 with a perfect solver.
    pub hinge_gap: f64,
    /// Kinetic and potential energy (J); the latter is zero for a body with its middle on the floor.
    pub energy: f64,
    /// Physics steps so far.
    pub steps: u64,
}

/// The body and its limbs on the floor, moved by the engine.
pub(super) struct Figure {
    world: PhysicsWorld,
    body: RigidBodyHandle,
    limbs: [Limb; LIMBS],
    spec: StarmanSpec,
    powered: bool,
    steps: u64,
}

struct Limb {
    part: RigidBodyHandle,
    /// Direction of its middle position in the body's frame.
    middle: Rotation,
    joint: ImpulseJointHandle,
    servo: Servo,
}

/// Natural frequency of a displaced servo (1/s). With much stiffer servos, two supporting limbs press against
/// each other so hard that the time step decides which of them slips.
const SERVO_FREQUENCY: f64 = 25.0;
/// Largest angle by which a contact may throw a limb within a step (rad).
const LIMIT_MARGIN: f64 = 0.05;

impl Figure {
    /// A figure that stands on two limbs, with the first one up.
    pub(super) fn new(spec: &StarmanSpec) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::new(0.0, -units::GRAVITY);
        let settings = &mut world.integration_parameters;
        settings.dt = spec.time_step;
        // Solver tolerances are fractions of this length.
        settings.length_unit = spec.body_radius;
        // Two passes of four sweeps with friction in each: the cheapest setting without creeping limbs, so
        // that a gait covers the same distance with half the time step.
        settings.num_solver_iterations = 2;
        settings.num_internal_pgs_iterations = 4;
        settings.friction_in_bias_pass = true;
        let floor = ColliderBuilder::halfspace(Unit::new_unchecked(Vector::Y)).friction(spec.friction);
        world.colliders.insert(floor.collision_groups(groups(FLOOR, PART)));
        let centre = Vector::new(0.0, standing_height(spec));
        let body = RigidBodyBuilder::dynamic().translation(centre).can_sleep(false);
        let shape = ColliderBuilder::ball(spec.body_radius).mass(spec.body_mass).friction(spec.friction);
        let (body, _) = world.insert(body, shape.collision_groups(groups(PART, FLOOR)));
        let limbs = std::array::from_fn(|i| attach(&mut world, body, centre, spec, i));
        Self { world, body, limbs, spec: *spec, powered: true, steps: 0 }
    }

    /// Sets the target of a servo, from -1 to 1.
    pub(super) fn send(&mut self, limb: usize, position: f64) {
        self.limbs[limb].servo.send(position * self.spec.servo_range);
    }

    /// Switches the servos on or off; when off, the limbs swing freely within their limits.
    #[cfg(test)]
    pub(super) fn power(&mut self, on: bool) {
        self.powered = on;
    }

    /// Advances by one time step.
    fn step(&mut self) {
        let spec = &self.spec;
        let stiffness = (TAU * SERVO_FREQUENCY) * (TAU * SERVO_FREQUENCY);
        // Critical damping: no overshoot.
        let damping = 2.0 * TAU * SERVO_FREQUENCY;
        for limb in &mut self.limbs {
            let (angle, rate) = limb.servo.advance(spec.servo_speed, spec.time_step);
            let Some(joint) = self.world.impulse_joints.get_mut(limb.joint, false) else { continue };
            let torque = if self.powered { spec.servo_torque } else { 0.0 };
            joint.data.set_motor(JointAxis::AngX, angle, rate, stiffness, damping);
            joint.data.set_motor_max_force(JointAxis::AngX, torque);
            let near = nears_limit(&self.world.bodies, self.body, limb, spec);
            joint.data.limit_axes = if near { JointAxesMask::ANG_X } else { JointAxesMask::empty() };
        }
        self.world.step();
        self.steps += 1;
    }

    /// Position of the body's middle along the floor.
    pub(super) fn travelled(&self) -> f64 {
        self.world.bodies[self.body].translation().x
    }

    /// Speed of the body's middle along the floor (m/s).
    pub(super) fn speed(&self) -> f64 {
        self.world.bodies[self.body].linvel().x
    }

    pub(super) fn truth(&self) -> StarmanTruth {
        StarmanTruth {
            posture: self.posture(),
            hinge_gap: self.limbs.iter().enumerate().map(|(i, limb)| self.gap(i, limb)).fold(0.0, f64::max),
            energy: self.energy(),
            steps: self.steps,
        }
    }

    fn posture(&self) -> StarmanPosture {
        let body = self.world.bodies[self.body].position();
        let pair = |v: Vector| (v.x, v.y);
        let roll = body.rotation.angle();
        StarmanPosture {
            body: pair(body.translation),
            roll,
            limbs: std::array::from_fn(|i| {
                let limb = self.world.bodies[self.limbs[i].part].position();
                crate::geometry::normalize_angle(limb.rotation.angle() - roll - spread(i))
            }),
            segments: std::array::from_fn(|i| {
                let limb = self.world.bodies[self.limbs[i].part].position();
                let half = Vector::new(0.5 * self.spec.limb_length, 0.0);
                [pair(*limb * -half), pair(*limb * half)]
            }),
        }
    }

    fn gap(&self, i: usize, limb: &Limb) -> f64 {
        let body = self.world.bodies[self.body].position();
        let part = self.world.bodies[limb.part].position();
        let on_body = *body * rim(&self.spec, i);
        let on_limb = *part * Vector::new(-0.5 * self.spec.limb_length, 0.0);
        math::hypot(on_body.x - on_limb.x, on_body.y - on_limb.y)
    }

    fn energy(&self) -> f64 {
        let handles = self.limbs.iter().map(|limb| limb.part).chain([self.body]);
        handles
            .map(|handle| {
                let part = &self.world.bodies[handle];
                part.kinetic_energy() + part.mass() * units::GRAVITY * part.translation().y
            })
            .sum()
    }
}

impl Ticking for Figure {
    fn time(&self) -> u64 {
        self.steps
    }

    fn tick(&mut self) {
        self.step();
    }
}

/// Whether a limb may reach its limit within a step. Distant limits are left out, because the engine would
/// spend a ninth of its time on them.
fn nears_limit(bodies: &RigidBodySet, body: RigidBodyHandle, limb: &Limb, spec: &StarmanSpec) -> bool {
    let (body, part) = (&bodies[body], &bodies[limb.part]);
    let angle = (body.rotation() * limb.middle).inverse() * *part.rotation();
    let reach = (part.angvel() - body.angvel()).abs() * spec.time_step;
    // The sine grows less than the angle, so this check is conservative.
    angle.im.abs() + reach + LIMIT_MARGIN > math::sin(spec.servo_range)
}

impl fmt::Debug for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Figure")
            .field("spec", &self.spec)
            .field("truth", &self.truth())
            .finish_non_exhaustive()
    }
}

/// Collision group of the floor.
const FLOOR: Group = Group::GROUP_1;
/// Collision group of a robot's parts, which do not collide with each other.
const PART: Group = Group::GROUP_2;

/// Parts collide with the floor only; the servos' range keeps the limbs apart.
fn groups(of: Group, with: Group) -> InteractionGroups {
    InteractionGroups::new(of, with, InteractionTestMode::And)
}

/// Direction of a limb's middle position: the first one up, the others clockwise.
fn spread(limb: usize) -> f64 {
    FRAC_PI_2 - TAU * limb as f64 / LIMBS as f64
}

/// Hinge of a limb in the body's frame.
fn rim(spec: &StarmanSpec, limb: usize) -> Vector {
    let (sin, cos) = math::sin_cos(spread(limb));
    Vector::new(spec.body_radius * cos, spec.body_radius * sin)
}

/// Height of the body's middle while the tips of the two lower limbs touch the floor.
fn standing_height(spec: &StarmanSpec) -> f64 {
    -(spec.body_radius + spec.limb_length) * math::sin(spread(2)) + spec.limb_radius
}

fn attach(
    world: &mut PhysicsWorld,
    body: RigidBodyHandle,
    centre: Vector,
    spec: &StarmanSpec,
    limb: usize,
) -> Limb {
    let half = 0.5 * spec.limb_length;
    let (sin, cos) = math::sin_cos(spread(limb));
    let place = centre + Vector::new(cos, sin) * (spec.body_radius + half);
    let part = RigidBodyBuilder::dynamic().pose(Placement::new(place, spread(limb))).can_sleep(false);
    let shape =
        ColliderBuilder::capsule_x(half, spec.limb_radius).mass(spec.limb_mass).friction(spec.friction);
    let (part, _) = world.insert(part, shape.collision_groups(groups(PART, FLOOR)));
    let mut hinge = RevoluteJointBuilder::new()
        .contacts_enabled(false)
        .local_anchor1(rim(spec, limb))
        .local_anchor2(Vector::new(-half, 0.0))
        .motor_model(MotorModel::AccelerationBased)
        .limits([-spec.servo_range, spec.servo_range])
        .build();
    // Angles are relative to the limb's own direction.
    let middle = Rotation::new(spread(limb));
    hinge.data.local_frame1.rotation = middle;
    let joint = world.insert_impulse_joint(body, part, hinge);
    Limb { part, middle, joint, servo: Servo::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settled(spec: &StarmanSpec) -> Figure {
        let mut figure = Figure::new(spec);
        run(&mut figure, 2.0);
        figure
    }

    fn run(figure: &mut Figure, seconds: f64) {
        let steps = (seconds / figure.spec.time_step).round() as u64;
        (0..steps).for_each(|_| figure.step());
    }

    #[test]
    fn it_stands_on_two_limbs() {
        let spec = StarmanSpec::book();
        let figure = settled(&spec);
        let posture = figure.truth().posture;
        assert!((posture.body.1 - standing_height(&spec)).abs() < 0.003, "{posture:?}");
        assert!(posture.body.0.abs() < 0.005 && posture.roll.abs() < 0.02, "{posture:?}");
        assert!(posture.limbs.iter().all(|angle| angle.abs() < 0.08), "{posture:?}");
    }

    #[test]
    fn a_servo_turns_its_limb_at_its_speed_and_no_further_than_its_range() {
        let spec = StarmanSpec::book();
        let mut figure = settled(&spec);
        figure.send(0, 1.0);
        run(&mut figure, 0.5);
        let degrees = |figure: &Figure| figure.truth().posture.limbs[0].to_degrees();
        assert!((degrees(&figure) - 15.0).abs() < 1.5, "{}", degrees(&figure));
        run(&mut figure, 1.0);
        assert!((degrees(&figure) - 30.0).abs() < 1.0, "{}", degrees(&figure));
    }

    #[test]
    fn hinges_hold_while_all_limbs_swing() {
        for time_step in [0.010, 0.005, 0.0025] {
            let mut figure = settled(&StarmanSpec { time_step, ..StarmanSpec::book() });
            let mut widest: f64 = 0.0;
            for swing in 0..40 {
                for limb in 0..LIMBS {
                    figure.send(limb, if (swing + limb) % 3 == 0 { 1.0 } else { -1.0 });
                }
                for _ in 0..(0.25 / time_step) as u32 {
                    figure.step();
                    widest = widest.max(figure.truth().hinge_gap);
                }
            }
            assert!(widest < 0.001, "{widest} m at {time_step} s");
        }
    }

    /// During a collapse: the energy at the start, its minimum afterwards, and its largest rise.
    fn collapse(time_step: f64) -> (f64, f64, f64) {
        let mut figure = Figure::new(&StarmanSpec { time_step, ..StarmanSpec::book() });
        figure.power(false);
        let begin = figure.energy();
        let (mut least, mut rise) = (begin, 0.0_f64);
        for _ in 0..(3.0 / time_step) as u32 {
            figure.step();
            rise = rise.max(figure.energy() - least);
            least = least.min(figure.energy());
        }
        (begin, least, rise)
    }

    /// The rise was stored in slightly compliant contacts and limits.
    #[test]
    fn energy_does_not_grow_without_the_servos() {
        for time_step in [0.010, 0.005, 0.00125] {
            let (begin, least, rise) = collapse(time_step);
            assert!(least < begin - 0.05, "it has collapsed: {least} of {begin} J");
            assert!(rise < 0.04 * (begin - least), "{rise} of {} J at {time_step} s", begin - least);
        }
    }
}
