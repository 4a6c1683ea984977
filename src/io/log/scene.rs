//! The world for viewers: `foxglove.SceneUpdate`.

use std::io::Write;

use super::LogWriter;
use super::messages::{transform, write_pose};
use super::topics::{SCENE, TRANSFORMS, WORLD, odometry_frame};
use super::wire::Fields;
use crate::geometry::{Pose, math};
use crate::world::{Colour, Marker, Object, Scene, Shape, Wall};

// Field numbers in `foxglove.SceneEntity`.
/// Field for boxes.
const CUBES: u32 = 8;
/// Field for balls.
const SPHERES: u32 = 9;
/// Field for cylinders.
const CYLINDERS: u32 = 10;

impl<W: Write> LogWriter<W> {
    /// Writes the content of a scene, and its robots' start poses, for viewers. Call it at the beginning.
    pub fn show(&self, scene: &Scene) {
        let mut message = Vec::new();
        scene_update(&mut Fields(&mut message), scene);
        self.push(0, Some(0), SCENE, &message);
        for (index, robot) in scene.robots.iter().enumerate() {
            message.clear();
            let child = odometry_frame(index);
            transform(&mut Fields(&mut message), 0, WORLD, &child, &robot.pose);
            self.push(index, Some(0), TRANSFORMS, &message);
        }
    }
}

/// Walls, objects and marks of a scene, as permanent entities.
pub(super) fn scene_update(out: &mut Fields<'_>, scene: &Scene) {
    let world = &scene.world;
    entity(out, "floor", |entity| {
        let size = world.floor.max - world.floor.min;
        let middle = world.floor.min + 0.5 * size;
        let pose = Pose::new(middle.x, middle.y, 0.0);
        solid(entity, CUBES, &pose, -0.5 * THIN, [size.x, size.y, THIN], Colour::from_hex(0xe6_e6_e6), 1.0);
    });
    entity(out, "walls", |entity| world.walls.iter().for_each(|item| wall(entity, item)));
    entity(out, "marks", |entity| world.markers.iter().for_each(|item| mark(entity, item)));
    for (index, item) in world.objects.iter().enumerate() {
        entity(out, &format!("object {}", index + 1), |entity| object(entity, item));
    }
}

/// Thickness of flat things on the floor (m).
const THIN: f64 = 0.002;

/// A `foxglove.SceneEntity`.
fn entity(out: &mut Fields<'_>, id: &str, fill: impl FnOnce(&mut Fields<'_>)) {
    out.message(2, |entity| {
        entity.time(1, 0);
        entity.text(2, WORLD);
        entity.text(3, id);
        entity.time(4, 0);
        fill(entity);
    });
}

fn wall(entity: &mut Fields<'_>, wall: &Wall) {
    let along = wall.line.b - wall.line.a;
    let middle = wall.line.a + 0.5 * along;
    let pose = Pose::new(middle.x, middle.y, math::atan2(along.y, along.x));
    let size = [wall.line.length(), wall.thickness, wall.height];
    // White walls would be invisible on a white ground.
    let colour = if wall.colour == Colour::WHITE { Colour::from_hex(0xb4_b4_b4) } else { wall.colour };
    solid(entity, CUBES, &pose, 0.5 * wall.height, size, colour, 1.0);
}

fn mark(entity: &mut Fields<'_>, mark: &Marker) {
    /// Width of a marker (m).
    const WIDTH: f64 = 0.1;
    let pose = Pose::new(mark.position.x, mark.position.y, 0.0);
    let opacity = f64::from(mark.alpha) / 255.0;
    solid(entity, CYLINDERS, &pose, THIN, [WIDTH, WIDTH, THIN], mark.colour, opacity);
}

fn object(entity: &mut Fields<'_>, object: &Object) {
    let shape = object.kind.shape;
    let (field, across) = match shape {
        Shape::Cylinder { radius, .. } | Shape::Cone { radius, .. } => {
            (CYLINDERS, [2.0 * radius, 2.0 * radius])
        }
        Shape::Sphere { radius } => (SPHERES, [2.0 * radius, 2.0 * radius]),
        Shape::Box { length, width, .. } => (CUBES, [length, width]),
    };
    let size = [across[0], across[1], shape.height()];
    let middle = object.elevation + 0.5 * shape.height();
    solid(entity, field, &object.pose, middle, size, object.kind.colour, 1.0);
}

/// A cube, sphere or cylinder primitive at a height above the floor.
fn solid(
    entity: &mut Fields<'_>,
    field: u32,
    pose: &Pose,
    middle: f64,
    size: [f64; 3],
    colour: Colour,
    opacity: f64,
) {
    entity.message(field, |solid| {
        solid.message(1, |out| write_pose(out, pose, middle));
        solid.vector(2, size[0], size[1], size[2]);
        let colour_field = if field == CYLINDERS { 5 } else { 3 };
        if field == CYLINDERS {
            solid.double(3, 1.0);
            solid.double(4, 1.0);
        }
        solid.message(colour_field, |out| {
            for (number, channel) in [(1, colour.red), (2, colour.green), (3, colour.blue)] {
                out.double(number, f64::from(channel) / 255.0);
            }
            out.double(4, opacity);
        });
    });
}
