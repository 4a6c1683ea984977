//! Scenes, and short ways to say what several tests say.

use std::sync::Arc;

use roverlab::geometry::{Aabb, Point, Pose, units};
use roverlab::io::sim::{SimOptions, SimRobot, Simulation, Truth};
use roverlab::random::Stream;
use roverlab::world::{
    Colour, Footprint, Object, ObjectKind, RobotPlacement, RobotSpec, Scene, Shape, Wall, World,
};

/// An S4's encoder tick on the floor, in metres.
pub(crate) const ENCODER_TICK: f64 = std::f64::consts::PI * 0.054 / 1100.0;

/// One robot in a simulation, and what is true about it.
pub(crate) fn start(scene: &Scene, options: SimOptions) -> (SimRobot, Truth) {
    let simulation = Simulation::new(scene, options).unwrap();
    (simulation.robot(0).unwrap(), simulation.truth())
}

/// An S4 on an empty floor.
pub(crate) fn open_floor(pose: Pose) -> Scene {
    Scene::with_robot(World::empty(10.0, 10.0), RobotSpec::s4(), pose)
}

/// Several S4s in a world.
pub(crate) fn robots(world: World, poses: &[Pose]) -> Scene {
    with_robots(world, &RobotSpec::s4(), poses)
}

pub(crate) fn with_robots(world: World, spec: &RobotSpec, poses: &[Pose]) -> Scene {
    let spec = Arc::new(spec.clone());
    let robots = poses.iter().map(|&pose| RobotPlacement::new(Arc::clone(&spec), pose)).collect();
    Scene { robots, ..Scene::new(world) }
}

/// An S4 with a rectangular outline, longer behind its axle than before it.
pub(crate) fn brick() -> RobotSpec {
    let outline = Aabb::new(Point::new(-0.10, -0.05), Point::new(0.06, 0.05));
    RobotSpec { footprint: Footprint::Rectangle(outline), ..RobotSpec::s4() }
}

/// A world of walls in all directions, cans and crates; the middle of it is free.
pub(crate) fn cluttered(seed: u64) -> World {
    let mut stream = Stream::new(seed);
    let mut world = World::walled(2.4, 2.4);
    let place = |stream: &mut Stream| loop {
        let point = Point::new(stream.between(0.1, 2.3), stream.between(0.1, 2.3));
        if (point - Point::new(1.2, 1.2)).norm() > 0.4 {
            return Pose::new(point.x, point.y, stream.between(-3.0, 3.0));
        }
    };
    for number in 0..8 {
        let pose = place(&mut stream);
        let half = pose.forward() * 0.1;
        let mut wall = Wall::new(pose.position() - half, pose.position() + half);
        wall.thickness = if number % 2 == 0 { Wall::DEFAULT_THICKNESS } else { 0.0 };
        world.walls.push(wall);
    }
    let crate_of_wood = Shape::Box { length: 0.2, width: 0.1, height: 0.2 };
    for number in 0..8 {
        let kind = if number % 2 == 0 {
            ObjectKind::predefined("can").unwrap()
        } else {
            ObjectKind::new("crate", crate_of_wood, Colour::RED)
        };
        world.objects.push(Object::new(Arc::new(kind), place(&mut stream)));
    }
    world
}

/// The difference of two directions in degrees, never negative.
pub(crate) fn degrees_between(a: f64, b: f64) -> f64 {
    units::to_deg(roverlab::geometry::angle_difference(a, b).abs())
}
