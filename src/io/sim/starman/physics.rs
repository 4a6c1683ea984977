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
use super::plan::BodyPlan;
use super::servo::Servo;
use super::spec::StarmanSpec;
use crate::geometry::{math, normalize_angle, units};
use crate::io::sim::lockstep::Ticking;

/// Positions of a Starman's parts in the vertical plane: x along the floor, y up.
#[derive(Debug, Clone, PartialEq)]
pub struct StarmanPosture {
    /// Middle of the body: position along the floor and height (m).
    pub body: (f64, f64),
    /// Roll angle of the body, counter-clockwise (rad).
    pub roll: f64,
    /// Angle of each limb from its middle position (rad).
    pub limbs: Vec<f64>,
    /// Hinge and tip of each limb.
    pub segments: Vec<[(f64, f64); 2]>,
}

/// Ground truth of a Starman.
#[derive(Debug, Clone, PartialEq)]
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

/// What a figure is made of, in its initial position.
pub(super) struct Build {
    /// Middle of the body.
    centre: Vector,
    /// Half the distance between the middles of its round ends; 0 for a disc.
    half: f64,
    radius: f64,
    mass: f64,
    limbs: Vec<Part>,
    friction: f64,
    servo_speed: f64,
    servo_torque: f64,
    time_step: f64,
}

/// A limb in its initial position.
struct Part {
    /// The limb that carries it; none for the body.
    parent: Option<usize>,
    /// Hinge in the engine's frame of the parent, whose origin is the parent's middle.
    hinge: Vector,
    /// Direction of its middle position in that frame (rad).
    rest: f64,
    /// Middle and direction.
    place: Placement,
    half: f64,
    radius: f64,
    mass: f64,
    range: f64,
}

/// The body and its limbs on the floor, moved by the engine.
pub(super) struct Figure {
    world: PhysicsWorld,
    body: RigidBodyHandle,
    limbs: Vec<Limb>,
    servo_speed: f64,
    servo_torque: f64,
    time_step: f64,
    powered: bool,
    steps: u64,
}

struct Limb {
    part: RigidBodyHandle,
    parent: RigidBodyHandle,
    /// Hinge in the parent's frame, and half the limb's length.
    hinge: Vector,
    half: f64,
    /// Direction of its middle position in the parent's frame.
    rest: f64,
    middle: Rotation,
    range: f64,
    joint: ImpulseJointHandle,
    servo: Servo,
}

/// Natural frequency of a displaced servo (1/s). With much stiffer servos, two supporting limbs press against
/// each other so hard that the time step decides which of them slips.
const SERVO_FREQUENCY: f64 = 25.0;
/// Largest angle by which a contact may throw a limb within a step (rad).
const LIMIT_MARGIN: f64 = 0.05;

impl Figure {
    /// A figure in its initial position.
    pub(super) fn new(build: &Build) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::new(0.0, -units::GRAVITY);
        let settings = &mut world.integration_parameters;
        settings.dt = build.time_step;
        // Solver tolerances are fractions of this length.
        settings.length_unit = build.radius + build.half;
        // Two passes of four sweeps with friction in each: the cheapest setting without creeping limbs, so
        // that a gait covers the same distance with half the time step.
        settings.num_solver_iterations = 2;
        settings.num_internal_pgs_iterations = 4;
        settings.friction_in_bias_pass = true;
        let floor = ColliderBuilder::halfspace(Unit::new_unchecked(Vector::Y)).friction(build.friction);
        world.colliders.insert(floor.collision_groups(groups(FLOOR, PART)));
        let body = RigidBodyBuilder::dynamic().translation(build.centre).can_sleep(false);
        let shape = if build.half > 0.0 {
            ColliderBuilder::capsule_x(build.half, build.radius)
        } else {
            ColliderBuilder::ball(build.radius)
        };
        let shape = shape.mass(build.mass).friction(build.friction);
        let (body, _) = world.insert(body, shape.collision_groups(groups(PART, FLOOR)));
        let mut limbs: Vec<Limb> = Vec::with_capacity(build.limbs.len());
        for part in &build.limbs {
            let parent = part.parent.map_or(body, |parent| limbs[parent].part);
            limbs.push(attach(&mut world, parent, part, build.friction));
        }
        let &Build { servo_speed, servo_torque, time_step, .. } = build;
        Self { world, body, limbs, servo_speed, servo_torque, time_step, powered: true, steps: 0 }
    }

    /// Number of servos.
    pub(super) fn servos(&self) -> usize {
        self.limbs.len()
    }

    /// Sets the target of a servo, from -1 to 1.
    pub(super) fn send(&mut self, limb: usize, position: f64) {
        let limb = &mut self.limbs[limb];
        limb.servo.send(position * limb.range);
    }

    /// Switches the servos on or off; when off, the limbs swing freely within their limits.
    #[cfg(test)]
    pub(super) fn power(&mut self, on: bool) {
        self.powered = on;
    }

    /// Advances by one time step.
    fn step(&mut self) {
        let stiffness = (TAU * SERVO_FREQUENCY) * (TAU * SERVO_FREQUENCY);
        // Critical damping: no overshoot.
        let damping = 2.0 * TAU * SERVO_FREQUENCY;
        for limb in &mut self.limbs {
            let (angle, rate) = limb.servo.advance(self.servo_speed, self.time_step);
            let Some(joint) = self.world.impulse_joints.get_mut(limb.joint, false) else { continue };
            let torque = if self.powered { self.servo_torque } else { 0.0 };
            joint.data.set_motor(JointAxis::AngX, angle, rate, stiffness, damping);
            joint.data.set_motor_max_force(JointAxis::AngX, torque);
            let near = nears_limit(&self.world.bodies, limb, self.time_step);
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
            hinge_gap: self.limbs.iter().map(|limb| self.gap(limb)).fold(0.0, f64::max),
            energy: self.energy(),
            steps: self.steps,
        }
    }

    fn posture(&self) -> StarmanPosture {
        let body = self.world.bodies[self.body].position();
        let pair = |v: Vector| (v.x, v.y);
        let at = |handle: RigidBodyHandle| self.world.bodies[handle].position();
        let angle = |limb: &Limb| {
            normalize_angle(at(limb.part).rotation.angle() - at(limb.parent).rotation.angle() - limb.rest)
        };
        let ends = |limb: &Limb| {
            let half = Vector::new(limb.half, 0.0);
            [pair(*at(limb.part) * -half), pair(*at(limb.part) * half)]
        };
        StarmanPosture {
            body: pair(body.translation),
            roll: body.rotation.angle(),
            limbs: self.limbs.iter().map(angle).collect(),
            segments: self.limbs.iter().map(ends).collect(),
        }
    }

    fn gap(&self, limb: &Limb) -> f64 {
        let parent = self.world.bodies[limb.parent].position();
        let part = self.world.bodies[limb.part].position();
        let on_body = *parent * limb.hinge;
        let on_limb = *part * Vector::new(-limb.half, 0.0);
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

    fn run(&mut self, ticks: u64) {
        (0..ticks).for_each(|_| self.step());
    }
}

/// Whether a limb may reach its limit within a step. Distant limits are left out, because the engine would
/// spend a ninth of its time on them.
fn nears_limit(bodies: &RigidBodySet, limb: &Limb, time_step: f64) -> bool {
    let (parent, part) = (&bodies[limb.parent], &bodies[limb.part]);
    let angle = (parent.rotation() * limb.middle).inverse() * *part.rotation();
    let reach = (part.angvel() - parent.angvel()).abs() * time_step;
    // The sine grows less than the angle, so this check is conservative.
    angle.im.abs() + reach + LIMIT_MARGIN > math::sin(limb.range)
}

impl fmt::Debug for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Figure")
            .field("servos", &self.servos())
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

impl Build {
    /// The star, which stands on two limbs with the first one up.
    pub(super) fn star(spec: &StarmanSpec) -> Self {
        let centre = Vector::new(0.0, standing_height(spec));
        let half = 0.5 * spec.limb_length;
        let part = |limb: usize| {
            let (sin, cos) = math::sin_cos(spread(limb));
            let place = centre + Vector::new(cos, sin) * (spec.body_radius + half);
            Part {
                parent: None,
                hinge: rim(spec, limb),
                rest: spread(limb),
                place: Placement::new(place, spread(limb)),
                half,
                radius: spec.limb_radius,
                mass: spec.limb_mass,
                range: spec.servo_range,
            }
        };
        Self {
            centre,
            half: 0.0,
            radius: spec.body_radius,
            mass: spec.body_mass,
            limbs: (0..LIMBS).map(part).collect(),
            friction: spec.friction,
            servo_speed: spec.servo_speed,
            servo_torque: spec.servo_torque,
            time_step: spec.time_step,
        }
    }

    /// The body of a plan, standing on its lowest part.
    pub(super) fn of(plan: &BodyPlan) -> Self {
        let centre = Vector::new(0.0, plan.standing_height());
        let part = |(limb, hinge): (&super::LimbPlan, crate::geometry::Pose)| {
            let middle = BodyPlan::middle_of(limb, &hinge);
            // The plan's frames begin at hinges, the engine's in the middle of parts.
            let before = limb.parent.map_or(0.0, |parent| 0.5 * plan.limbs[parent].length);
            Part {
                parent: limb.parent,
                hinge: Vector::new(limb.hinge[0] - before, limb.hinge[1]),
                rest: limb.rest,
                place: Placement::new(centre + Vector::new(middle.x, middle.y), hinge.heading),
                half: 0.5 * limb.length,
                radius: limb.radius,
                mass: limb.mass,
                range: limb.range,
            }
        };
        Self {
            centre,
            half: 0.5 * plan.length,
            radius: plan.radius,
            mass: plan.mass,
            limbs: plan.limbs.iter().zip(plan.at_rest()).map(part).collect(),
            friction: plan.friction,
            servo_speed: plan.servo_speed,
            servo_torque: plan.servo_torque,
            time_step: plan.time_step,
        }
    }
}

fn attach(world: &mut PhysicsWorld, parent: RigidBodyHandle, limb: &Part, friction: f64) -> Limb {
    let &Part { hinge, rest, half, radius, mass, range, .. } = limb;
    let part = RigidBodyBuilder::dynamic().pose(limb.place).can_sleep(false);
    let shape = ColliderBuilder::capsule_x(half, radius).mass(mass).friction(friction);
    let (part, _) = world.insert(part, shape.collision_groups(groups(PART, FLOOR)));
    let mut joint = RevoluteJointBuilder::new()
        .contacts_enabled(false)
        .local_anchor1(hinge)
        .local_anchor2(Vector::new(-half, 0.0))
        .motor_model(MotorModel::AccelerationBased)
        .limits([-range, range])
        .build();
    // Angles are relative to the limb's own direction.
    let middle = Rotation::new(rest);
    joint.data.local_frame1.rotation = middle;
    let joint = world.insert_impulse_joint(parent, part, joint);
    Limb { part, parent, hinge, half, rest, middle, range, joint, servo: Servo::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settled(spec: &StarmanSpec) -> Figure {
        let mut figure = Figure::new(&Build::star(spec));
        run(&mut figure, 2.0);
        figure
    }

    fn run(figure: &mut Figure, seconds: f64) {
        let steps = (seconds / figure.time_step).round() as u64;
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
        let mut figure = Figure::new(&Build::star(&StarmanSpec { time_step, ..StarmanSpec::book() }));
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
