//! Cars that share a road (book, section 13.4): two model cars drive by their cameras, tell each other by
//! radio where they are, and a base station beside the road stops them.
//!
//! `cargo run --release --example base_station`

use std::sync::Arc;

use roverlab::drive::traffic::{
    RadioCar, RoadSharingParameters, RoadStation, RoadStationParameters, TrafficParameters,
};
use roverlab::geometry::Pose;
use roverlab::io::Clock;
use roverlab::io::control::{Behaviour, Run};
use roverlab::io::sim::{Fleet, SimOptions};
use roverlab::picture::{Picture, Style};
use roverlab::vision::lane_markings::RoadModel;
use roverlab::world::road::{Appearance, RoadCourseOptions, generate};
use roverlab::world::{RobotPlacement, RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let course = generate(3, &RoadCourseOptions::default())?;
    let mut scene = Scene::new(course.world(&Appearance::default())?);
    let car = Arc::new(RobotSpec::road_car());
    let starts = [0.0, 0.5 * course.line.length()].map(|along| course.pose(along, 0.0));
    scene.robots = starts.map(|start| RobotPlacement::new(Arc::clone(&car), start)).into();
    let beside = Pose::new(course.floor().min.x + 0.15, course.floor().min.y + 0.15, 0.0);
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::s4()), beside));
    let mut fleet = Fleet::new(&scene, SimOptions::with_noise(1.0, 1))?;

    for (index, start) in starts.iter().enumerate() {
        let camera = car.camera.as_ref().ok_or("a car without a camera")?.into();
        let parameters = (TrafficParameters::default(), RoadSharingParameters::default());
        let place = course.start().inverse().compose(start);
        let mut driver = RadioCar::new(camera, RoadModel::default(), parameters, place)?;
        let mut run = Run::new(&driver, f64::INFINITY)?;
        fleet.control(index, driver.period(), move |io| Ok(run.step(io, &mut driver)?.map_break(drop)))?;
    }
    let mut station = RoadStation::new(RoadStationParameters::default())?;
    let mut run = Run::new(&station, f64::INFINITY)?;
    fleet.control(2, station.period(), move |io| {
        // After ten seconds, all shall stand.
        station.stop(io.now()? > 10.0);
        Ok(run.step(io, &mut station)?.map_break(drop))
    })?;

    let mut paths = [Vec::new(), Vec::new()];
    let mut at_ten = [0.0; 2];
    for step in 1..=120 {
        fleet.run_for(0.1)?;
        for (index, path) in paths.iter_mut().enumerate() {
            path.push(fleet.truth(index)?.pose.position());
            at_ten[index] = if step == 100 { fleet.truth(index)?.path_length } else { at_ten[index] };
        }
    }
    for (index, at_ten) in at_ten.into_iter().enumerate() {
        let truth = fleet.truth(index)?;
        let after = truth.path_length - at_ten;
        println!("car {index} drove {at_ten:.1} m, and {after:.2} m after the order to stand");
        assert!(at_ten > 4.0 && after < 1.5 && truth.contacts == 0);
    }

    let mut picture = Picture::new(&World { floor: course.floor(), ..World::empty(1.0, 1.0) });
    picture.title("Two cars and a base station");
    for left in [course.edge(), 0.0, -course.edge()] {
        let line = (0..=300).map(|i| course.line.beside(course.line.length() * f64::from(i) / 300.0, left));
        picture.line(line, Style::aid());
    }
    for path in paths {
        picture.true_path(path);
    }
    picture.robot(beside, &RobotSpec::s4().footprint).save("target/pictures/base_station.svg")?;
    Ok(())
}
