use std::f64::consts::PI;
use std::sync::Arc;

use roverlab::geometry::{Point, Pose};
use roverlab::random::Stream;
use roverlab::world::{Colour, Object, ObjectKind, Scene, Shape, Water, World};

use crate::water::{pool, surveyor};

/// Turbidities of the water (1/m): clear, of a pool, of a lake.
pub(super) const TURBIDITIES: [f64; 3] = [0.05, 0.3, 1.0];
/// Sides of a pool (m): its walls are in range of the craft's sensors everywhere.
const WIDTH: [f64; 2] = [5.0, 9.0];
const LENGTH: [f64; 2] = [7.0, 12.0];
/// The most that its floor rises along its length (m).
const RISE: f64 = 0.3;
/// Metres that things keep from the walls, so that the camera passes over them, and from each other.
const MARGIN: f64 = 1.3;
const BETWEEN: f64 = 0.5;
/// Start of the craft (m), and the distance that things keep from it: its radius and half of a thing.
const START: Point = Point::new(1.7, 1.7);
const AROUND_START: f64 = 1.0;
/// Other things, at most, and their colours: orange is the nearest to red.
const OTHERS: usize = 6;
const COLOURS: [(&str, u32); 8] = [
    ("orange", 0xe0_80_10),
    ("yellow", 0xe0_c0_10),
    ("green", 0x30_a0_30),
    ("cyan", 0x20_a0_a0),
    ("blue", 0x20_50_c8),
    ("violet", 0x70_30_b0),
    ("white", 0xf0_f0_f0),
    ("black", 0x20_20_20),
];

/// The turbidity of a seed's water.
pub(super) fn turbidity(seed: u64) -> f64 {
    TURBIDITIES[(seed % 3) as usize]
}

/// The pool of a seed, with something red on its floor, which is the first object.
pub(super) fn scene(seed: u64) -> Scene {
    let mut stream = Stream::new(seed).child("pool search", 0);
    let size = [WIDTH, LENGTH].map(|[least, most]| stream.between(least, most));
    let rise = stream.between(0.0, RISE);
    let water = Water { turbidity: turbidity(seed), ..Water::default() };
    let mut world = World { water, ..pool(size, |at| rise * at.y / size[1]) };
    let mut places = Vec::new();
    put(&mut world, &mut stream, &mut places, size, ("red", 0xc8_20_20));
    for _ in 0..=stream.below(OTHERS) {
        let other = COLOURS[stream.below(COLOURS.len())];
        put(&mut world, &mut stream, &mut places, size, other);
    }
    Scene::with_robot(world, surveyor(), Pose::new(START.x, START.y, 0.5 * PI))
}

/// Puts something on the floor where there is room; nothing after a hundred trials.
fn put(
    world: &mut World,
    stream: &mut Stream,
    places: &mut Vec<Point>,
    size: [f64; 2],
    (name, colour): (&str, u32),
) {
    let shape = if stream.below(2) == 0 {
        Shape::Cylinder { radius: stream.between(0.06, 0.12), height: stream.between(0.05, 0.2) }
    } else {
        Shape::Box {
            length: stream.between(0.12, 0.3),
            width: stream.between(0.12, 0.2),
            height: stream.between(0.05, 0.2),
        }
    };
    for _ in 0..100 {
        let place =
            Point::new(stream.between(MARGIN, size[0] - MARGIN), stream.between(MARGIN, size[1] - MARGIN));
        let is_free = (START - place).norm() > AROUND_START
            && places.iter().all(|other| (other - place).norm() > BETWEEN);
        if is_free {
            // They lie where they are, on a slope too.
            let kind = ObjectKind {
                fixed: true,
                mass: 20.0,
                ..ObjectKind::new(name, shape, Colour::from_hex(colour))
            };
            let pose = Pose::new(place.x, place.y, stream.between(-PI, PI));
            world.objects.push(Object::new(Arc::new(kind), pose));
            places.push(place);
            return;
        }
    }
}
