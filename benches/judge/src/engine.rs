use rapier3d_f64::prelude::*;
use roverlab::geometry::units::GRAVITY;
use roverlab::geometry::{Point3, Vector3};
use roverlab::world::{HeightField, RobotSpec};

use crate::course::{BETWEEN_SAMPLES, Course, PERIOD, PERIODS, Sample};
use crate::model::{Belts, LEFT_BELT, Model, Motors, Stand};

/// The world of the engine with one robot.
struct Engine {
    world: PhysicsWorld,
    robot: Model,
}

/// Steps of the engine between two commands: of 0.5 ms.
const STEPS: u32 = 20;
/// Substeps of the engine's solver in a step: of 62.5 µs. With twice as long ones, bodies skid at some edges
/// between triangles, and an S4 ends up to 100 mm away; half as long ones move the ends of the two drives
/// where this happens by 1 mm.
const PASSES: usize = 8;
/// Stiffness of the ground, as the natural frequency of what stands on it (Hz). Under the engine's own 60
/// Hz, wheels much lighter than their load sink in by 0.2 mm, 0.8 % of the radius on which they roll.
const STIFF: f64 = 600.0;
/// Distance at which the engine begins to look at a contact (m), a twentieth of the robot's way in a
/// second.
const NEAR: f64 = 2e-3;

/// Drives the engine's model of a robot along a course, from the pose in which it stands.
pub(crate) fn drive(course: &Course, spec: &RobotSpec, stand: Stand, start: &Sample) -> Vec<Sample> {
    let mut engine = Engine::new(&course.ground, spec, stand, start);
    let mut samples = vec![engine.sample()];
    for period in 0..PERIODS {
        let command = course.command(period);
        let aside = 0.5 * engine.robot.track * command.angular;
        engine.run([command.linear - aside, command.linear + aside]);
        if (period + 1) % BETWEEN_SAMPLES == 0 {
            samples.push(engine.sample());
        }
    }
    samples
}

impl Engine {
    fn new(ground: &HeightField, spec: &RobotSpec, stand: Stand, start: &Sample) -> Self {
        let mut world = PhysicsWorld { gravity: Vector::new(0.0, 0.0, -GRAVITY), ..PhysicsWorld::default() };
        let parameters = &mut world.integration_parameters;
        parameters.dt = PERIOD / f64::from(STEPS);
        parameters.num_solver_iterations = PASSES;
        parameters.static_contact_softness.natural_frequency = STIFF;
        parameters.normalized_prediction_distance = NEAR;
        // A friction of its own for each contact, at places computed anew in each step.
        parameters.friction_model = FrictionModel::Coulomb;
        parameters.contact_clustering = false;
        parameters.contact_recycling = false;
        world.insert(RigidBodyBuilder::fixed(), surface(ground).friction(spec.friction));
        let robot = Model::insert(&mut world, spec, stand, pose(start));
        Self { world, robot }
    }

    /// Runs until the next command; the wheels or belts have these rim speeds, left and right (m/s).
    fn run(&mut self, speeds: [f64; 2]) {
        let Self { world, robot } = self;
        robot.set_speeds(world, speeds);
        for _ in 0..STEPS {
            match &robot.motors {
                Motors::Wheels(..) => world.step(),
                Motors::Belts(belts) => world.step_with_events(belts, &()),
            }
        }
    }

    fn sample(&self) -> Sample {
        let pose = self.world.bodies[self.robot.body].position();
        let [up, ahead] = [Vector::Z, Vector::X].map(|axis| Vector3::from((pose.rotation * axis).to_array()));
        Sample { place: Point3::from(pose.translation.to_array()), up, ahead }
    }
}

impl PhysicsHooks for Belts {
    /// What touches the ground belongs to a belt that runs backwards at its speed.
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext<'_>) {
        let marks = [context.collider1, context.collider2].map(|part| context.colliders[part].user_data);
        let (mark, sign) = if marks[0] >= LEFT_BELT { (marks[0], -1.0) } else { (marks[1], 1.0) };
        let speed = sign * self.speeds[usize::from(mark > LEFT_BELT)];
        let ahead = *context.bodies[self.body].rotation() * Vector::X;
        let Some(contacts) = context.rigid_mut() else { return };
        let along = (ahead - *contacts.normal * ahead.dot(*contacts.normal)).normalize_or_zero();
        for contact in contacts.solver_contacts.iter_mut() {
            contact.tangent_velocity = along * speed;
        }
    }
}

/// The triangles of a terrain.
fn surface(ground: &HeightField) -> ColliderBuilder {
    let (columns, rows, pitch, corner) = (ground.columns(), ground.rows(), ground.pitch(), ground.area().min);
    let cells =
        |rows: usize, columns: usize| (0..rows).flat_map(move |row| (0..columns).map(move |c| (c, row)));
    let place = |(column, row): (usize, usize)| {
        let (x, y) = (corner.x + pitch.x * column as f64, corner.y + pitch.y * row as f64);
        Vector::new(x, y, ground.sample(column, row))
    };
    let number = |column: usize, row: usize| (row * columns + column) as u32;
    let halves = |(column, row): (usize, usize)| {
        let (low, high) = (number(column, row), number(column + 1, row + 1));
        [[low, number(column + 1, row), high], [low, high, number(column, row + 1)]]
    };
    let corners = cells(rows, columns).map(place).collect();
    let triangles = cells(rows - 1, columns - 1).flat_map(halves).collect();
    // Without this flag, bodies catch on the edges between triangles.
    let flags = TriMeshFlags::FIX_INTERNAL_EDGES;
    ColliderBuilder::trimesh_with_flags(corners, triangles, flags).expect("a surface of triangles")
}

fn pose(start: &Sample) -> Pose {
    let [ahead, up] = [start.ahead, start.up].map(|axis| Vector::new(axis.x, axis.y, axis.z));
    let rotation = Rotation::from_mat3(&Matrix::from_cols(ahead, up.cross(ahead), up));
    Pose::from_parts(Vector::new(start.place.x, start.place.y, start.place.z), rotation)
}
