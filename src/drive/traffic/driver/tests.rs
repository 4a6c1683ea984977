//! The driver by its camera, before the referee.

use super::*;
use crate::drive::traffic::{
    BoxMotion, CarFront, EvasionElement, EvasionRow, ObstacleEvasion, RoadBox, TrafficActors, TrafficScene,
};
use crate::io::control::{run, until};
use crate::io::sim::{SimOptions, Simulation};
use crate::world::RobotSpec;
use crate::world::formats::course;
use crate::world::road::Appearance;

const OVAL: &str = "straight 10000\narc 1500 180\nstraight 10000\narc 1500 180\n";

/// Drives on a course with boxes for some seconds. Returns the states in their order, and the referee.
fn drive(
    sections: &str,
    boxes: &[(f64, f64, BoxMotion)],
    seconds: f64,
) -> (Vec<TrafficState>, ObstacleEvasion) {
    let course = course::parse(&format!("course 1\nlane 400\n{sections}"), "sections").unwrap();
    let boxes = boxes.iter().map(|&(along, left, motion)| RoadBox { along, left, size: [0.2; 3], motion });
    let scene = TrafficScene { course, boxes: boxes.collect() };
    let spec = RobotSpec::road_car();
    let world = scene.scene(&Appearance { pixel: 0.004, ..Appearance::default() }, spec.clone()).unwrap();
    let simulation = Simulation::new(&world, SimOptions::with_noise(1.0, 1)).unwrap();
    let (mut car, truth) = (simulation.robot(0).unwrap(), simulation.truth());
    let camera = spec.camera.as_ref().unwrap().into();
    let mut driver = TrafficDriver::new(camera, RoadModel::default(), TrafficParameters::default()).unwrap();
    let mut actors = TrafficActors::new(scene.clone());
    let mut referee = ObstacleEvasion::new(scene, &spec, 1);
    let (mut states, mut before) = (Vec::new(), (0.0, truth.pose(0).unwrap()));
    run(&mut car, &mut driver, seconds, |_, driver, _| {
        let (time, pose) = (truth.time(), truth.pose(0)?);
        let speed = pose.distance_to(before.1.position()) / (time - before.0).max(1e-3);
        before = (time, pose);
        if states.last() != Some(&driver.state()) {
            states.push(driver.state());
        }
        for (index, pose) in actors.advance(time, CarFront { along: referee.front(), speed }) {
            truth.move_object(0, index, pose)?;
        }
        Ok::<_, io::Error>(until(referee.see(time, &pose, speed, &actors)))
    })
    .unwrap();
    (states, referee)
}

fn row(referee: &ObstacleEvasion, element: EvasionElement) -> EvasionRow {
    let index = EvasionElement::ALL.iter().position(|it| *it == element).unwrap();
    referee.score().rows[index]
}

#[test]
fn a_car_waits_for_what_comes_before_it_passes() {
    use TrafficState::{Behind, Follow, Pass, Return};
    let boxes = [(5.0, 0.0, BoxMotion::Static), (6.4, 0.42, BoxMotion::Oncoming(4.0))];
    let (states, referee) = drive(OVAL, &boxes, 15.0);
    assert_eq!(states, [Follow, Behind, Pass, Return, Follow]);
    assert_eq!(row(&referee, EvasionElement::OncomingObstacle).right, 1, "{:?}", referee.score());
    assert_eq!(row(&referee, EvasionElement::StaticObstacle).right, 1, "{:?}", referee.score());
    assert_eq!(referee.score().collisions, 0);
}

#[test]
fn a_car_passes_although_a_box_stands_in_the_other_lane() {
    use TrafficState::{Follow, Pass, Return};
    let boxes = [(4.0, 0.0, BoxMotion::Static), (6.1, 0.42, BoxMotion::Static)];
    let (states, referee) = drive(OVAL, &boxes, 9.0);
    assert_eq!(states, [Follow, Pass, Return, Follow]);
    assert_eq!(row(&referee, EvasionElement::StaticObstacle).right, 2, "{:?}", referee.score());
    assert_eq!(referee.score().collisions, 0);
}

#[test]
fn a_car_returns_in_time_before_what_it_has_passed_while_that_drove() {
    use TrafficState::{Follow, Pass, Return};
    let (states, referee) = drive(OVAL, &[(3.0, 0.0, BoxMotion::Along(5.0))], 11.0);
    assert_eq!(states, [Follow, Pass, Return, Follow]);
    assert_eq!(row(&referee, EvasionElement::DynamicObstacle).right, 1, "{:?}", referee.score());
}

#[test]
fn a_car_stays_out_of_an_area_behind_which_a_box_has_come() {
    let area =
        "straight 5000\nbarred right 1200 200\nstraight 5000\narc 1500 180\nstraight 10000\narc 1500 180\n";
    let (_, referee) = drive(area, &[(6.3, 0.42, BoxMotion::Oncoming(4.0))], 15.0);
    assert_eq!(row(&referee, EvasionElement::OncomingObstacle).right, 1, "{:?}", referee.score());
    assert_eq!(row(&referee, EvasionElement::BarredArea).right, 1, "{:?}", referee.score());
}

#[test]
fn a_box_in_a_crossing_is_no_area_before_which_cars_stay() {
    let element = |kind, ahead| RoadElement { kind, ahead, speed: 0.0 };
    let area = element(RoadElementKind::Barred { right: -0.2, left: 0.2, length: 0.25 }, 0.4);
    let crossing = |ahead| element(RoadElementKind::Crossing { left: true, right: true }, ahead);
    assert!(obstacles(&[area, crossing(0.9)], 1.0, 1.0).is_empty());
    assert_eq!(obstacles(&[area, crossing(2.0)], 1.0, 1.0).len(), 1);
}

#[test]
fn a_car_turns_off_where_an_arrow_tells_it_to() {
    use TrafficState::{Follow, Stop, Turn, Wait};
    for (way, bend) in [("right", 270), ("left", -270)] {
        let sections = format!(
            "straight 1900\narrow {way}\nstraight 1100\ncrossing 90 none stop\nstraight 3000\n\
             arc 3000 {bend}\nstraight 3000\ncrossing 90 none\nstraight 3000\narc 3000 {}\n",
            -bend
        );
        let (states, referee) = drive(&sections, &[], 14.0);
        assert_eq!(states, [Follow, Stop, Wait, Turn, Follow], "{way}");
        assert_eq!(row(&referee, EvasionElement::Turn).right, 1, "{way}: {:?}", referee.score());
        assert_eq!(referee.score().departures, 0, "{way}");
    }
}
