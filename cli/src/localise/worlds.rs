use std::f64::consts::PI;
use std::sync::Arc;

use roverlab::ParameterError;
use roverlab::geometry::{Point, Pose, direction};
use roverlab::nav::Reachability;
use roverlab::random::Stream;
use roverlab::world::generate::{CourseOptions, RoomOptions, obstacle_course, room};
use roverlab::world::{Object, ObjectKind, Wall, World};

/// A world of the campaign.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    pub(crate) name: String,
    pub(crate) world: World,
    /// Number of places from which it looks the same.
    pub(crate) symmetry: usize,
    /// Required percentage of fully successful starts. In a large hall the robot may see nothing but the
    /// floor.
    pub(crate) share: u64,
}

/// A few rooms connected by doors: the command's default world.
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

/// An L, a hall with crates, an office, a generated room and a generated course; a rectangle and a square,
/// with symmetries of order two and four; empty halls, and halls with one to four marks.
pub(crate) fn worlds() -> Vec<Place> {
    let mut angle = World::empty(4.0, 3.0);
    let corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 1.6), (2.2, 1.6), (2.2, 3.0), (0.0, 3.0)];
    angle.add_loop(&corners.map(|(x, y)| Point::new(x, y)));
    let mut crates = World::walled(4.0, 3.0);
    let kind = ObjectKind::predefined("crate").map(Arc::new);
    for (x, y) in [(1.0, 0.8), (2.9, 2.1), (3.2, 0.6)] {
        crates.objects.extend(kind.iter().map(|kind| Object::new(Arc::clone(kind), Pose::new(x, y, 0.3))));
    }
    let room = room(&mut Stream::new(5), &RoomOptions::default()).expect("default options are valid");
    let options = CourseOptions { unreachable_share: 0.0, ..CourseOptions::default() };
    let course = obstacle_course(&mut Stream::new(7), &options).expect("these options are valid");
    let small = [
        ("L", angle, 1),
        ("crates", crates, 1),
        ("office", office(), 1),
        ("room", room.world, 1),
        ("course", course.world, 1),
        ("rectangle", World::walled(3.0, 2.0), 2),
        ("square", World::walled(2.4, 2.4), 4),
    ];
    let small = small.map(|(name, world, symmetry)| Place { name: name.into(), world, symmetry, share: 98 });
    let halls = [10, 14, 20, 28, 40, 60, 100].map(|size| (size, 0));
    let marked = [(12, 1), (14, 2), (20, 1), (20, 3), (28, 2), (40, 4), (60, 4)];
    small.into_iter().chain(halls.into_iter().chain(marked).map(|(size, marks)| hall(size, marks))).collect()
}

/// A square hall with short walls as marks. Where the lidar sees from wall to wall, the pose is fully
/// determined.
fn hall(size: u32, marks: u32) -> Place {
    const SEEN: u32 = 14;
    let metres = f64::from(size);
    let mut world = World::walled(metres, metres);
    let mut stream = Stream::new(u64::from(size)).child("marks", marks.into());
    for _ in 0..marks {
        let inside = |stream: &mut Stream| stream.between(1.0, metres - 1.0);
        let from = Point::new(inside(&mut stream), inside(&mut stream));
        let along = direction(stream.between(-PI, PI)) * stream.between(0.3, 0.8);
        world.walls.push(Wall::new(from, from + along));
    }
    let name = if marks == 0 { format!("hall {size}") } else { format!("hall {size}, {marks}") };
    let symmetry = if marks == 0 { 4 } else { 1 };
    Place { name, world, symmetry, share: if size <= SEEN { 98 } else { 0 } }
}

/// Possible starts: with room for the robot, connected to the world's own start, otherwise inside the outer
/// walls.
pub(crate) struct Starts<'w> {
    world: &'w World,
    free: Reachability,
}

impl<'w> Starts<'w> {
    /// Fails for a world that is too large.
    pub(crate) fn new(world: &'w World, radius: f64) -> Result<Self, ParameterError> {
        /// Cell size (m), and maximum number of cells along a side.
        const RESOLUTION: f64 = 0.02;
        const CELLS: f64 = 2000.0;
        let resolution = RESOLUTION.max(world.site().size().max() / CELLS);
        Ok(Self { world, free: Reachability::new(world, radius + 0.05, resolution)? })
    }

    /// A random pose; `None` without room.
    pub(crate) fn draw(&self, seed: u64) -> Option<Pose> {
        const TRIES: usize = 10_000;
        let bounds = self.world.site();
        let outside = bounds.inflated(0.1).min;
        let is_inside = |place| match self.world.start {
            Some(start) => self.free.connected(place, start.position()),
            None => !self.free.connected(place, outside),
        };
        let mut stream = Stream::new(seed).child("start", 0);
        (0..TRIES).find_map(|_| {
            let place = Point::new(
                stream.between(bounds.min.x, bounds.max.x),
                stream.between(bounds.min.y, bounds.max.y),
            );
            let heading = stream.between(-PI, PI);
            (self.free.is_free(place) && is_inside(place)).then(|| Pose::new(place.x, place.y, heading))
        })
    }
}
