//! First steps (book, section 2.13): a robot drives to 300 mm before a wall and back to its start, by its
//! wheels alone and by comparing what its lidar sees.
//!
//! `cargo run --release --example first_steps`

use roverlab::drive::{FirstSteps, FirstStepsOutcome, FirstStepsParameters, FirstTask};
use roverlab::geometry::{Pose, units};
use roverlab::io::Manoeuvres;
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::picture::{Mark, Picture};
use roverlab::world::{RobotSpec, Scene, World};

const START: Pose = Pose::new(0.7, 1.0, 0.0);

/// A robot in a room, whose wheels are not quite what it takes them for.
fn room() -> roverlab::io::Result<Simulation> {
    let scene = Scene::with_robot(World::walled(3.0, 2.0), RobotSpec::s4(), START);
    Simulation::new(&scene, SimOptions { trail_interval: Some(0.2), ..SimOptions::with_noise(1.0, 3) })
}

/// Distance between the robot and its start (mm).
fn off(simulation: &Simulation) -> roverlab::io::Result<f64> {
    Ok(units::to_mm(simulation.truth().pose(0)?.distance_to(START.position())))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Straight on, half a turn, and straight on again: what the wheels measure is what they get wrong.
    let blind = room()?;
    let mut robot = blind.robot(0)?;
    let distance = 3.0 - START.x - 0.06 - 0.3;
    for manoeuvre in 0..3 {
        match manoeuvre {
            1 => robot.turn(std::f64::consts::PI, 1.0)?,
            _ => robot.straight(distance, 0.25)?,
        }
        robot.wait_done()?;
    }
    drop(robot);

    // The same with scans: the robot is back when the walls are where they were.
    let seeing = room()?;
    let mut steps = FirstSteps::new(FirstTask::Wall, FirstStepsParameters::default())?;
    let outcome = run(&mut seeing.robot(0)?, &mut steps, 60.0, |_, _, _| {})?;
    assert_eq!(outcome, FirstStepsOutcome::Returned);

    println!("by its wheels {:.0} mm off, by its scans {:.0} mm", off(&blind)?, off(&seeing)?);
    assert!(off(&seeing)? < 20.0 && off(&blind)? > off(&seeing)?);

    let (end, mut picture) = (seeing.truth().robot(0)?, Picture::new(&World::walled(3.0, 2.0)));
    picture.title("To a wall and back by scans").mark(Mark::Start, START.position());
    picture.true_path(end.trail.iter().map(|point| point.pose.position()));
    picture.robot(end.pose, &RobotSpec::s4().footprint).save("target/pictures/first_steps.svg")?;
    Ok(())
}
