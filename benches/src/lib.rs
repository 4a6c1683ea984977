//! Benchmarks of roverlab, and the worlds that they share; see the programs beside.

pub mod fleet;
pub mod maps;

use roverlab::geometry::{Point, Pose, direction};
use roverlab::random::Stream;
use roverlab::world::{Wall, World};

/// Rooms in a row, and metres across each of them.
const ROOMS: usize = 8;
const ROOM: f64 = 3.0;

/// A building of 600 walls of default thickness on 24 m x 24 m: four long outer walls, 64 rooms with a door
/// in each side, whose walls come in short pieces, and slanted furniture.
///
/// ```
/// let world = roverlab_bench::building(1);
/// assert_eq!(world.walls.len(), 600);
/// assert_eq!(world, roverlab_bench::building(1));
/// ```
pub fn building(seed: u64) -> World {
    let extent = ROOM * ROOMS as f64;
    let mut world = World::walled(extent, extent);
    let mut stream = Stream::new(seed);
    for line in 1..ROOMS {
        let across = ROOM * line as f64;
        for room in 0..ROOMS {
            let start = ROOM * room as f64;
            add_side(&mut world, &mut stream, |along| Point::new(across, start + along));
            add_side(&mut world, &mut stream, |along| Point::new(start + along, across));
        }
    }
    while world.walls.len() < 600 {
        let middle = Point::new(stream.between(0.5, extent - 0.5), stream.between(0.5, extent - 0.5));
        let half = direction(stream.between(0.0, std::f64::consts::PI)) * stream.between(0.1, 0.4);
        world.walls.push(Wall::new(middle - half, middle + half));
    }
    world
}

/// A square floor with four outer walls and so many short walls in all directions, one on each half of a
/// square metre.
///
/// ```
/// let world = roverlab_bench::thicket(200, 1);
/// assert_eq!((world.walls.len(), world.floor.size().x), (204, 10.0));
/// ```
pub fn thicket(walls: usize, seed: u64) -> World {
    let extent = (0.5 * walls as f64).sqrt();
    let mut world = World::walled(extent, extent);
    let mut stream = Stream::new(seed);
    for _ in 0..walls {
        let middle = Point::new(stream.between(0.0, extent), stream.between(0.0, extent));
        let half = direction(stream.between(0.0, std::f64::consts::PI)) * stream.between(0.05, 0.2);
        world.walls.push(Wall::new(middle - half, middle + half));
    }
    world
}

/// One side of a room: two walls on either side of a door of 0.9 m.
fn add_side(world: &mut World, stream: &mut Stream, place: impl Fn(f64) -> Point) {
    let door = stream.between(0.4, ROOM - 1.3);
    for (from, to) in [(0.0, door), (door + 0.9, ROOM)] {
        let middle = 0.5 * (from + to);
        world.walls.push(Wall::new(place(from), place(middle)));
        world.walls.push(Wall::new(place(middle), place(to)));
    }
}

/// Poses on a world's floor that keep some distance from its walls.
pub fn free_poses(world: &World, count: usize, distance: f64, seed: u64) -> Vec<Pose> {
    let mut stream = Stream::new(seed);
    let size = world.floor.size();
    let poses = std::iter::repeat_with(|| {
        let x = world.floor.min.x + stream.between(0.0, size.x);
        let y = world.floor.min.y + stream.between(0.0, size.y);
        Pose::new(x, y, stream.between(-std::f64::consts::PI, std::f64::consts::PI))
    });
    let free = |pose: &Pose| world.walls.iter().all(|wall| wall.line.distance_to(pose.position()) > distance);
    poses.filter(free).take(count).collect()
}
