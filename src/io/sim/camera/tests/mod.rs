//! Scenes whose pictures are known from geometry.

mod surfaces;

use std::f64::consts::FRAC_PI_3;
use std::sync::Arc;

use image::{Rgb, RgbImage, Rgba, RgbaImage};
use proptest::prelude::*;

use crate::geometry::{Point, Pose, math, units};
use crate::io::sim::{Fleet, SimOptions, Simulation};
use crate::io::{Camera, Clock, Drive, Error, ErrorKind, Resolution, Servos};
use crate::world::{
    Billboard, Colour, Marker, Object, ObjectKind, RobotPlacement, RobotSpec, Scene, Shape, Wall, World,
};

/// Height of the S4's camera above the floor (m).
const HEIGHT: f64 = 0.060;
/// Distance of the S4's camera ahead of the robot's middle (m).
const AHEAD: f64 = 0.062;

fn object(shape: Shape, colour: Colour, x: f64, y: f64) -> Object {
    Object::new(Arc::new(ObjectKind::new("thing", shape, colour)), Pose::new(x, y, 0.0))
}

/// A floor of 8 m by 8 m with an S4 in the middle, facing along x.
fn scene() -> Scene {
    Scene::with_robot(World::empty(8.0, 8.0), RobotSpec::s4(), Pose::new(4.0, 4.0, 0.0))
}

fn picture_with(scene: &Scene, options: SimOptions, resolution: Resolution) -> RgbImage {
    let mut robot = Simulation::new(scene, options).unwrap().robot(0).unwrap();
    robot.set_resolution(resolution).unwrap();
    robot.image().unwrap()
}

fn picture(scene: &Scene) -> RgbImage {
    picture_with(scene, SimOptions::ideal(), Resolution::Qvga)
}

/// Columns and rows of the first and last pixel for which `is_it`.
fn extent(image: &RgbImage, is_it: impl Fn([u8; 3]) -> bool) -> Option<[u32; 4]> {
    let hits: Vec<_> =
        image.enumerate_pixels().filter(|(_, _, p)| is_it(p.0)).map(|(x, y, _)| (x, y)).collect();
    let columns = || hits.iter().map(|hit| hit.0);
    let rows = || hits.iter().map(|hit| hit.1);
    Some([columns().min()?, columns().max()?, rows().min()?, rows().max()?])
}

fn is_red([r, g, b]: [u8; 3]) -> bool {
    r > 60 && g < 10 && b < 10
}

/// Pixels per metre at a distance of one metre, in QVGA.
fn focal() -> f64 {
    160.0 / math::tan(0.5 * FRAC_PI_3)
}

fn assert_extent(found: Option<[u32; 4]>, expected: [f64; 4]) {
    let found = found.expect("something to be seen").map(f64::from);
    // First pixel whose centre is beyond an edge, and the last one before it.
    let expected = [expected[0], expected[1] - 1.0, expected[2], expected[3] - 1.0];
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found - expected).abs() <= 0.5 + 0.3, "found {found}, expected {expected}");
    }
}

#[test]
fn a_can_stands_where_it_is_projected() {
    for (distance, aside) in [(0.5, 0.0), (1.0, 0.2), (2.0, -0.7)] {
        let mut scene = scene();
        let (radius, height) = (0.1, 0.2);
        let can =
            object(Shape::Cylinder { radius, height }, Colour::RED, 4.0 + AHEAD + distance, 4.0 - aside);
        scene.world.objects.push(can);
        // The tangents on both sides of its middle.
        let away = math::hypot(distance, aside);
        let (middle, half) = (math::atan2(aside, distance), math::asin(radius / away));
        let column = |angle: f64| 160.0 + focal() * math::tan(angle);
        // The nearest points of its foot and its top's rim.
        let near = distance - radius;
        let row = |z: f64, depth: f64| 120.0 + focal() * (HEIGHT - z) / depth;
        let expected = [column(middle - half), column(middle + half), row(height, near), row(0.0, near)];
        assert_extent(extent(&picture(&scene), is_red), expected);
    }
}

#[test]
fn a_ball_is_seen_as_large_as_it_is() {
    let mut scene = scene();
    let (radius, distance) = (0.11, 0.9);
    scene.world.objects.push(object(Shape::Sphere { radius }, Colour::RED, 4.0 + AHEAD + distance, 4.0));
    let half = math::asin(radius / distance);
    let up = math::asin(radius / math::hypot(distance, radius - HEIGHT));
    let middle = math::atan2(radius - HEIGHT, distance);
    let expected = [
        160.0 - focal() * math::tan(half),
        160.0 + focal() * math::tan(half),
        120.0 - focal() * math::tan(middle + up),
        120.0 - focal() * math::tan(middle - up),
    ];
    assert_extent(extent(&picture(&scene), is_red), expected);
}

#[test]
fn a_wall_and_a_box_have_straight_edges_at_their_places() {
    let mut scene = scene();
    let mut wall = Wall::new(Point::new(6.0, 3.8), Point::new(6.0, 4.3));
    (wall.height, wall.thickness, wall.colour) = (0.3, 0.1, Colour::RED);
    scene.world.walls.push(wall);
    let depth = 2.0 - 0.05 - AHEAD;
    let expected = [
        160.0 - focal() * 0.3 / depth,
        160.0 + focal() * 0.2 / depth,
        120.0 - focal() * (0.3 - HEIGHT) / depth,
        120.0 + focal() * HEIGHT / depth,
    ];
    assert_extent(extent(&picture(&scene), is_red), expected);
    scene.world.walls.clear();
    let crate_ = Shape::Box { length: 0.1, width: 0.5, height: 0.3 };
    scene.world.objects.push(object(crate_, Colour::RED, 6.0, 4.05));
    assert_extent(extent(&picture(&scene), is_red), expected);
}

/// First row of the floor in the middle column.
fn horizon(image: &RgbImage) -> u32 {
    let sky = |p: &Rgb<u8>| p.0[2] > p.0[0];
    (0..image.height()).find(|&y| !sky(image.get_pixel(image.width() / 2, y))).unwrap()
}

#[test]
fn the_horizon_lies_in_the_middle_and_moves_with_the_tilt() {
    let scene = scene();
    assert_eq!(horizon(&picture(&scene)), 120);
    let mut robot = Simulation::new(&scene, SimOptions::ideal()).unwrap().robot(0).unwrap();
    robot.set_resolution(Resolution::Qvga).unwrap();
    // Position 1/9 is 10 degrees up; the horizon moves down.
    robot.set_servo(2, 1.0 / 9.0).unwrap();
    robot.wait(1.0).unwrap();
    let expected = 120.0 + focal() * math::tan(units::from_deg(10.0));
    assert!((f64::from(horizon(&robot.image().unwrap())) - expected).abs() <= 1.0);
}

#[test]
fn the_head_pans_to_the_right_and_keeps_its_pace() {
    let mut scene = scene();
    // To the right of the robot.
    let can = object(Shape::Cylinder { radius: 0.05, height: 0.2 }, Colour::RED, 4.0 + AHEAD, 3.0);
    scene.world.objects.push(can);
    let mut robot = Simulation::new(&scene, SimOptions::ideal()).unwrap().robot(0).unwrap();
    robot.set_servo(1, 1.0).unwrap();
    let seen = |image: &RgbImage| extent(image, is_red);
    assert_eq!(seen(&robot.image().unwrap()), None);
    robot.wait(1.0).unwrap();
    assert_eq!(seen(&robot.image().unwrap()), None);
    robot.wait(2.1).unwrap();
    let [left, right, ..] = seen(&robot.image().unwrap()).unwrap();
    assert_eq!(left + right, 159);
    assert_eq!(robot.set_servo(1, 1.5).unwrap_err().kind(), ErrorKind::InvalidInput);
    assert_eq!(robot.set_servo(3, 0.5).unwrap_err().kind(), ErrorKind::Unsupported);
}

#[test]
fn what_is_nearer_hides_what_is_behind() {
    let mut scene = scene();
    let can = Shape::Cylinder { radius: 0.1, height: 0.3 };
    scene.world.objects.push(object(can, Colour::RED, 5.5, 4.0));
    let mut wall = Wall::new(Point::new(5.0, 3.0), Point::new(5.0, 5.0));
    wall.height = 0.05;
    scene.world.walls.push(wall);
    // The wall is lower than the eye, so the can's upper part is visible over it.
    let image = picture(&scene);
    let [_, _, top, bottom] = extent(&image, is_red).unwrap();
    assert!(top < 120 && (120..126).contains(&bottom), "{top} {bottom}");
    scene.world.walls[0].height = 0.5;
    assert_eq!(extent(&picture(&scene), is_red), None);
}

#[test]
fn other_robots_are_seen_and_the_robot_itself_is_not() {
    let mut scene = scene();
    let alone = picture(&scene);
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::s4()), Pose::new(4.5, 4.0, 0.0)));
    let both = picture(&scene);
    assert_ne!(alone, both);
    let blue = |p: [u8; 3]| i32::from(p[2]) > i32::from(p[0]) + 20 && p[1] < 100;
    assert!(extent(&alone, blue).is_none());
    let dark = |p: [u8; 3]| p.iter().all(|&c| c < 60);
    assert!(extent(&both, dark).is_some());
}

#[test]
fn a_robot_is_seen_to_turn_whichever_way_it_looks() {
    let mut scene = scene();
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::s4()), Pose::new(4.5, 4.0, 0.0)));
    let pictures: Vec<_> = (0..37)
        .map(|step| {
            scene.robots[1].pose.heading = units::from_deg(10.0 * f64::from(step));
            picture(&scene)
        })
        .collect();
    for (step, pair) in pictures.windows(2).enumerate() {
        let changed = pair[0].pixels().zip(pair[1].pixels()).filter(|(a, b)| a != b).count();
        assert!(changed > 30, "from {} degrees on: {changed}", 10 * step);
    }
}

#[test]
fn markers_lie_on_the_floor() {
    let mut scene = scene();
    scene.world.markers.push(Marker { position: Point::new(4.4, 4.0), colour: Colour::RED, alpha: 255 });
    let [left, right, top, bottom] = extent(&picture(&scene), is_red).unwrap();
    let depth = 0.4 - AHEAD;
    assert_eq!(left + right, 319);
    let row = 120.0 + focal() * HEIGHT / depth;
    assert!((top..=bottom).contains(&(row as u32)), "{top} {bottom} {row}");
}

#[test]
fn a_billboard_shows_its_picture_upright_and_unmirrored() {
    let mut scene = scene();
    let quarters = RgbaImage::from_fn(2, 2, |x, y| match (x, y) {
        (0, 0) => Rgba([255, 0, 0, 255]),
        (1, 0) => Rgba([0, 255, 0, 255]),
        (0, 1) => Rgba([0, 0, 255, 255]),
        _ => Rgba([0, 0, 0, 0]),
    });
    scene.world.billboards.push(Billboard {
        pose: Pose::new(5.0, 4.0, std::f64::consts::PI),
        width: 0.4,
        height: 0.4,
        elevation: 0.0,
        image: Arc::new(quarters),
    });
    let image = picture(&scene);
    let (depth, middle) = (1.0 - AHEAD, 0.2);
    let row = |z: f64| 120.0 + focal() * (HEIGHT - z) / depth;
    let column = |right: f64| 160.0 + focal() * right / depth;
    let red = extent(&image, is_red);
    assert_extent(red, [column(-0.2), column(0.0), row(0.4), row(middle)]);
    let green = extent(&image, |p| p[1] > 60 && p[0] < 10);
    assert_extent(green, [column(0.0), column(0.2), row(0.4), row(middle)]);
    let blue = extent(&image, |p| p[2] > 60 && p[0] < 10);
    assert_extent(blue, [column(-0.2), column(0.0), row(middle), row(0.0)]);
    // Its back is gray.
    scene.world.billboards[0].pose.heading = 0.0;
    assert!(extent(&picture(&scene), is_red).is_none());
}

#[test]
fn between_frames_the_image_stays() {
    let scene = scene();
    let options = SimOptions::with_noise(1.0, 5);
    let mut robot = Simulation::new(&scene, options).unwrap().robot(0).unwrap();
    robot.set_speed(crate::geometry::Twist::new(0.0, 1.0)).unwrap();
    let mut images = Vec::new();
    // 300 ms in steps of one tick: nine frames.
    for _ in 0..30 {
        images.push(robot.image().unwrap());
        robot.wait(0.01).unwrap();
    }
    images.dedup();
    assert!((9..=10).contains(&images.len()), "{}", images.len());
    robot.set_resolution(Resolution::Qvga).unwrap();
    assert_eq!(robot.image().unwrap().dimensions(), (320, 240), "another size is another image");
}

#[test]
fn a_mast_is_seen_above_a_robot() {
    let mut scene = scene();
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::labbot()), Pose::new(5.0, 4.0, 0.0)));
    let mut short = scene.clone();
    short.robots[1].spec = Arc::new(RobotSpec { mast: None, ..RobotSpec::labbot() });
    let (with, without) = (picture(&scene), picture(&short));
    let changed = with.enumerate_pixels().filter(|&(x, y, p)| p != without.get_pixel(x, y));
    let (columns, rows): (Vec<u32>, Vec<u32>) = changed.map(|(x, y, _)| (x, y)).unzip();
    // 110 mm wide at 0.88 m, up to 0.6 m.
    let width = columns.iter().max().unwrap() - columns.iter().min().unwrap() + 1;
    assert!(width.abs_diff((focal() * 0.11 / 0.878) as u32) <= 2, "{width}");
    assert!(rows.iter().all(|&y| y < 120 - (focal() * 0.05 / 0.9) as u32));
}

#[test]
fn light_scales_the_brightness() {
    let scene = scene();
    let mean = |light| {
        let options = SimOptions { light, ..SimOptions::ideal() };
        let image = picture_with(&scene, options, Resolution::Qqvga);
        image.iter().map(|&v| f64::from(v)).sum::<f64>() / image.len() as f64
    };
    let full = mean(1.0);
    assert!((mean(0.5) - 0.5 * full).abs() < 1.0 && (mean(0.3) - 0.3 * full).abs() < 1.0);
    assert_eq!(mean(0.0), 0.0);
    assert_eq!(mean(100.0), 255.0);
}

#[test]
fn every_resolution_shows_the_same() {
    let mut scene = scene();
    scene.world.objects.push(object(Shape::Sphere { radius: 0.1 }, Colour::RED, 5.0, 4.1));
    for resolution in Resolution::ALL {
        let image = picture_with(&scene, SimOptions::ideal(), resolution);
        assert_eq!(image.dimensions(), resolution.dimensions());
        let [left, right, ..] = extent(&image, is_red).unwrap();
        let middle = f64::from(left + right + 1) / 2.0 / f64::from(image.width());
        assert!((middle - 0.408).abs() < 0.005, "{middle}");
    }
}

#[test]
fn a_fleet_sees_what_single_robots_see() {
    let scene = scene();
    let single = picture(&scene);
    let mut seen = None;
    let mut fleet = Fleet::new(&scene, SimOptions::ideal()).unwrap();
    fleet
        .control(0, 0.1, |robot| {
            robot.set_resolution(Resolution::Qvga)?;
            seen = Some(robot.image()?);
            Ok(std::ops::ControlFlow::Break(()))
        })
        .unwrap();
    fleet.run_for(1.0).unwrap();
    drop(fleet);
    assert_eq!(seen, Some(single));
}

#[test]
fn what_cannot_be_drawn_is_an_error_with_its_name() {
    let image = |scene: &Scene| -> Error {
        let mut robot = Simulation::new(scene, SimOptions::ideal()).unwrap().robot(0).unwrap();
        robot.image().unwrap_err()
    };
    let mut blind = RobotSpec::s4();
    blind.camera = None;
    let start = Pose::new(1.0, 1.0, 0.0);
    let error = image(&Scene::with_robot(World::empty(2.0, 2.0), blind, start));
    assert_eq!(error.to_string(), "the robot has no camera");
    let mut wide = RobotSpec::s4();
    wide.camera.as_mut().unwrap().field_of_view = units::from_deg(180.0);
    let error = image(&Scene::with_robot(World::empty(2.0, 2.0), wide, start));
    assert!(error.to_string().contains("180 degrees"), "{error}");
    let mut carpet = scene();
    carpet.world.floor_texture = Some("no/such/carpet.png".into());
    assert!(image(&carpet).to_string().contains("no/such/carpet.png"));
    let options = SimOptions { light: f64::NAN, ..SimOptions::ideal() };
    assert!(Simulation::new(&scene(), options).unwrap_err().to_string().starts_with("light is NaN"));
}

/// A scene with all kinds of objects.
fn busy_scene(heading: f64) -> Scene {
    let mut scene = Scene::with_robot(World::walled(4.0, 3.0), RobotSpec::s4(), Pose::new(1.0, 1.0, heading));
    for (i, name) in ["can", "soccer", "golf", "crate"].into_iter().enumerate() {
        let kind = Arc::new(ObjectKind::predefined(name).unwrap());
        let angle = heading + 0.3 * (i as f64 - 1.5);
        let (sin, cos) = math::sin_cos(angle);
        scene.world.objects.push(Object::new(kind, Pose::new(1.0 + 0.8 * cos, 1.0 + 0.8 * sin, angle)));
    }
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::omni()), Pose::new(2.0, 2.0, 1.0)));
    scene.world.markers.push(Marker { position: Point::new(1.4, 1.1), colour: Colour::GREEN, alpha: 128 });
    scene
}

/// FNV-1a digest of bytes.
fn digest(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let take = |seed| picture_with(&busy_scene(0.7), SimOptions::with_noise(1.0, seed), Resolution::Qvga);
    assert_eq!(take(1), take(1));
    assert_ne!(take(1), take(2));
    let clean = picture_with(&busy_scene(0.7), SimOptions::ideal(), Resolution::Qvga);
    // Fixed values, to compare other platforms and processors with this one.
    assert_eq!((digest(&clean), digest(&take(1))), (0x7169_edf6_2411_872c, 0x884e_13bb_ee03_99df));
}

proptest! {
    #![proptest_config(crate::testing::cases(64))]

    /// For any arrangement, even across the lens, a picture results; from outside of all objects, the floor
    /// begins below the sky.
    #[test]
    fn no_scene_is_too_odd(
        x in -1.0..5.0f64, y in -1.0..4.0f64, heading in -4.0..4.0f64,
        things in proptest::collection::vec((0..3_usize, -0.5..0.5f64, -0.5..0.5f64, 0.001..0.3f64), 0..12),
        (pan, tilt) in (-1.0..=1.0f64, -1.0..=1.0f64),
    ) {
        let mut scene = Scene::with_robot(World::walled(4.0, 3.0), RobotSpec::s4(), Pose::new(x, y, heading));
        for (kind, dx, dy, size) in things {
            let shape = match kind {
                0 => Shape::Sphere { radius: size },
                1 => Shape::Cylinder { radius: size, height: 0.5 * size },
                _ => Shape::Box { length: size, width: 0.01, height: 2.0 * size },
            };
            scene.world.objects.push(object(shape, Colour::RED, x + dx, y + dy));
        }
        let mut robot = Simulation::new(&scene, SimOptions::default()).unwrap().robot(0).unwrap();
        robot.set_servo(1, pan).unwrap();
        robot.set_servo(2, tilt).unwrap();
        robot.wait(3.0).unwrap();
        let image = robot.image().unwrap();
        prop_assert_eq!(image.dimensions(), (160, 120));
    }
}
