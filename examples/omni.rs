//! Mecanum wheels (book, sections 7.2 and 7.4): a robot drives round a square without turning, and then along
//! a line while it spins about itself.
//!
//! `cargo run --release --example omni`

use roverlab::drive::{OmniDriver, OmniOutcome, OmniParameters, OmniTracker};
use roverlab::geometry::{Point, Pose, angle_difference, units};
use roverlab::io::Odometry;
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::kinematics::Omni;
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::{Colour, DriveSpec, RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let spec = RobotSpec::omni();
    let DriveSpec::Omni { wheel_diameter, track, wheelbase, max_wheel_speed, .. } = spec.drive else {
        return Err("this robot has other wheels".into());
    };
    let kinematics = Omni::mecanum(track, wheelbase)?;
    let driver = OmniDriver::new(kinematics, 0.5 * wheel_diameter * max_wheel_speed)?;
    let start = Pose::new(0.5, 0.5, 0.0);
    let scene = Scene::with_robot(World::walled(2.5, 2.0), spec.clone(), start);
    let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(&scene, options)?;
    let mut robot = simulation.robot(0)?;
    // From now on odometry speaks of the world, as the routes do.
    robot.set_pose(start)?;

    let square = [(1.5, 0.5), (1.5, 1.5), (0.5, 1.5), (0.5, 0.5)].map(|(x, y)| Point::new(x, y));
    let tracker = OmniTracker::new(start, &square, OmniParameters::default())?;
    let mut turned = 0.0_f64;
    let outcome = run(&mut robot, &mut tracker.by(driver), 60.0, |_, _, step| {
        turned = turned.max(step.seen.heading.abs());
    })?;
    assert_eq!(outcome, OmniOutcome::Reached);
    let end = simulation.truth().pose(0)?;
    let (missed, most) = (units::to_mm(end.distance_to(start.position())), units::to_deg(turned));
    println!("square: back within {missed:.0} mm, never turned by more than {most:.1} degrees");
    assert!(missed < 60.0 && most < 5.0);

    let (here, goal) = (robot.pose()?, Point::new(2.0, 1.2));
    let spin = OmniParameters { spin: units::from_deg(60.0), ..OmniParameters::default() };
    let (mut rotation, mut last) = (0.0, here.heading);
    let tracker = OmniTracker::new(here, &[goal], spin)?;
    run(&mut robot, &mut tracker.by(driver), 60.0, |_, _, step| {
        rotation += angle_difference(step.seen.heading, last);
        last = step.seen.heading;
    })?;
    let truth = simulation.truth().robot(0)?;
    let (missed, rotation) = (units::to_mm(truth.pose.distance_to(goal)), units::to_deg(rotation));
    println!("line:   {missed:.0} mm from its end, turned by {rotation:.0} degrees on the way");
    assert!(missed < 60.0 && rotation > 180.0 && truth.contacts == 0);

    let mut picture = Picture::new(&scene.world);
    picture.title("Mecanum wheels: a square without turning, a line while spinning");
    picture.true_path(truth.trail.iter().map(|point| point.pose.position()));
    for point in truth.trail.iter().step_by(15) {
        let pale = Style::new(Colour::from_hex(0x8a_90_9c)).opacity(0.4);
        picture.robot_with(point.pose, &spec.footprint, pale);
    }
    picture.robot(truth.pose, &spec.footprint).mark(Mark::Start, start.position()).mark(Mark::Goal, goal);
    picture.save("target/pictures/omni.svg")?;
    Ok(())
}
