//! From A to B (book, sections 3.3 to 3.6): the same goal by turning and driving straight, by an arc, by a
//! dog curve and by a spline, which alone arrives with a given heading without a turn at the end.
//!
//! `cargo run --release --example a_to_b`

use roverlab::drive::{AToB, AToBOutcome, AToBParameters, Goal, Method};
use roverlab::geometry::{Pose, angle_difference, units};
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::picture::{Mark, Picture, SERIES, Style};
use roverlab::world::{RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (start, goal) = (Pose::new(0.5, 0.5, 0.0), Pose::new(1.95, 1.15, 0.0));
    let scene = Scene::with_robot(World::empty(2.5, 2.0), RobotSpec::s4(), start);
    let mut picture = Picture::new(&scene.world);
    picture.title("From A to B in four ways");
    picture.mark(Mark::Start, start.position()).mark(Mark::Goal, goal.position());

    let ways = [
        ("turn and drive", Method::Turn),
        ("arc", Method::Arc),
        ("dog curve", Method::Dog),
        ("spline", Method::Spline),
    ];
    for (&colour, (name, method)) in SERIES.iter().zip(ways) {
        let options = SimOptions { trail_interval: Some(0.05), ..SimOptions::with_noise(1.0, 1) };
        let simulation = Simulation::new(&scene, options)?;
        // Odometry begins at the start, so the goal is given relative to it.
        let relative = start.inverse().compose(&goal);
        let target =
            if method == Method::Spline { Goal::pose(relative) } else { Goal::point(relative.position()) };
        let mut drive = AToB::new(method, target, AToBParameters::default())?;
        let outcome = run(&mut simulation.robot(0)?, &mut drive, 60.0, |_, _, _| {})?;

        let (truth, time) = (simulation.truth().robot(0)?, simulation.truth().time());
        let missed = units::to_mm(truth.pose.distance_to(goal.position()));
        let turned = units::to_deg(angle_difference(truth.pose.heading, goal.heading));
        let length = truth.path_length;
        println!(
            "{name:15} {length:.2} m in {time:4.1} s, {missed:2.0} mm off, heading {turned:+5.1} degrees"
        );
        // Without landmarks, the robot is as wrong in the end as its odometry is.
        assert_eq!(outcome, AToBOutcome::Reached);
        assert!(missed < 100.0 && (method != Method::Spline || turned.abs() < 10.0));
        let style = Style::new(colour).labelled(name);
        picture.line(truth.trail.iter().map(|point| point.pose.position()), style);
        picture.robot_with(truth.pose, &RobotSpec::s4().footprint, Style::new(colour));
    }
    picture.save("target/pictures/a_to_b.svg")?;
    Ok(())
}
