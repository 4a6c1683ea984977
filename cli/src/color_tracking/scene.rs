use std::f64::consts::PI;
use std::sync::Arc;

use image::{Rgba, RgbaImage};
use roverlab::geometry::{Point, Pose, direction};
use roverlab::random::Stream;
use roverlab::world::{Billboard, Colour, Object, ObjectKind, RobotSpec, Scene, Shape, World};

/// Side length of the room, and minimum distance between the rims of two objects (m).
const ROOM: f64 = 4.0;
const BETWEEN: f64 = 0.35;
/// Colours of other objects.
const OTHERS: [(&str, u32); 6] = [
    ("yellow", 0xe0_c0_10),
    ("green", 0x30_a0_30),
    ("cyan", 0x20_a0_a0),
    ("blue", 0x20_50_c8),
    ("violet", 0x70_30_b0),
    ("sea-green", 0x10_80_50),
];

/// A room with a red can and objects of other hues, placed by the seed. The can is the first object.
pub(crate) fn drawn(seed: u64) -> Scene {
    let mut stream = Stream::new(seed).child("colour scene", 0);
    let mut world = World::walled(ROOM, ROOM);
    for wall in &mut world.walls {
        wall.height = 0.3;
    }
    // In a corner, with a random heading.
    let start = Pose::new(0.5, 0.5, stream.between(-PI, PI));
    let mut places = vec![(start.position(), 0.2)];
    let can = ObjectKind::predefined("can").unwrap_or_else(|| ObjectKind::new("can", CAN, Colour::RED));
    add(&mut world, &mut stream, &mut places, can, 1.0);
    for _ in 0..3 + stream.below(5) {
        let (hue, colour) = OTHERS[stream.below(OTHERS.len())];
        let (form, shape) = match stream.below(3) {
            0 => ("can", CAN),
            1 => ("ball", Shape::Sphere { radius: stream.between(0.05, 0.12) }),
            _ => ("box", Shape::Box { length: 0.2, width: 0.15, height: stream.between(0.08, 0.25) }),
        };
        let kind = ObjectKind::new(format!("{hue} {form}"), shape, Colour::from_hex(colour));
        add(&mut world, &mut stream, &mut places, kind, 0.0);
    }
    Scene::with_robot(world, RobotSpec::s4(), start)
}

const CAN: Shape = Shape::Cylinder { radius: 0.033, height: 0.115 };

/// Places an object where there is room, at a minimum distance from the start.
fn add(
    world: &mut World,
    stream: &mut Stream,
    places: &mut Vec<(Point, f64)>,
    kind: ObjectKind,
    from_start: f64,
) {
    let radius = kind.shape.bounding_radius();
    let margin = 0.35 + radius;
    for _ in 0..1000 {
        let place = Point::new(stream.between(margin, ROOM - margin), stream.between(margin, ROOM - margin));
        let free = places.iter().all(|(other, size)| (place - other).norm() > radius + size + BETWEEN);
        if free && (place - places[0].0).norm() > from_start {
            let pose = Pose::new(place.x, place.y, stream.between(-PI, PI));
            world.objects.push(Object::new(Arc::new(kind), pose));
            places.push((place, radius));
            return;
        }
    }
}

/// A coloured card in front of the robot's camera, to teach the hue.
pub(crate) fn card(start: Pose, colour: Colour) -> Billboard {
    let place = start.position() + direction(start.heading) * 0.25;
    let Colour { red, green, blue } = colour;
    Billboard {
        pose: Pose::new(place.x, place.y, start.heading + PI),
        width: 0.14,
        height: 0.14,
        elevation: 0.0,
        image: Arc::new(RgbaImage::from_pixel(2, 2, Rgba([red, green, blue, 255]))),
    }
}
