//! Driving by colour (book, section 11.4): a robot is shown the hue of a red can, looks for it among things
//! of other colours, and drives up to it. The camera finds the can; the lidar says how far away it is.
//!
//! `cargo run --release --example color_tracking`

use std::sync::Arc;

use roverlab::drive::colour::{ColourOutcome, ColourPhase, ColourTracker, ColourTrackerParameters};
use roverlab::geometry::Pose;
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::picture::{Mark, Picture};
use roverlab::vision::{ColourFinder, FindMethod, HueScale, hue};
use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, Shape, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = World::walled(3.0, 3.0);
    let can = Shape::Cylinder { radius: 0.033, height: 0.115 };
    let block = Shape::Box { length: 0.2, width: 0.15, height: 0.2 };
    for (shape, colour, x, y) in [
        (can, Colour::RED, 2.4, 2.3),
        (can, Colour::from_hex(0x20_50_c8), 1.8, 0.6),
        (block, Colour::from_hex(0x30_a0_30), 1.5, 1.6),
        (Shape::Sphere { radius: 0.1 }, Colour::from_hex(0xe0_c0_10), 0.8, 2.2),
    ] {
        let kind = ObjectKind::new("thing", shape, colour);
        world.objects.push(Object::new(Arc::new(kind), Pose::new(x, y, 0.3)));
    }
    let target = world.objects[0].pose.position();
    // The robot starts with its back to the can.
    let (spec, start) = (RobotSpec::s4(), Pose::new(0.5, 0.5, -2.4));
    let scene = Scene::with_robot(world, spec.clone(), start);
    let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(&scene, options)?;

    let red = hue([200, 30, 30], HueScale::Robios, ColourFinder::LIMITS);
    let camera = spec.camera.as_ref().ok_or("the robot has no camera")?;
    let finder = ColourFinder::new(red, 12, FindMethod::Blob, camera.into())?;
    let mut tracker = ColourTracker::new(finder, ColourTrackerParameters::default())?;
    let (mut time, mut phase, mut first) = (0.0, ColourPhase::Searching, None);
    let outcome = run(&mut simulation.robot(0)?, &mut tracker, 120.0, |_, tracker, _| {
        time = simulation.truth().time();
        if first.is_none() {
            first = tracker.sighting().map(|seen| (time, seen.pixels));
        }
        if tracker.phase() != phase {
            phase = tracker.phase();
            println!("{time:5.1} s: {phase:?}");
        }
    })?;

    let truth = simulation.truth().robot(0)?;
    let (seen_at, pixels) = first.ok_or("the can was never seen")?;
    let gap = truth.pose.distance_to(target) - 0.033 - spec.footprint.bounding_radius();
    println!("First seen after {seen_at:.1} s, {pixels} pixels large.");
    println!(
        "{outcome:?} after {time:.1} s and {:.1} m: {:.0} mm before the can",
        truth.path_length,
        1000.0 * gap
    );
    assert_eq!((outcome, truth.contacts), (ColourOutcome::Reached, 0));
    assert!(pixels > 10 && gap > 0.0 && gap < 0.15);

    let mut picture = Picture::new(&scene.world);
    picture.title("To the red can").mark(Mark::Start, start.position());
    picture.true_path(truth.trail.iter().map(|point| point.pose.position()));
    picture.robot(truth.pose, &spec.footprint);
    picture.save("target/pictures/color_tracking.svg")?;
    Ok(())
}
