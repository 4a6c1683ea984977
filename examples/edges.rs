//! Edges and lines (book, sections 11.2 and 11.3): an image of the robot's camera is smoothed, Canny's
//! detector finds its edges, and the Hough transform the straight lines among them.
//!
//! `cargo run --release --example edges`

use std::sync::Arc;

use roverlab::geometry::Pose;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Camera, Resolution};
use roverlab::vision::{
    Border, Canny, CannyThresholds, GaussianKernel, HoughSegments, SegmentParameters, SobelScale,
    gaussian_into, sobel_l1_into,
};
use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = World::walled(3.0, 2.0);
    for (wall, colour) in world.walls.iter_mut().zip([0x90_90_90, 0xe0_d8_c8, 0x80_98_b0, 0xc0_c0_c0]) {
        (wall.height, wall.colour) = (0.3, Colour::from_hex(colour));
    }
    for (name, x, y) in [("crate", 1.5, 0.8), ("can", 1.0, 1.25)] {
        let kind = ObjectKind::predefined(name).ok_or("no such object")?;
        world.objects.push(Object::new(Arc::new(kind), Pose::new(x, y, 0.5)));
    }
    let scene = Scene::with_robot(world, RobotSpec::s4(), Pose::new(0.4, 1.0, 0.0));
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
    let mut robot = simulation.robot(0)?;
    robot.set_resolution(Resolution::Qvga)?;
    let image = robot.gray_image()?;

    // Kernels read one image and write another one of the same size; both are views of the caller's memory.
    let (mut smooth, mut gradient, mut edges) = (image.clone(), image.clone(), image.clone());
    gaussian_into((&image).try_into()?, (&mut smooth).try_into()?, GaussianKernel::FIVE)?;
    sobel_l1_into((&smooth).try_into()?, (&mut gradient).try_into()?, SobelScale::Full, Border::Zero)?;
    Canny::new().find_into((&smooth).try_into()?, (&mut edges).try_into()?, CannyThresholds::default())?;
    let [strong, thin] =
        [&gradient, &edges].map(|image| image.pixels().filter(|pixel| pixel.0[0] > 100).count());
    println!("{strong} pixels with a strong gradient, thinned to {thin} pixels of edges");

    let parameters = SegmentParameters { min_length: 40, ..SegmentParameters::default() };
    let lines = HoughSegments::new(180)?.find((&edges).try_into()?, parameters);
    for line in &lines {
        println!("line from {:?} to {:?}", line.from, line.to);
    }
    assert!(thin > 300 && thin < strong && !lines.is_empty());
    // The crate's left edge is upright: hardly any columns, many rows.
    assert!(
        lines.iter().any(|line| line.from.0.abs_diff(line.to.0) < 4 && line.from.1.abs_diff(line.to.1) > 40)
    );
    std::fs::create_dir_all("target/pictures")?;
    image.save("target/pictures/edges_image.png")?;
    edges.save("target/pictures/edges.png")?;
    Ok(())
}
