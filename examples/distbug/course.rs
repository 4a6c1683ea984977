use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use roverlab::geometry::{Point, Pose, direction, units};
use roverlab::world::{Colour, Marker, Object, ObjectKind, RobotSpec, Scene, Wall, World};

/// The example's own world, 4.5 m by 4.5 m, with a robot and a marker at its goal: a C, a crescent, a hook and a room
/// with a door on the far side lie between them.
pub(crate) fn scene() -> Scene {
    let mut world = World::walled(4.5, 4.5);
    c_shape(&mut world);
    crescent(&mut world);
    hook(&mut world);
    room(&mut world);
    for (kind, x, y, heading) in
        [("crate", 420.0, 3500.0, 20.0), ("can", 2450.0, 820.0, 0.0), ("can", 4050.0, 900.0, 0.0)]
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

/// Walls along a line through points in millimetres.
fn add_line(world: &mut World, points: &[(f64, f64)]) {
    world.walls.extend(points.windows(2).map(|ends| {
        let [a, b] = [ends[0], ends[1]].map(|(x, y)| at(x, y));
        Wall::new(a, b)
    }));
}

/// Opens towards the robot, which drives into it.
fn c_shape(world: &mut World) {
    add_line(world, &[(950.0, 1500.0), (1550.0, 1500.0), (1550.0, 850.0), (1100.0, 850.0)]);
}

/// Two arcs that meet in points, the hollow side towards the robot.
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

/// A zig-zag with a hook at its end.
fn hook(world: &mut World) {
    add_line(world, &[(1300.0, 4100.0), (1300.0, 3500.0), (1900.0, 3500.0), (1900.0, 3150.0)]);
}

/// A room around the goal, whose door looks away from the robot.
fn room(world: &mut World) {
    add_line(
        world,
        &[(4150.0, 4200.0), (3350.0, 4200.0), (3350.0, 3350.0), (4250.0, 3350.0), (4250.0, 3700.0)],
    );
}
