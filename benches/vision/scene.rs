use std::sync::Arc;

use image::RgbImage;
use roverlab::geometry::Pose;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{self, Camera, Clock, Manoeuvres, Resolution};
use roverlab::random::Stream;
use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, Shape, World};

/// Two images of the simulated camera, a tenth of a second apart, with the noise of the real one.
pub(crate) struct Pair {
    pub(crate) first: RgbImage,
    pub(crate) second: RgbImage,
}

/// A room with things in all colours, red ones among them.
pub(crate) fn images(size: (u32, u32)) -> io::Result<Pair> {
    let mut world = World::walled(4.0, 3.0);
    let mut stream = Stream::new(11);
    for wall in &mut world.walls {
        (wall.height, wall.colour) = (0.4, Colour::from_hex(0xd8_c8_a8));
    }
    for i in 0..40_u32 {
        let size = stream.between(0.03, 0.1);
        let shape = match i % 3 {
            0 => Shape::Cylinder { radius: size, height: 2.5 * size },
            1 => Shape::Sphere { radius: size },
            _ => Shape::Box { length: size, width: 2.0 * size, height: 1.5 * size },
        };
        let any = Colour::from_hex((stream.bits() & 0xff_ff_ff) as u32);
        let colour = if i % 5 == 0 { Colour::RED } else { any };
        let kind = Arc::new(ObjectKind::new("thing", shape, colour));
        let pose = Pose::new(stream.between(1.0, 3.8), stream.between(0.3, 2.7), stream.between(-3.0, 3.0));
        world.objects.push(Object::new(kind, pose));
    }
    let scene = Scene::with_robot(world, RobotSpec::s4(), Pose::new(0.4, 1.5, 0.0));
    let mut robot = Simulation::new(&scene, SimOptions::default())?.robot(0)?;
    let resolution = Resolution::ALL.into_iter().find(|resolution| resolution.dimensions() == size);
    robot.set_resolution(resolution.unwrap_or_default())?;
    let first = robot.image()?;
    robot.turn(0.05, 1.0)?;
    robot.wait(0.1)?;
    Ok(Pair { first, second: robot.image()? })
}
