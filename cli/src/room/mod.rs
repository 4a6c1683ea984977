//! A room with interesting views: coloured walls, objects, a figure, a sign, and another robot.

use std::f64::consts::PI;
use std::sync::Arc;

use image::{Rgba, RgbaImage};
use roverlab::geometry::{Point, Pose};
use roverlab::world::{
    Billboard, Colour, Marker, Object, ObjectKind, RobotPlacement, RobotSpec, Scene, Shape, Wall, World,
};

/// Four metres by three, with the robot near the west side, looking east.
pub(crate) fn scene() -> Scene {
    let mut world = World::walled(4.0, 3.0);
    let colours = [0xe8_d9_b8, 0xb9_cd_c4, 0xd8_b4_a0, 0xc6_c8_dc].map(Colour::from_hex);
    for (wall, colour) in world.walls.iter_mut().zip(colours) {
        (wall.height, wall.colour) = (0.5, colour);
    }
    let mut screen = Wall::new(Point::new(2.6, 0.35), Point::new(3.0, 0.95));
    (screen.height, screen.colour) = (0.3, Colour::from_hex(0x7f_9a_6b));
    world.walls.push(screen);
    for (name, x, y) in [
        ("can", 1.6, 1.55),
        ("can", 3.1, 1.1),
        ("soccer", 2.2, 1.95),
        ("golf", 1.25, 1.3),
        ("crate", 2.7, 2.35),
    ] {
        if let Some(kind) = ObjectKind::predefined(name) {
            world.objects.push(Object::new(Arc::new(kind), Pose::new(x, y, 0.5)));
        }
    }
    let pole = Shape::Cylinder { radius: 0.05, height: 0.4 };
    let pole = Arc::new(ObjectKind::new("pole", pole, Colour::from_hex(0x1f_7a_c0)));
    world.objects.push(Object::new(pole, Pose::new(2.0, 0.8, 0.0)));
    world.markers.push(Marker { position: Point::new(1.2, 1.7), colour: Colour::GREEN, alpha: 200 });
    world.billboards = vec![board(3.4, 2.0, 0.22, 0.36, figure()), board(2.35, 1.3, 0.14, 0.24, stop_sign())];
    let mut scene = Scene::with_robot(world, RobotSpec::s4(), Pose::new(0.5, 1.5, 0.0));
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::labbot()), Pose::new(1.9, 1.2, 2.5)));
    scene
}

/// A picture that faces west.
fn board(x: f64, y: f64, width: f64, height: f64, image: RgbaImage) -> Billboard {
    Billboard { pose: Pose::new(x, y, PI), width, height, elevation: 0.0, image: Arc::new(image) }
}

/// A person in a yellow coat: head, body and legs in a picture of 44 x 72 pixels.
fn figure() -> RgbaImage {
    RgbaImage::from_fn(44, 72, |x, y| {
        let (dx, dy) = (f64::from(x) - 21.5, f64::from(y));
        let within = |cx: f64, cy: f64, rx: f64, ry: f64| {
            let (u, v) = ((dx - cx) / rx, (dy - cy) / ry);
            u * u + v * v <= 1.0
        };
        if within(0.0, 9.0, 8.0, 9.0) {
            Rgba([224, 172, 140, 255])
        } else if within(0.0, 36.0, 15.0, 20.0) {
            Rgba([226, 190, 40, 255])
        } else if dy > 48.0 && (3.0..10.0).contains(&dx.abs()) {
            Rgba([52, 60, 92, 255])
        } else {
            Rgba([0; 4])
        }
    })
}

/// A red octagon with a white bar, on a pole: 56 x 96 pixels.
fn stop_sign() -> RgbaImage {
    RgbaImage::from_fn(56, 96, |x, y| {
        let (dx, dy) = ((f64::from(x) - 27.5).abs(), (f64::from(y) - 27.5).abs());
        let octagon = |reach: f64| dx <= reach && dy <= reach && dx + dy <= 1.414 * reach;
        if octagon(27.5) {
            let bar = dx < 18.0 && dy < 5.0;
            if bar || !octagon(25.0) { Rgba([244, 244, 244, 255]) } else { Rgba([190, 24, 30, 255]) }
        } else if y > 50 && dx < 3.0 {
            Rgba([120, 124, 130, 255])
        } else {
            Rgba([0; 4])
        }
    })
}
