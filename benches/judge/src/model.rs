use rapier3d_f64::prelude::*;
use roverlab::geometry::units::GRAVITY;
use roverlab::kinematics::Tracked;
use roverlab::world::{DriveSpec, Footprint, RobotSpec};

/// A robot in the engine's world.
pub(crate) struct Model {
    /// Its body; the frame's origin is the robot's.
    pub(crate) body: RigidBodyHandle,
    pub(crate) motors: Motors,
    /// Distance between the wheels, or between those of the equivalent drive (m).
    pub(crate) track: f64,
}

/// What moves the robot.
pub(crate) enum Motors {
    /// Joints of the left and the right wheel, and the wheels' radius (m).
    Wheels([ImpulseJointHandle; 2], f64),
    Belts(Belts),
}

/// Belts of a body; their parts on the ground do not turn, and the ground moves under them as on a
/// conveyor.
pub(crate) struct Belts {
    pub(crate) body: RigidBodyHandle,
    /// Left and right (m/s).
    pub(crate) speeds: [f64; 2],
}

/// How belts stand on the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stand {
    /// On road wheels with springs.
    Springs,
    /// On rods without springs, one along either edge of each belt.
    Rods,
}

/// Mark of the left belt's parts; the right one's is the next.
pub(crate) const LEFT_BELT: u128 = 1;
/// Damping of a motor per inertia of its wheel (1/s): under load it keeps its speed within a µm/s.
const STRENGTH: f64 = 1e9;
/// Mass of a wheel of two, as a fraction of the robot's.
const WHEEL: f64 = 0.05;
/// Mass of a road wheel, likewise.
const ROAD_WHEEL: f64 = 0.005;
/// Radius of the castor's ball (m).
const CASTOR: f64 = 0.01;
/// Compression of all road wheels' springs by the robot's weight (m), as in the simulator.
const SAG: f64 = 1e-3;
/// Position of the centre of mass between axle and castor, and its height, as fractions of the whole. The
/// simulator assumes these for descriptions without a centre of mass.
const CENTRE: (f64, f64) = (0.3, 0.4);

impl Model {
    /// Places a robot in a world.
    pub(crate) fn insert(world: &mut PhysicsWorld, spec: &RobotSpec, stand: Stand, start: Pose) -> Self {
        match spec.drive {
            DriveSpec::Differential { wheel_diameter, track, .. } => {
                Self::on_wheels(world, spec, start, 0.5 * wheel_diameter, track)
            }
            DriveSpec::Tracked { wheel_diameter, track, length, width, .. } => {
                let belts = Tracked { track, length, width };
                Self::on_belts(world, spec, stand, start, 0.5 * wheel_diameter, belts)
            }
            _ => unreachable!("a robot on two wheels or belts"),
        }
    }

    /// A body with two balls as wheels on joints, and a ball without friction as castor.
    fn on_wheels(world: &mut PhysicsWorld, spec: &RobotSpec, start: Pose, radius: f64, track: f64) -> Self {
        let back = -0.5 * size(spec).x;
        let wheel = WHEEL * spec.mass;
        let masses = masses_without(spec, CENTRE.0 * back, 2.0 * wheel, radius);
        let castor = ColliderBuilder::ball(CASTOR)
            .translation(Vector::new(back, 0.0, CASTOR))
            .density(0.0)
            .friction(0.0)
            .friction_combine_rule(CoefficientCombineRule::Min);
        let (body, _) = world.insert(dynamic(start).additional_mass_properties(masses), castor);
        let joints = [0.5, -0.5].map(|side| {
            let place = Vector::new(0.0, side * track, radius);
            let ball = ColliderBuilder::ball(radius).mass(wheel).friction(spec.friction);
            let (wheel, _) = world.insert(dynamic(moved(start, place)), ball);
            let joint = RevoluteJointBuilder::new(Vector::Y).local_anchor1(place).contacts_enabled(false);
            world.insert_impulse_joint(body, wheel, joint.motor_velocity(0.0, STRENGTH))
        });
        Self { body, motors: Motors::Wheels(joints, radius), track }
    }

    /// A body on two belts.
    fn on_belts(
        world: &mut PhysicsWorld,
        spec: &RobotSpec,
        stand: Stand,
        start: Pose,
        radius: f64,
        belts: Tracked,
    ) -> Self {
        let wheels = if stand == Stand::Springs { belts.places(1.0).count() * 2 } else { 0 };
        let masses = masses_without(spec, 0.0, ROAD_WHEEL * spec.mass * wheels as f64, radius);
        let body = world.insert_body(dynamic(start).additional_mass_properties(masses));
        for (mark, side) in [(LEFT_BELT, 1.0), (LEFT_BELT + 1, -1.0)] {
            let part = |shape: ColliderBuilder| {
                let hooks = ActiveHooks::MODIFY_SOLVER_CONTACTS;
                shape.density(0.0).friction(spec.friction).active_hooks(hooks).user_data(mark)
            };
            match stand {
                Stand::Springs => {
                    for place in belts.places(side) {
                        let place = Vector::new(place.x, place.y, radius);
                        let wheel = part(ColliderBuilder::ball(radius));
                        spring(world, spec, (body, moved(start, place)), (wheel, place), wheels);
                    }
                }
                Stand::Rods => {
                    for edge in [0.5, -0.5] {
                        let aside = 0.5 * side * belts.track + edge * belts.width;
                        let rod = part(ColliderBuilder::capsule_x(0.5 * belts.length, radius));
                        world.insert_collider(rod.translation(Vector::new(0.0, aside, radius)), Some(body));
                    }
                }
            }
        }
        let motors = Motors::Belts(Belts { body, speeds: [0.0; 2] });
        Self { body, motors, track: belts.equivalent().track }
    }

    /// Sets the rim speeds of the wheels or belts, left and right (m/s).
    pub(crate) fn set_speeds(&mut self, world: &mut PhysicsWorld, speeds: [f64; 2]) {
        match &mut self.motors {
            Motors::Belts(belts) => belts.speeds = speeds,
            Motors::Wheels(joints, radius) => {
                for (joint, speed) in joints.iter().zip(speeds) {
                    let joint = world.impulse_joints.get_mut(*joint, true).expect("the joint of a wheel");
                    joint.data.set_motor_velocity(JointAxis::AngX, speed / *radius, STRENGTH);
                }
            }
        }
    }
}

/// Inserts one of `number` road wheels that carry a body: it moves up and down against a spring with the
/// damping that is critical for the whole body on it.
fn spring(
    world: &mut PhysicsWorld,
    spec: &RobotSpec,
    (body, there): (RigidBodyHandle, Pose),
    (wheel, place): (ColliderBuilder, Vector),
    number: usize,
) {
    let (mass, number) = (ROAD_WHEEL * spec.mass, number as f64);
    let stiffness = spec.mass * GRAVITY / (number * SAG);
    let damping = 2.0 * (stiffness * spec.mass).sqrt();
    let masses = MassProperties::new(Vector::ZERO, mass, mass * 0.4 * place.z * place.z * Vector::ONE);
    let (wheel, _) = world.insert(dynamic(there).additional_mass_properties(masses), wheel);
    let joint = PrismaticJointBuilder::new(Vector::Z)
        .local_anchor1(place)
        .contacts_enabled(false)
        .motor_model(MotorModel::ForceBased)
        .motor_position(-SAG, stiffness, damping);
    world.insert_impulse_joint(body, wheel, joint);
}

fn dynamic(start: Pose) -> RigidBodyBuilder {
    RigidBodyBuilder::dynamic().pose(start).can_sleep(false)
}

fn moved(start: Pose, place: Vector) -> Pose {
    Pose::from_parts(start * place, start.rotation)
}

/// Masses of a robot's body without wheels of a given mass together, whose centres are at a height above
/// the middle of the axle; the whole robot's centre of mass is at `ahead`. The body has the moments of a
/// block.
fn masses_without(spec: &RobotSpec, ahead: f64, wheels: f64, height: f64) -> MassProperties {
    let body = spec.mass - wheels;
    let moment = Vector::new(ahead, 0.0, CENTRE.1 * spec.height) * spec.mass;
    let centre = (moment - Vector::new(0.0, 0.0, height) * wheels) / body;
    let squares = size(spec) * size(spec);
    let around = Vector::new(squares.y + squares.z, squares.x + squares.z, squares.x + squares.y);
    MassProperties::new(centre, body, body / 12.0 * around)
}

/// Length, width and height (m).
fn size(spec: &RobotSpec) -> Vector {
    match &spec.footprint {
        Footprint::Rectangle(outline) => Vector::new(outline.size().x, outline.size().y, spec.height),
        Footprint::Disc { radius } => Vector::new(2.0 * radius, 2.0 * radius, spec.height),
        _ => unreachable!("a round or rectangular robot"),
    }
}
