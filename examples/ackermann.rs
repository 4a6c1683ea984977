//! A car (book, sections 7.1 and 7.4): it steers by its front wheels and so never turns tighter than its
//! turning circle. It drives to a pose beside it by its motor and its steering servo.
//!
//! `cargo run --release --example ackermann`

use roverlab::drive::{CarDriver, CarOutcome, CarToB, CarToBParameters, Goal, Method};
use roverlab::geometry::{Pose, angle_difference, units};
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::kinematics::Ackermann;
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::{Colour, DriveSpec, RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (start, goal) = (Pose::new(1.0, 1.0, 0.0), Pose::new(3.0, 2.4, units::from_deg(30.0)));
    let spec = RobotSpec::car();
    let DriveSpec::Ackermann { wheel_diameter, track, wheelbase, max_steering, max_wheel_speed, .. } =
        spec.drive
    else {
        return Err("this robot is no car".into());
    };
    let kinematics = Ackermann::new(wheelbase, track, max_steering)?;
    // Motor and servo take fractions of their range; the driver turns speed and steering angle into them.
    let driver = CarDriver::new(kinematics, 0.5 * wheel_diameter * max_wheel_speed)?;
    println!("The turning circle has a radius of {:.2} m.", kinematics.turning_radius());

    let scene = Scene::with_robot(World::walled(4.0, 3.5), spec.clone(), start);
    let options = SimOptions { trail_interval: Some(0.05), ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(&scene, options)?;
    let target = Goal::pose(start.inverse().compose(&goal));
    let mut drive = CarToB::new(Method::Spline, target, driver, CarToBParameters::default())?;
    let plan = drive.plan(Pose::default())?.ok_or("the car is at its goal")?;
    let outcome = run(&mut simulation.robot(0)?, &mut drive, 60.0, |_, _, _| {})?;

    let truth = simulation.truth().robot(0)?;
    let missed = units::to_mm(truth.pose.distance_to(goal.position()));
    let turned = units::to_deg(angle_difference(truth.pose.heading, goal.heading));
    let (length, time) = (truth.path_length, simulation.truth().time());
    println!("{outcome:?} after {length:.2} m and {time:.1} s, {missed:.0} mm and {turned:+.1} degrees off");
    println!("The planned path is {:.2} m long.", plan.length());
    assert_eq!((outcome, truth.contacts), (CarOutcome::Reached, 0));
    assert!(missed < 100.0 && turned.abs() < 10.0);
    assert!(plan.max_curvature() * kinematics.turning_radius() <= 1.0);

    let pale = Style::new(Colour::from_hex(0x8a_90_9c)).opacity(0.5);
    let mut picture = Picture::new(&scene.world);
    picture.title("A car to a pose, by a spline");
    picture.line(plan.points().iter().map(|point| start.to_world(point.pose.position())), Style::plan());
    picture.true_path(truth.trail.iter().map(|point| point.pose.position()));
    picture.robot_with(start, &spec.footprint, pale).robot(truth.pose, &spec.footprint);
    picture.mark(Mark::Start, start.position()).mark(Mark::Goal, goal.position());
    picture.save("target/pictures/ackermann.svg")?;
    Ok(())
}
