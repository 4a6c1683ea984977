//! A lidar scan (book, sections 4.1 and 4.2): what one turn of the laser scanner shows of a room with two
//! cans in it. The program finds straight walls, the corners between them, and the objects before them.
//!
//! `cargo run --release --example lidar_scan`

use std::sync::Arc;

use roverlab::geometry::{Point, Pose, units};
use roverlab::io::Lidar;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::picture::{Picture, SERIES, Style};
use roverlab::scan::{ScanFeaturesParameters, extract_features};
use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A room in the shape of an L.
    let mut world = World::empty(3.0, 3.0);
    let outline = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (1.9, 3.0), (1.9, 1.9), (0.0, 1.9)];
    world.add_loop(&outline.map(|(x, y)| Point::new(x, y)));
    let can = Arc::new(ObjectKind::predefined("can").ok_or("no such object")?);
    let cans = [Point::new(0.8, 0.6), Point::new(2.3, 1.2)];
    world.objects.extend(cans.map(|place| Object::new(Arc::clone(&can), Pose::new(place.x, place.y, 0.0))));

    let pose = Pose::new(1.5, 0.9, units::from_deg(60.0));
    let scene = Scene::with_robot(world, RobotSpec::s4(), pose);
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
    let scan = simulation.robot(0)?.scan()?;
    let nearest = scan.ranges.iter().copied().fold(f64::INFINITY, f64::min);
    println!("{} beams; the nearest thing is {nearest:.2} m away", scan.ranges.len());

    let found = extract_features(&scan, &ScanFeaturesParameters::default())?;
    let mut picture = Picture::new(&scene.world);
    picture.title("Walls, corners and objects in one scan");
    picture.points(scan.points().map(|point| pose.to_world(point)), Style::lidar());
    for wall in &found.walls {
        println!("wall   {:.2} m long, hit by {} beams", wall.line.length, wall.line.points);
        let style = Style::new(Colour::from_hex(0xd0_60_10)).width(3.0).labelled("wall");
        picture.line(wall.ends.map(|end| pose.to_world(end)), style);
    }
    // Features are in the robot's frame, as the scan is; the robot's pose takes them to the world.
    for corner in &found.corners {
        let (place, angle) = (pose.to_world(corner.position), units::to_deg(corner.angle));
        println!("corner at ({:.2}, {:.2}) m, {angle:.0} degrees", place.x, place.y);
        picture.disc(place, 0.05, Style::new(SERIES[1]).width(3.0).labelled("corner"));
    }
    for object in &found.objects {
        let (place, radius) = (pose.to_world(object.centre), units::to_mm(object.radius));
        println!("object at ({:.2}, {:.2}) m, radius {radius:.0} mm", place.x, place.y);
        picture.disc(place, object.radius, Style::new(SERIES[2]).filled(0.3).labelled("object"));
        assert!(cans.iter().any(|can| (can - place).norm() < 0.03), "there is no can");
    }
    // The corner that stands into the room hides one wall; a can parts another one in two.
    assert_eq!((found.walls.len(), found.corners.len(), found.objects.len()), (6, 4, 2));
    picture.robot(pose, &RobotSpec::s4().footprint);
    picture.save("target/pictures/lidar_scan.svg")?;
    Ok(())
}
