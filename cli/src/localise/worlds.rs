use std::f64::consts::PI;
use std::sync::Arc;

use roverlab::geometry::{Point, Pose};
use roverlab::nav::Reachability;
use roverlab::random::Stream;
use roverlab::world::generate::{CourseOptions, RoomOptions, obstacle_course, room};
use roverlab::world::{Object, ObjectKind, Wall, World};

/// A world of the campaign, and in how many ways it looks the same.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    pub(crate) name: &'static str,
    pub(crate) world: World,
    pub(crate) symmetry: usize,
}

/// Some rooms with doors between them: the command's own world.
pub(crate) fn office() -> World {
    let mut world = World::walled(5.0, 4.0);
    let walls = [
        ((0.0, 1.8), (1.2, 1.8)),
        ((2.0, 1.8), (2.6, 1.8)),
        ((2.6, 0.0), (2.6, 0.9)),
        ((2.6, 1.8), (2.6, 2.6)),
        ((2.6, 3.4), (2.6, 4.0)),
        ((3.6, 2.2), (5.0, 2.2)),
    ];
    let wall = |(a, b): ((f64, f64), (f64, f64))| Wall::new(Point::new(a.0, a.1), Point::new(b.0, b.1));
    world.walls.extend(walls.map(wall));
    world
}

/// An L, a hall with crates, an office, a generated room and a generated course; then a rectangle and a square, which
/// look the same from two and from four places.
pub(crate) fn worlds() -> Vec<Place> {
    let mut angle = World::empty(4.0, 3.0);
    let corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 1.6), (2.2, 1.6), (2.2, 3.0), (0.0, 3.0)];
    angle.add_loop(&corners.map(|(x, y)| Point::new(x, y)));
    let mut hall = World::walled(4.0, 3.0);
    let kind = ObjectKind::predefined("crate").map(Arc::new);
    for (x, y) in [(1.0, 0.8), (2.9, 2.1), (3.2, 0.6)] {
        hall.objects.extend(kind.iter().map(|kind| Object::new(Arc::clone(kind), Pose::new(x, y, 0.3))));
    }
    let room = room(&mut Stream::new(5), &RoomOptions::default()).expect("default options are valid");
    let options = CourseOptions { unreachable_share: 0.0, ..CourseOptions::default() };
    let course = obstacle_course(&mut Stream::new(7), &options).expect("these options are valid");
    [
        ("L", angle, 1),
        ("crates", hall, 1),
        ("office", office(), 1),
        ("room", room.world, 1),
        ("course", course.world, 1),
        ("rectangle", World::walled(3.0, 2.0), 2),
        ("square", World::walled(2.4, 2.4), 4),
    ]
    .map(|(name, world, symmetry)| Place { name, world, symmetry })
    .into()
}

/// A random pose with room for a robot: where the world's own start can be reached, or else inside of the walls round it.
pub(crate) fn start(world: &World, radius: f64, seed: u64) -> Option<Pose> {
    const TRIES: usize = 10_000;
    let free = Reachability::new(world, radius + 0.05, 0.02).ok()?;
    let bounds = world.bounds();
    let outside = bounds.inflated(0.1).min;
    let is_inside = |place| match world.start {
        Some(start) => free.connected(place, start.position()),
        None => !free.connected(place, outside),
    };
    let mut stream = Stream::new(seed).child("start", 0);
    (0..TRIES).find_map(|_| {
        let place = Point::new(
            stream.between(bounds.min.x, bounds.max.x),
            stream.between(bounds.min.y, bounds.max.y),
        );
        let heading = stream.between(-PI, PI);
        (free.is_free(place) && is_inside(place)).then(|| Pose::new(place.x, place.y, heading))
    })
}
