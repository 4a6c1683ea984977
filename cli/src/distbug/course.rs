use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use roverlab::geometry::{Point, Pose, direction, units};
use roverlab::world::{Colour, Marker, Object, ObjectKind, RobotSpec, Scene, Wall, World};

/// The command's default world, 4.5 m by 4.5 m, with a robot and a marker at its goal. In between are a C, a
/// crescent, a hook and a room with a door on the far side.
pub(crate) fn scene() -> Scene {
    let mut world = World::walled(4.5, 4.5);
    c_shape(&mut world);
    crescent(&mut world);
    hook(&mut world);
    room(&mut world);
    bystanders(&mut world);
    for (kind, x, y, heading) in
        [("crate", 1150.0, 3950.0, 20.0), ("can", 2450.0, 700.0, 0.0), ("soccer", 3900.0, 600.0, 0.0)]
    {
        let kind = ObjectKind::predefined(kind).expect("a kind that every scene knows");
        world.objects.push(Object::new(Arc::new(kind), Pose::from_mm_deg(x, y, heading)));
    }
    let position = at(3850.0, 3850.0);
    world.markers.push(Marker { position, colour: Colour::GREEN, alpha: 255 });
    Scene::with_robot(world, RobotSpec::s4(), Pose::from_mm_deg(500.0, 500.0, 0.0))
}

fn at(x: f64, y: f64) -> Point {
    Point::new(units::from_mm(x), units::from_mm(y))
}

/// Walls along a polyline, in millimetres.
fn add_line(world: &mut World, points: &[(f64, f64)]) {
    world.walls.extend(points.windows(2).map(|ends| {
        let [a, b] = [ends[0], ends[1]].map(|(x, y)| at(x, y));
        Wall::new(a, b)
    }));
}

/// A C that opens towards the robot, which drives into it.
fn c_shape(world: &mut World) {
    add_line(world, &[(950.0, 1500.0), (1550.0, 1500.0), (1550.0, 850.0), (1100.0, 850.0)]);
}

/// A thick arc, concave towards the robot.
fn crescent(world: &mut World) {
    let (middle, pieces) = (at(2150.0, 2000.0), 24);
    let arc = |radius: f64, shift: f64, reach: f64| {
        let middle = middle + direction(0.25 * PI) * shift;
        (0..=pieces).map(move |i| {
            let share = f64::from(i) / f64::from(pieces) - 0.5;
            middle + direction(0.25 * PI + share * reach) * radius
        })
    };
    let outer: Vec<Point> = arc(0.75, 0.0, 0.55 * TAU).collect();
    let inner: Vec<Point> = arc(0.60, -0.05, 0.55 * TAU).collect();
    let mut outline = outer;
    outline.extend(inner.into_iter().rev());
    world.add_loop(&outline);
}

/// A cup that opens towards the robot, with its rim bent inwards.
fn hook(world: &mut World) {
    add_line(world, &[(2750.0, 2900.0), (2750.0, 3500.0), (2250.0, 3500.0), (2250.0, 3250.0)]);
}

/// A zigzag and a block that the robot passes.
fn bystanders(world: &mut World) {
    add_line(world, &[(500.0, 2500.0), (900.0, 2750.0), (500.0, 3000.0), (900.0, 3250.0)]);
    let block = (0..6).map(|i| at(3400.0, 1500.0) + direction(TAU * (f64::from(i) + 0.3) / 6.0) * 0.34);
    world.add_loop(&block.collect::<Vec<_>>());
}

/// A room around the goal, with its door facing away from the robot.
fn room(world: &mut World) {
    add_line(
        world,
        &[(4150.0, 4200.0), (3350.0, 4200.0), (3350.0, 3350.0), (4250.0, 3350.0), (4250.0, 3700.0)],
    );
}
