//! Images of the simulated camera: a room with 50 things in it, and a course of a model road.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use image::RgbImage;
use roverlab::geometry::Pose;
use roverlab::io::sim::{SimOptions, SimRobot, Simulation};
use roverlab::io::{Camera, Clock, Resolution};
use roverlab::random::Stream;
use roverlab::world::road::{Appearance, RoadCourseOptions, generate};
use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, Shape, World};

/// A robot in a corner of a room with 50 things before it.
fn scene() -> Scene {
    let mut world = World::walled(4.0, 4.0);
    let mut stream = Stream::new(7);
    for i in 0..50_u32 {
        let size = stream.between(0.03, 0.12);
        let shape = match i % 3 {
            0 => Shape::Cylinder { radius: size, height: 2.5 * size },
            1 => Shape::Sphere { radius: size },
            _ => Shape::Box { length: size, width: 2.0 * size, height: 1.5 * size },
        };
        let colour = Colour::from_hex((stream.bits() & 0xff_ff_ff) as u32);
        let kind = Arc::new(ObjectKind::new("thing", shape, colour));
        let pose = Pose::new(stream.between(0.9, 3.8), stream.between(0.3, 3.8), stream.between(-3.0, 3.0));
        world.objects.push(Object::new(kind, pose));
    }
    Scene::with_robot(world, RobotSpec::s4(), Pose::new(0.4, 2.0, 0.0))
}

fn robot(options: SimOptions, resolution: Resolution) -> SimRobot {
    let mut robot = Simulation::new(&scene(), options).and_then(|s| s.robot(0)).expect("a robot");
    robot.set_resolution(resolution).expect("a camera");
    robot
}

fn images(c: &mut Criterion) {
    let mut group = c.benchmark_group("camera, 50 things");
    group.throughput(Throughput::Elements(1));
    for resolution in [Resolution::Qqvga, Resolution::Qvga, Resolution::Vga, Resolution::CamHd] {
        for (name, options) in [("ideal", SimOptions::ideal()), ("noise 1", SimOptions::default())] {
            let mut robot = robot(options.clone(), resolution);
            let mut image = RgbImage::default();
            robot.image_into(&mut image).expect("an image");
            assert_eq!(image.dimensions(), resolution.dimensions());
            // Things, floor and sky: many colours.
            let colours: std::collections::BTreeSet<[u8; 3]> = image.pixels().map(|pixel| pixel.0).collect();
            assert!(colours.len() > 50, "{} colours", colours.len());
            group.bench_function(format!("{resolution:?}, {name}"), |b| {
                b.iter(|| {
                    // The next frame: until then the image is the same.
                    robot.wait(0.04)?;
                    robot.image_into(black_box(&mut image))
                });
            });
        }
    }
    group.finish();
}

/// A car that stands on a course with patches of light and worn paint.
fn roads(c: &mut Criterion) {
    let course = generate(3, &RoadCourseOptions::default()).expect("a course");
    let world = course.world(&Appearance { wear: 0.2, glare: 2, ..Appearance::default() }).expect("a world");
    let scene = Scene::with_robot(world, RobotSpec::road_car(), course.start());
    let mut group = c.benchmark_group("camera, a course");
    group.throughput(Throughput::Elements(1));
    for (name, options) in [("ideal", SimOptions::ideal()), ("noise 1", SimOptions::default())] {
        let mut car = Simulation::new(&scene, options).and_then(|s| s.robot(0)).expect("a car");
        let mut image = RgbImage::default();
        car.set_resolution(Resolution::Qvga).expect("a camera");
        car.image_into(&mut image).expect("an image");
        group.bench_function(format!("Qvga, {name}"), |b| {
            b.iter(|| {
                // The next frame: until then the image is the same.
                car.wait(0.04)?;
                car.image_into(black_box(&mut image))
            });
        });
    }
    group.finish();
}

criterion_group!(benches, images, roads);
criterion_main!(benches);
