use std::sync::Arc;

use image::{Rgb, RgbImage};
use proptest::prelude::*;

use super::*;
use crate::geometry::{Point, Pose, Twist, math};
use crate::io::sim::{SimOptions, Simulation};
use crate::io::{Drive, LidarScan};
use crate::vision::HueLimits;
use crate::world::{CameraSpec, Colour, Object, ObjectKind, RobotSpec, Scene, Shape, World};

fn camera() -> CameraGeometry {
    CameraGeometry::from(&RobotSpec::s4().camera.unwrap())
}

fn finder(method: FindMethod) -> ColourFinder {
    ColourFinder::new(42, 10, method, camera()).unwrap()
}

/// A gray image with a red rectangle.
fn red_at(columns: std::ops::Range<u32>, rows: std::ops::Range<u32>) -> RgbImage {
    RgbImage::from_fn(160, 120, |x, y| {
        if columns.contains(&x) && rows.contains(&y) { Rgb([180, 10, 12]) } else { Rgb([140, 140, 136]) }
    })
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn both_methods_find_the_middle(left in 0_u32..150, top in 0_u32..100, width in 4_u32..40, height in 6_u32..40) {
        let (right, bottom) = ((left + width).min(160), (top + height).min(120));
        prop_assume!(right - left >= 4);
        let image = red_at(left..right, top..bottom);
        for method in [FindMethod::Histogram, FindMethod::Blob] {
            let found = finder(method).find(&image).unwrap().unwrap();
            prop_assert_eq!(found.columns, (left as usize, right as usize - 1));
            prop_assert_eq!(found.column, f64::from(left + right - 1) / 2.0);
            let column = 79.5 - math::tan(found.bearing) * camera().focal(160);
            prop_assert!((column - found.column).abs() < 1e-9);
        }
        prop_assert!(finder(FindMethod::Blob).find(&RgbImage::from_pixel(160, 120, Rgb([90; 3]))).unwrap().is_none());
    }

    #[test]
    fn a_foot_on_the_floor_tells_the_place(x in 0.15..3.0f64, aside in -0.5..0.5f64) {
        let place = Point::new(camera().ahead + x, aside * x);
        let focal = camera().focal(320);
        let (column, row) = (159.5 - focal * aside, 119.5 + focal * camera().height / x);
        let found = camera().floor(column, row, (320, 240));
        if row > 120.5 {
            prop_assert!((found.unwrap() - place).norm() < 1e-9);
        }
        prop_assert!(camera().floor(column, 119.0, (320, 240)).is_none());
    }

    #[test]
    fn a_hue_is_taught_in_any_light(hue in 0_u32..6, light in 40_u32..256) {
        let corner = |on: u32| if on & 1 == 1 { light as u8 } else { 0 };
        // Red, yellow, green, cyan, blue, magenta.
        let mix = [0b001, 0b011, 0b010, 0b110, 0b100, 0b101][hue as usize];
        let image = RgbImage::from_pixel(160, 120, Rgb([corner(mix), corner(mix >> 1), corner(mix >> 2)]));
        let taught = teach_hue(&image, ColourFinder::LIMITS).unwrap().unwrap();
        prop_assert_eq!(u32::from(taught), (42 + 42 * hue) % 252);
    }
}

#[test]
fn gray_teaches_nothing() {
    let gray = RgbImage::from_pixel(160, 120, Rgb([120, 121, 120]));
    assert_eq!(teach_hue(&gray, HueLimits { min_saturation: 40, min_intensity: 6 }).unwrap(), None);
    assert!(teach_hue(&RgbImage::default(), ColourFinder::LIMITS).is_err());
    assert!(finder(FindMethod::Blob).find(&RgbImage::default()).is_err());
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
        let mut tracker = ColourTracker::new(finder(method), TrackerParameters::default());
        let outcome = tracker.run(&mut robot, 120.0, |_, _, _| Ok(())).unwrap();
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
            PushHome::new(finder(FindMethod::Blob), Point::origin(), HomeParameters::default());
        let outcome = behaviour.run(&mut robot, 240.0, |_, _, _| Ok(())).unwrap();
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
    let mut behaviour = PushHome::new(finder(FindMethod::Blob), Point::origin(), HomeParameters::default());
    for _ in 0..20 {
        if behaviour.phase() == HomePhase::Finding {
            behaviour.run(&mut robot, 2.0, |_, _, _| Ok(())).unwrap();
        }
    }
    assert_ne!(behaviour.phase(), HomePhase::Finding);
    // Nothing is there any more, for the lidar and for the camera.
    let (image, scan) = (RgbImage::from_pixel(160, 120, Rgb([90; 3])), LidarScan::default());
    let pose = robot.pose().unwrap();
    let mut step = |i: u32| {
        let time = 100.0 + 0.1 * f64::from(i);
        behaviour.step(&ColourObservation { time, image: &image, scan: &scan, pose }).unwrap().unwrap()
    };
    let twists: Vec<Twist> = (0..15).map(&mut step).collect();
    assert!(twists[14].linear == 0.0 && twists[14].angular > 0.1, "{twists:?}");
    assert_eq!((behaviour.phase(), behaviour.object()), (HomePhase::Finding, None));
}

#[test]
fn a_camera_spec_gives_its_geometry() {
    let spec = CameraSpec { field_of_view: 1.0, ..RobotSpec::s4().camera.unwrap() };
    let geometry = CameraGeometry::from(&spec);
    assert_eq!((geometry.field_of_view, geometry.height, geometry.ahead), (1.0, 0.060, 0.062));
}
