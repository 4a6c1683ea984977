use std::f64::consts::PI;
use std::sync::Arc;

use roverlab::geometry::{Point, Pose, Twist};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{self, Drive};
use roverlab::random::Stream;
use roverlab::world::{Colour, Object, ObjectKind, RobotPlacement, RobotSpec, Scene, Wall, World};

use super::Args;

/// The book's scene: a watching robot, and another one between two cans (Program 11.16).
pub(crate) fn book() -> Scene {
    let mut world = room();
    for (x, y) in [(1.55, 1.05), (1.55, 1.95)] {
        add(&mut world, "can", x, y);
    }
    add(&mut world, "crate", 2.4, 1.2);
    with_two(world, Pose::new(0.6, 1.5, 0.0), Pose::new(1.55, 1.65, 0.0))
}

/// A different scene for every seed: the second robot is in front of the first one.
pub(crate) fn drawn(seed: u64) -> Scene {
    let mut stream = Stream::new(seed).child("motion scene", 0);
    let mut world = room();
    for _ in 0..3 + stream.below(4) {
        let name = ["can", "crate", "soccer"][stream.below(3)];
        let y = if stream.chance(0.5) { stream.between(0.25, 0.75) } else { stream.between(2.25, 2.75) };
        add(&mut world, name, stream.between(1.2, 2.7), y);
    }
    let watcher = Pose::new(0.5, 1.5, stream.between(-0.15, 0.15));
    let away = stream.between(0.5, 1.3);
    let aside = stream.between(-0.3, 0.3) * away;
    with_two(world, watcher, Pose::new(0.5 + away, 1.5 + aside, stream.between(-PI, PI)))
}

/// A drawn scene in which the second robot moves in circles, if required.
pub(crate) fn simulated(args: &Args, seed: u64, moves: bool) -> io::Result<Simulation> {
    let options = SimOptions { light: args.light, ..SimOptions::with_noise(args.common.noise, seed) };
    let simulation = Simulation::new(&drawn(seed), options)?;
    let mut stream = Stream::new(seed).child("motion", 0);
    // A robot whose program has ended keeps its speed.
    let mut other = simulation.robot(1)?;
    if moves {
        let speed = stream.between(0.1, 0.3);
        let turn = stream.between(1.0, 2.5) * if stream.chance(0.5) { 1.0 } else { -1.0 };
        other.set_speed(Twist::new(speed, turn))?;
    }
    drop(other);
    Ok(simulation)
}

fn room() -> World {
    let mut world = World::walled(3.0, 3.0);
    let colours = [0xe8_d9_b8, 0xb9_cd_c4, 0xd8_b4_a0, 0xc6_c8_dc].map(Colour::from_hex);
    for (wall, colour) in world.walls.iter_mut().zip(colours) {
        (wall.height, wall.colour) = (0.4, colour);
    }
    let mut skirting = Wall::new(Point::new(2.9, 0.8), Point::new(2.9, 1.6));
    (skirting.height, skirting.colour) = (0.15, Colour::from_hex(0x5a_6b_7c));
    world.walls.push(skirting);
    world
}

fn add(world: &mut World, name: &str, x: f64, y: f64) {
    if let Some(kind) = ObjectKind::predefined(name) {
        world.objects.push(Object::new(Arc::new(kind), Pose::new(x, y, 0.3)));
    }
}

fn with_two(world: World, first: Pose, second: Pose) -> Scene {
    let mut scene = Scene::with_robot(world, RobotSpec::s4(), first);
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::s4()), second));
    scene
}
