//! Random drive (book, section 3.1): three robots drive straight on, and turn by a random angle where
//! something is ahead. None of them touches a wall or another robot.
//!
//! `cargo run --release --example random_drive`

use std::sync::Arc;

use roverlab::drive::{RandomDrive, RandomDriveParameters};
use roverlab::geometry::Pose;
use roverlab::io::control::{Behaviour, Run};
use roverlab::io::sim::{Fleet, SimOptions};
use roverlab::picture::{Mark, Picture};
use roverlab::random::Stream;
use roverlab::world::{Object, ObjectKind, RobotPlacement, RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = World::walled(3.0, 2.4);
    let crates = Arc::new(ObjectKind::predefined("crate").ok_or("no such object")?);
    for (x, y) in [(1.1, 0.7), (2.2, 1.7)] {
        world.objects.push(Object::new(Arc::clone(&crates), Pose::new(x, y, 0.4)));
    }
    let mut scene = Scene::new(world);
    for (x, y, spec) in
        [(0.4, 0.4, RobotSpec::s4()), (0.7, 1.4, RobotSpec::labbot()), (2.5, 0.5, RobotSpec::s4())]
    {
        scene.robots.push(RobotPlacement::new(Arc::new(spec), Pose::new(x, y, 0.0)));
    }

    // A fleet steps all robots in one thread: each behaviour is called anew whenever its period is over.
    let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::with_noise(1.0, 1) };
    let mut fleet = Fleet::new(&scene, options)?;
    for (index, robot) in scene.robots.iter().enumerate() {
        let radius = robot.spec.footprint.bounding_radius();
        let parameters = RandomDriveParameters { radius, ..RandomDriveParameters::default() };
        // Each robot draws from a random stream of its own, so none changes what another one does.
        let mut behaviour = RandomDrive::new(parameters, Stream::new(1).child("robot", index as u64))?;
        let mut run = Run::new(&behaviour, f64::INFINITY)?;
        fleet.control(index, behaviour.period(), move |robot| {
            Ok(run.step(robot, &mut behaviour)?.map_break(|outcome| println!("{outcome:?}")))
        })?;
    }
    fleet.run_for(120.0)?;

    let mut picture = Picture::new(&scene.world);
    picture.title("Random drive: two minutes of three robots");
    for (index, robot) in scene.robots.iter().enumerate() {
        let truth = fleet.truth(index)?;
        let name = &robot.spec.name;
        println!("robot {index} ({name}) drove {:.1} m in {:.0} s", truth.path_length, fleet.time());
        assert!(truth.contacts == 0 && truth.path_length > 5.0, "robot {index}");
        picture.true_path(truth.trail.iter().map(|point| point.pose.position()));
        picture.mark(Mark::Start, robot.pose.position()).robot(truth.pose, &robot.spec.footprint);
    }
    picture.save("target/pictures/random_drive.svg")?;
    Ok(())
}
