//! Driving by a network (book, chapter 13): it has learned from images what a lane keeper steers, and drives
//! a course that it has never seen, before the referee of Free Drive. The picture shows what it looks at.
//!
//! `cargo run --release --example end_to_end --features weights`

use std::fs;
use std::ops::ControlFlow;

use roverlab::drive::end_to_end::NetworkDriver;
use roverlab::drive::traffic::{FreeDrive, FreeDriveRules};
use roverlab::io::control::{run, until};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::picture::{Picture, Style};
use roverlab::vision::network::Network;
use roverlab::world::road::{Appearance, RoadCourseOptions, generate};
use roverlab::world::{RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/cli/nets/steering.safetensors");
    let network = Network::from_safetensors(&fs::read(file)?)?;
    println!("{}: {} weights", network.architecture(), network.architecture().weights());

    let course = generate(3, &RoadCourseOptions::default())?;
    let world = course.world(&Appearance { wear: 0.2, glare: 2, ..Appearance::default() })?;
    let spec = RobotSpec::road_car();
    let scene = Scene::with_robot(world, spec.clone(), course.start());
    let options = SimOptions { light: 0.7, ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(&scene, options)?;
    let (mut car, truth) = (simulation.robot(0)?, simulation.truth());

    let mut driver = NetworkDriver::new(network, 1.0)?;
    let mut referee = FreeDrive::new(course.clone(), &spec, FreeDriveRules::default())?;
    let mut way = Vec::new();
    run(&mut car, &mut driver, 20.0, |_, _, _| {
        let pose = truth.pose(0)?;
        way.push(pose.position());
        Ok::<ControlFlow<()>, roverlab::io::Error>(until(referee.see(truth.time(), &pose)))
    })?;
    let score = referee.score();
    let off = 1000.0 * score.offset_rms();
    println!("{:.1} m, {off:.0} mm off the middle, {} departures", score.distance, score.departures);
    assert!(score.distance > 15.0 && score.departures == 0 && score.interventions == 0);

    // Rows of the network's sight, darker where it looks.
    let size = driver.network().architecture().input();
    let attention = driver.network().attention();
    for row in attention.chunks_exact(size.width) {
        println!(
            "{}",
            row.iter().map(|&part| [' ', '.', ':', '*', '#'][(4.0 * part) as usize]).collect::<String>()
        );
    }

    let mut picture = Picture::new(&World { floor: course.floor(), ..World::empty(1.0, 1.0) });
    picture.title("Driving by a network").caption("a course that it has never seen");
    for left in [course.edge(), 0.0, -course.edge()] {
        let line = (0..=300).map(|i| course.line.beside(course.line.length() * f64::from(i) / 300.0, left));
        picture.line(line, Style::aid());
    }
    picture.true_path(way);
    picture.save("target/pictures/end_to_end.svg")?;
    Ok(())
}
