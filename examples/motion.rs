//! Seeing motion (book, section 11.5): a robot compares each image of its camera with the one before, and
//! turns to where something moves. The other robot stands for two seconds, and then drives in a circle.
//!
//! `cargo run --release --example motion`

use std::ops::ControlFlow;
use std::sync::Arc;

use roverlab::drive::motion_watch::{MotionWatch, MotionWatchParameters};
use roverlab::geometry::{Pose, Twist, units};
use roverlab::io::sim::{Fleet, SimOptions};
use roverlab::io::{Camera, Clock, Drive, Error, ErrorKind, Odometry};
use roverlab::picture::{Mark, Picture};
use roverlab::world::{Colour, Object, ObjectKind, RobotPlacement, RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = World::walled(3.0, 3.0);
    for (wall, colour) in world.walls.iter_mut().zip([0xe8_d9_b8, 0xb9_cd_c4, 0xd8_b4_a0, 0xc6_c8_dc]) {
        (wall.height, wall.colour) = (0.4, Colour::from_hex(colour));
    }
    let crates = Arc::new(ObjectKind::predefined("crate").ok_or("no such object")?);
    world.objects.push(Object::new(crates, Pose::new(2.4, 1.2, 0.3)));
    let spec = Arc::new(RobotSpec::s4());
    let field_of_view = spec.camera.ok_or("the robot has no camera")?.field_of_view;
    let (watcher, mover) = (Pose::new(0.6, 1.5, 0.0), Pose::new(1.5, 1.7, 0.0));
    let mut scene = Scene::new(world);
    scene.robots.extend([watcher, mover].map(|pose| RobotPlacement::new(Arc::clone(&spec), pose)));

    let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::with_noise(1.0, 1) };
    let parameters = MotionWatchParameters::new(field_of_view);
    let mut watch = MotionWatch::new(parameters)?;
    // The time of each image in which something moved, and where: left, in the middle, right.
    let alarms = std::cell::RefCell::new(Vec::new());
    let mut fleet = Fleet::new(&scene, options)?;
    fleet.control(0, parameters.period, |robot| {
        let (time, image, pose) = (robot.now()?, robot.gray_image()?, robot.pose()?);
        let twist = watch.step(time, &image, pose);
        robot.set_speed(twist.map_err(|error| Error::new(ErrorKind::Other, error.to_string()))?)?;
        if let Some(sector) = watch.motion().and_then(|motion| motion.strongest) {
            alarms.borrow_mut().push((time, sector));
        }
        Ok(ControlFlow::Continue(()))
    })?;
    fleet.control(1, 0.1, |robot| {
        if robot.now()? >= 2.0 {
            robot.set_speed(Twist::new(0.2, 0.8))?;
        }
        Ok(ControlFlow::Continue(()))
    })?;
    fleet.run_for(10.0)?;

    let [watching, moving] = [fleet.truth(0)?, fleet.truth(1)?];
    let alarms = alarms.borrow();
    let (first, sector) = *alarms.first().ok_or("no motion was seen")?;
    let side = ["left", "middle", "right"][sector];
    println!("motion in {} of 100 images, first after {first:.1} s in the {side} of the image", alarms.len());
    let off = units::to_deg(watching.pose.bearing_to(moving.pose.position()));
    println!("in the end the other robot is {off:+.0} degrees from straight ahead");
    // No alarm while everything stood still; since then the watcher has kept the other robot in sight.
    assert!(first > 2.0 && first < 3.0 && alarms.len() > 20);
    assert!(off.abs() < 0.5 * units::to_deg(field_of_view));

    let mut picture = Picture::new(&scene.world);
    picture.title("A robot watches another one").mark(Mark::Start, mover.position());
    picture.robot(watching.pose, &spec.footprint).robot(moving.pose, &spec.footprint);
    picture.true_path(moving.trail.iter().map(|point| point.pose.position()));
    picture.save("target/pictures/motion.svg")?;
    Ok(())
}
