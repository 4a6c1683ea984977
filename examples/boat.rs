//! A boat (book, section 8.1): the solar raft sails a course by its two thrusters, against a current, and
//! keeps its station at the end.
//!
//! `cargo run --release --example boat`

use roverlab::drive::marine::{Boat, BoatOutcome, BoatParameters};
use roverlab::geometry::{Point, Pose, Vector, units};
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::kinematics::marine::CraftSpec;
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::{RobotSpec, Scene, Water, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let water = Water {
        current: vec![(0.0, Vector::new(0.05, 0.15))],
        wind: Vector::new(-2.0, 1.0),
        ..Water::default()
    };
    let lake = World { water_level: Some(3.0), water, ..World::empty(20.0, 20.0) };
    // By its Doppler log, it knows the way over ground.
    let raft = RobotSpec { dvl: Some(10.0), ..RobotSpec::solar_raft() };
    let start = Pose::new(4.0, 4.0, 0.0);
    let scene = Scene::with_robot(lake, raft, start);
    let simulation =
        Simulation::new(&scene, SimOptions { trail_interval: Some(0.2), ..SimOptions::with_noise(1.0, 1) })?;
    let truth = simulation.truth();

    let course = [Point::new(14.0, 4.0), Point::new(14.0, 12.0), Point::new(6.0, 14.0)];
    let mut boat = Boat::new(&CraftSpec::solar_raft(), start, &course, BoatParameters::default())?;
    let mut nearest = [f64::INFINITY; 3];
    let outcome = run(&mut simulation.robot(0)?, &mut boat, 300.0, |_, _, _| {
        if let Ok(pose) = truth.pose(0) {
            for (nearest, waypoint) in nearest.iter_mut().zip(&course) {
                *nearest = nearest.min((pose.position() - waypoint).norm());
            }
        }
    })?;
    assert_eq!(outcome, BoatOutcome::Arrived);
    let missed = nearest.into_iter().fold(0.0, f64::max);
    let off = (truth.pose(0)?.position() - course[2]).norm();
    println!(
        "passed each waypoint within {:.0} mm; after a minute on station {:.0} mm off",
        units::to_mm(missed),
        units::to_mm(off)
    );
    assert!(missed < 0.5 && off < 0.5);

    let (end, mut picture) = (truth.robot(0)?, Picture::new(&scene.world));
    picture.title("A raft on its course, in wind and current").mark(Mark::Start, start.position());
    picture.line([start.position(), course[0], course[1], course[2]], Style::plan().labelled("course"));
    picture.true_path(end.trail.iter().map(|point| point.pose.position()));
    picture.robot(end.pose, &scene.robots[0].spec.footprint).save("target/pictures/boat.svg")?;
    Ok(())
}
