use std::sync::Arc;

use roverlab::geometry::{Point, Pose, direction, units};
use roverlab::nav::Reachability;
use roverlab::random::Stream;
use roverlab::world::generate::{CourseOptions, obstacle_course};
use roverlab::world::{Colour, Marker, Object, ObjectKind, RobotSpec, Scene, Wall, World};

use crate::common::{Failure, Trip};

/// A trip, and the robot's map of the world.
#[derive(Debug, Clone)]
pub(crate) struct Course {
    pub(crate) trip: Trip,
    pub(crate) known: World,
    pub(crate) unmapped: u32,
}

/// Width of passages next to an unmapped obstacle, as a multiple of the robot's width.
const PASSAGE: f64 = 1.5;
/// Number of attempts to place an obstacle.
const TRIES: usize = 60;
/// Minimum distance of an obstacle from start and goal (m).
const APART: f64 = 0.30;
/// Maximum number of cells for checking that a way exists.
const MAX_CELLS: f64 = 1e6;

/// The command's default world, 4 m by 3 m: three rooms with two doors each.
pub(crate) fn scene() -> Scene {
    let mut world = World::walled(4.0, 3.0);
    let at = |x: f64, y: f64| Point::new(units::from_mm(x), units::from_mm(y));
    for (from, to) in [
        ((1400.0, 0.0), (1400.0, 500.0)),
        ((1400.0, 1000.0), (1400.0, 2200.0)),
        ((1400.0, 2600.0), (1400.0, 3000.0)),
        ((2700.0, 0.0), (2700.0, 300.0)),
        ((2700.0, 700.0), (2700.0, 1900.0)),
        ((2700.0, 2400.0), (2700.0, 3000.0)),
        ((2000.0, 1000.0), (2000.0, 2000.0)),
    ] {
        world.walls.push(Wall::new(at(from.0, from.1), at(to.0, to.1)));
    }
    let position = at(3600.0, 2600.0);
    world.markers.push(Marker { position, colour: Colour::GREEN, alpha: 255 });
    Scene::with_robot(world, RobotSpec::s4(), Pose::from_mm_deg(400.0, 400.0, 0.0))
}

/// A generated world with a reachable goal, and two to five unmapped obstacles.
pub(crate) fn generated(seed: u64) -> Result<Course, Failure> {
    let spec = RobotSpec::s4();
    let options = CourseOptions {
        robot_radius: spec.footprint.bounding_radius(),
        unreachable_share: 0.0,
        ..CourseOptions::default()
    };
    let course = obstacle_course(&mut Stream::new(seed), &options).map_err(Failure::run)?;
    let trip = Trip { scene: Scene::with_robot(course.world, spec, course.start), goal: course.goal };
    let mut stream = Stream::new(seed).child("unmapped", 0);
    let count = 2 + stream.below(4) as u32;
    changed(trip, count, &mut stream)
}

/// The trip in a world with added obstacles that leave a way; fewer where there is no room for all.
pub(crate) fn changed(mut trip: Trip, count: u32, stream: &mut Stream) -> Result<Course, Failure> {
    let known = trip.scene.world.clone();
    let radius = PASSAGE * trip.spec().footprint.bounding_radius();
    let size = known.site().size();
    let resolution = (radius / 6.0).max((size.x * size.y / MAX_CELLS).sqrt());
    let (start, goal) = (trip.start().position(), trip.goal);
    let mut unmapped = 0;
    for _ in 0..count {
        let ways = Reachability::new(&trip.scene.world, radius, resolution).map_err(Failure::run)?;
        let Some(way) = ways.shortest_path(start, goal) else { break };
        for _ in 0..TRIES {
            let way_point = way.points[stream.below(way.points.len())];
            let place = Point::new(
                way_point.x + stream.between(-SPREAD, SPREAD),
                way_point.y + stream.between(-SPREAD, SPREAD),
            );
            let mut world = trip.scene.world.clone();
            add(&mut world, place, stream);
            // An obstacle half inside a wall would hardly be seen.
            let in_wall = known.walls.iter().any(|wall| wall.line.distance_to(place) < 0.5 * APART);
            let apart = |point: Point| (place - point).norm() > APART + WALL && !in_wall;
            let ways = Reachability::new(&world, radius, resolution).map_err(Failure::run)?;
            if apart(start) && apart(goal) && ways.connected(start, goal) {
                trip.scene.world = world;
                unmapped += 1;
                break;
            }
        }
    }
    Ok(Course { trip, known, unmapped })
}

/// Maximum distance of an unmapped obstacle from the known way along each axis (m), so that it matters.
const SPREAD: f64 = 0.15;
/// Half the length of the longest unmapped wall (m).
const WALL: f64 = 0.3;

fn add(world: &mut World, place: Point, stream: &mut Stream) {
    let heading = stream.between(-std::f64::consts::PI, std::f64::consts::PI);
    match stream.below(3) {
        0 => {
            let half = direction(heading) * stream.between(0.1, WALL);
            world.walls.push(Wall::new(place - half, place + half));
        }
        kind => {
            let name = if kind == 1 { "crate" } else { "can" };
            let kind = ObjectKind::predefined(name).expect("a kind that every scene knows");
            let pose = Pose::new(place.x, place.y, heading);
            world.objects.push(Object::new(Arc::new(kind), pose));
        }
    }
}
