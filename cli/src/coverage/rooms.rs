use std::f64::consts::PI;
use std::sync::Arc;

use roverlab::geometry::{Point, Pose};
use roverlab::random::Stream;
use roverlab::world::{Object, ObjectKind, RobotSpec, Scene, Wall, World};

/// Minimum distance of things from the start (m).
const FREE: f64 = 0.35;

/// A room generated from a seed: projecting walls, crates and cans, and an S4 in a corner.
pub(super) fn room(seed: u64) -> Scene {
    let mut stream = Stream::new(seed).child("floor", 0);
    let (width, depth) = (stream.between(2.0, 4.0), stream.between(1.6, 3.0));
    let mut world = World::walled(width, depth);
    for _ in 0..stream.below(3) {
        let x = stream.between(0.3, 0.8) * width;
        let length = stream.between(0.2, 0.5) * depth;
        let from = if stream.chance(0.5) { 0.0 } else { depth };
        let to = if from > 0.0 { depth - length } else { length };
        world.walls.push(Wall::new(Point::new(x, from), Point::new(x, to)));
    }
    let start = Point::new(0.2, 0.2);
    for _ in 0..=stream.below(4) {
        let name = if stream.chance(0.6) { "crate" } else { "can" };
        let Some(kind) = ObjectKind::predefined(name) else { continue };
        let place = Point::new(stream.between(0.2, width - 0.2), stream.between(0.2, depth - 0.2));
        let heading = stream.between(-PI, PI);
        if (place - start).norm() > FREE {
            let kind = Arc::new(ObjectKind { fixed: true, ..kind });
            world.objects.push(Object::new(kind, Pose::new(place.x, place.y, heading)));
        }
    }
    Scene::with_robot(world, RobotSpec::s4(), Pose::new(start.x, start.y, 0.0))
}
