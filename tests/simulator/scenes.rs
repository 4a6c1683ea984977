//! Robots, and a world that is full of things.

use std::sync::Arc;

use roverlab::geometry::{Aabb, Point, Pose};
use roverlab::random::Stream;
use roverlab::world::{
    Colour, Footprint, Object, ObjectKind, RobotPlacement, RobotSpec, Scene, Shape, Wall, World,
};

/// Several robots of a kind in a world.
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
