//! Keeping the lane (book, chapter 13): a model car drives on a course that it does not know, by its camera
//! alone, before the referee of Free Drive; then the book's pipeline of edges and straight lines drives on
//! the same course.
//!
//! `cargo run --release --example lane_keeping`

use roverlab::drive::lane_keeping::{
    BookLaneKeeper, BookLaneParameters, LaneKeeper, LaneKeeperParameters, LaneObservation, LaneOutcome,
};
use roverlab::drive::traffic::{FreeDrive, FreeDriveRules, FreeDriveScore};
use roverlab::geometry::{Point, Twist};
use roverlab::io::control::{Behaviour, Senses, run, until};
use roverlab::io::sim::{SimOptions, SimRobot, Simulation};
use roverlab::picture::{Picture, Style};
use roverlab::vision::lane_markings::RoadModel;
use roverlab::world::road::{Appearance, RoadCourse, RoadCourseOptions, generate};
use roverlab::world::{RobotSpec, Scene, World};

/// Lets a behaviour drive for half a minute, or until it has to be taken over. Returns its score and its way.
fn drive<B>(
    course: &RoadCourse,
    keeper: &mut B,
) -> Result<(FreeDriveScore, Vec<Point>), Box<dyn std::error::Error>>
where
    B: Behaviour<Observation = LaneObservation, Command = Twist, Outcome = LaneOutcome> + Senses<SimRobot>,
{
    let spec = RobotSpec::road_car();
    let world = course.world(&Appearance { wear: 0.2, glare: 2, ..Appearance::default() })?;
    let scene = Scene::with_robot(world, spec.clone(), course.start());
    let options = SimOptions { light: 0.7, ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(&scene, options)?;
    let (mut car, truth) = (simulation.robot(0)?, simulation.truth());
    let mut referee = FreeDrive::new(course.clone(), &spec, FreeDriveRules::default())?;
    let mut way = Vec::new();
    run(&mut car, keeper, 30.0, |_, _, _| {
        let pose = truth.pose(0)?;
        way.push(pose.position());
        Ok::<_, roverlab::io::Error>(until(referee.see(truth.time(), &pose)))
    })?;
    Ok((*referee.score(), way))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let course = generate(3, &RoadCourseOptions::default())?;
    let camera = RobotSpec::road_car().camera.as_ref().ok_or("a car without a camera")?.into();
    let mut keeper = LaneKeeper::new(camera, RoadModel::default(), LaneKeeperParameters::default())?;
    let (ours, way) = drive(&course, &mut keeper)?;
    let (book, other) = drive(&course, &mut BookLaneKeeper::new(BookLaneParameters::default())?)?;
    for (name, score) in [("ours", &ours), ("the book's", &book)] {
        println!(
            "{name}: {:.1} m in {:.0} s, {:.0} mm off the middle, {} departures",
            score.distance,
            score.time,
            1000.0 * score.offset_rms(),
            score.departures
        );
    }
    assert!(ours.distance > 50.0 && ours.offset_rms() < 0.025 && ours.departures == 0);

    let mut picture = Picture::new(&World { floor: course.floor(), ..World::empty(1.0, 1.0) });
    picture.title("Keeping the lane").caption("light of 70 %, worn paint, noise 1");
    for left in [course.edge(), 0.0, -course.edge()] {
        let line = (0..=300).map(|i| course.line.beside(course.line.length() * f64::from(i) / 300.0, left));
        picture.line(line, Style::aid());
    }
    picture.line(other, Style::odometry().labelled("the book's driver")).true_path(way);
    picture.save("target/pictures/lane_keeping.svg")?;
    Ok(())
}
