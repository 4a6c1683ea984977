//! In traffic (book, chapter 13): a model car drives a lap by its camera alone, past boxes that stand and
//! move, to halts at lines and before pedestrians, and the referee of Obstacle Evasion gives points.
//!
//! `cargo run --release --example traffic`

use roverlab::drive::traffic::{
    CarFront, EvasionElement, ObstacleEvasion, TrafficActors, TrafficDriver, TrafficParameters, TrafficScene,
};
use roverlab::geometry::Pose;
use roverlab::io::control::{run, until};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::picture::{Picture, Style};
use roverlab::vision::lane_markings::RoadModel;
use roverlab::world::road::{Appearance, RoadCourseOptions, generate};
use roverlab::world::{RobotSpec, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let options = RoadCourseOptions { crossings: 0.9, zebras: 0.8, ..RoadCourseOptions::default() };
    let traffic = TrafficScene::drawn(generate(3, &options)?, 3);
    let spec = RobotSpec::road_car();
    let scene = traffic.scene(&Appearance::default(), spec.clone())?;
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 3))?;
    let (mut car, truth) = (simulation.robot(0)?, simulation.truth());

    let camera = spec.camera.as_ref().ok_or("a car without a camera")?.into();
    let mut driver = TrafficDriver::new(camera, RoadModel::default(), TrafficParameters::default())?;
    let mut actors = TrafficActors::new(traffic.clone());
    let mut referee = ObstacleEvasion::new(traffic.clone(), &spec, 1);
    let mut way: Vec<(f64, Pose)> = vec![(0.0, scene.robots[0].pose)];
    let mut states = Vec::new();
    run(&mut car, &mut driver, 120.0, |_, driver, _| {
        let (time, pose) = (truth.time(), truth.pose(0)?);
        let (before, last) = way[way.len() - 1];
        let speed = pose.distance_to(last.position()) / (time - before).max(1e-3);
        way.push((time, pose));
        if states.last() != Some(&driver.state()) {
            states.push(driver.state());
        }
        // Boxes move, and pedestrians walk once the car stands.
        for (index, pose) in actors.advance(time, CarFront { along: referee.front(), speed }) {
            truth.move_object(0, index, pose)?;
        }
        Ok::<_, roverlab::io::Error>(until(referee.see(time, &pose, speed, &actors)))
    })?;

    let score = referee.score();
    for (element, row) in EvasionElement::ALL.iter().zip(&score.rows).filter(|(_, row)| row.seen > 0) {
        println!("{}: {} of {} right", element.name(), row.right, row.seen);
    }
    println!("{} of {} points in {:.0} s; {states:?}", score.points(), referee.possible(), score.time);
    assert!(score.laps == 1 && score.collisions == 0 && score.points() > 0.5 * referee.possible());

    let course = &traffic.course;
    let (floor, objects) = (course.floor(), scene.world.objects.clone());
    let mut picture = Picture::new(&World { floor, objects, ..World::empty(1.0, 1.0) });
    picture.title("In traffic").caption("boxes where they stand at first");
    for left in [course.edge(), 0.0, -course.edge()] {
        let line = (0..=300).map(|i| course.line.beside(course.line.length() * f64::from(i) / 300.0, left));
        picture.line(line, Style::aid());
    }
    picture.true_path(way.iter().map(|(_, pose)| pose.position()));
    picture.save("target/pictures/traffic.svg")?;
    Ok(())
}
