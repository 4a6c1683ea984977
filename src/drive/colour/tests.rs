use std::sync::Arc;

use image::{Rgb, RgbImage};

use super::*;
use crate::geometry::{Point, Pose, Twist};
use crate::io::Odometry;
use crate::io::control::{Behaviour, run};
use crate::io::sim::{SimOptions, Simulation};
use crate::vision::{CameraGeometry, ColourFinder, FindMethod};
use crate::world::{Colour, Object, ObjectKind, RobotSpec, Scene, Shape, World};

fn camera() -> CameraGeometry {
    CameraGeometry::from(&RobotSpec::s4().camera.unwrap())
}

fn finder(method: FindMethod) -> ColourFinder {
    ColourFinder::new(42, 10, method, camera()).unwrap()
}

/// A can of a colour at a place.
fn can(colour: Colour, x: f64, y: f64) -> Object {
    let kind = ObjectKind { colour, mass: 0.4, ..ObjectKind::predefined("can").unwrap() };
    Object::new(Arc::new(kind), Pose::new(x, y, 0.0))
}

/// A red can, among others, in a room of 3 m by 3 m.
fn room(x: f64, y: f64) -> Scene {
    let mut world = World::walled(3.0, 3.0);
    world.objects.push(can(Colour::RED, x, y));
    world.objects.push(can(Colour::BLUE, 1.5, 2.0));
    world.objects.push(can(Colour::GREEN, 2.1, 1.2));
    let ball = Shape::Sphere { radius: 0.11 };
    let ball = Arc::new(ObjectKind::new("ball", ball, Colour::from_hex(0xff_d0_00)));
    world.objects.push(Object::new(ball, Pose::new(1.3, 0.9, 0.0)));
    Scene::with_robot(world, RobotSpec::s4(), Pose::new(0.4, 0.4, 0.8))
}

#[test]
fn the_can_is_reached_in_any_light() {
    for (method, x, y, light) in [
        (FindMethod::Blob, 2.5, 2.4, 0.3),
        (FindMethod::Blob, 0.5, 2.5, 1.5),
        (FindMethod::Histogram, 2.5, 0.5, 1.0),
        (FindMethod::Blob, 1.9, 1.6, 1.0),
    ] {
        let options = SimOptions { light, ..SimOptions::with_noise(1.0, 5) };
        let simulation = Simulation::new(&room(x, y), options).unwrap();
        let mut robot = simulation.robot(0).unwrap();
        let mut tracker = ColourTracker::new(finder(method), ColourTrackerParameters::default()).unwrap();
        let outcome = run(&mut robot, &mut tracker, 120.0, |_, _, _| {}).unwrap();
        let truth = simulation.truth().robot(0).unwrap();
        assert_eq!((outcome, truth.contacts), (ColourOutcome::Reached, 0), "{method:?} {x} {y} {light}");
        let gap = truth.pose.distance_to(Point::new(x, y)) - 0.093;
        assert!(gap < 0.09, "{gap}");
    }
}

#[test]
fn the_can_is_pushed_home() {
    for (x, y, seed) in [(1.6, 1.5, 1), (2.2, 2.2, 2), (0.9, 1.9, 3)] {
        let mut world = World::walled(3.0, 3.0);
        world.objects.push(can(Colour::RED, x, y));
        let start = Pose::new(0.5, 0.5, 0.8);
        let scene = Scene::with_robot(world, RobotSpec::s4(), start);
        let options = SimOptions { pushing: true, ..SimOptions::with_noise(1.0, seed) };
        let simulation = Simulation::new(&scene, options).unwrap();
        let mut robot = simulation.robot(0).unwrap();
        let mut behaviour =
            PushHome::new(finder(FindMethod::Blob), Point::origin(), PushHomeParameters::default()).unwrap();
        let outcome = run(&mut robot, &mut behaviour, 240.0, |_, _, _| {}).unwrap();
        let truth = simulation.truth();
        let home = truth.object(0).unwrap().distance_to(start.position());
        assert_eq!(outcome, PushOutcome::Home, "{x} {y}: {:?}", behaviour.phase());
        assert!(home < 0.16, "{x} {y}: {home}");
        assert_eq!(truth.robot(0).unwrap().contacts, 0);
    }
}

#[test]
fn what_is_gone_is_searched_for() {
    let mut world = World::walled(3.0, 3.0);
    world.objects.push(can(Colour::RED, 1.2, 1.2));
    let scene = Scene::with_robot(world, RobotSpec::s4(), Pose::new(0.5, 0.5, 0.8));
    let simulation = Simulation::new(&scene, SimOptions { pushing: true, ..SimOptions::ideal() }).unwrap();
    let mut robot = simulation.robot(0).unwrap();
    let mut behaviour =
        PushHome::new(finder(FindMethod::Blob), Point::origin(), PushHomeParameters::default()).unwrap();
    for _ in 0..20 {
        if behaviour.phase() == HomePhase::Finding {
            run(&mut robot, &mut behaviour, 2.0, |_, _, _| {}).unwrap();
        }
    }
    assert_ne!(behaviour.phase(), HomePhase::Finding);
    // Neither lidar nor camera sees anything any more.
    let image = RgbImage::from_pixel(160, 120, Rgb([90; 3]));
    let nothing = ColourObservation { image, pose: robot.pose().unwrap(), ..ColourObservation::default() };
    let mut step = |i: u32| {
        let decision = behaviour.step(100.0 + 0.1 * f64::from(i), &nothing).unwrap();
        decision.continue_value().expect("it goes on")
    };
    let twists: Vec<Twist> = (0..15).map(&mut step).collect();
    assert!(twists[14].linear == 0.0 && twists[14].angular > 0.1, "{twists:?}");
    assert_eq!((behaviour.phase(), behaviour.object()), (HomePhase::Finding, None));
}
