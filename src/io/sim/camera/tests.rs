//! Scenes whose pictures are known by geometry.

use std::f64::consts::FRAC_PI_3;
use std::sync::Arc;

use image::{Rgb, RgbImage, Rgba, RgbaImage};
use proptest::prelude::*;

use crate::geometry::{Point, Pose, math, units};
use crate::io::sim::{Fleet, SimOptions, Simulation};
use crate::io::{Camera, Clock, Drive, Error, ErrorKind, Resolution, Servos};
use crate::world::{
    Billboard, Colour, Face, Marker, Material, Mesh, Object, ObjectKind, RobotPlacement, RobotSpec, Scene,
    Shape, Texture, Wall, World,
};

/// The height of the S4's camera above the floor, and how far ahead of its middle it is.
const HEIGHT: f64 = 0.060;
const AHEAD: f64 = 0.062;

fn object(shape: Shape, colour: Colour, x: f64, y: f64) -> Object {
    Object::new(Arc::new(ObjectKind::new("thing", shape, colour)), Pose::new(x, y, 0.0))
}

/// A floor of 8 m by 8 m with an S4 in its middle that looks along x.
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

/// Columns and rows from the first to the last pixel that `is_it`.
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

/// Pixels that a metre covers at a distance of a metre, in QVGA.
fn focal() -> f64 {
    160.0 / math::tan(0.5 * FRAC_PI_3)
}

fn assert_extent(found: Option<[u32; 4]>, expected: [f64; 4]) {
    let found = found.expect("something to be seen").map(f64::from);
    // The first pixel whose middle is behind an edge, and the last one before it.
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
        // The lines of sight that touch it, to either side of its middle.
        let away = math::hypot(distance, aside);
        let (middle, half) = (math::atan2(aside, distance), math::asin(radius / away));
        let column = |angle: f64| 160.0 + focal() * math::tan(angle);
        // The nearest points of its foot and of its top's rim, straight ahead of the camera.
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

/// The first row of the floor in the middle column.
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
    // A ninth of the way up is 10 degrees: the horizon comes lower.
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
    // The wall is lower than the eye: the can's upper part looks over it.
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
    // From behind it is gray.
    scene.world.billboards[0].pose.heading = 0.0;
    assert!(extent(&picture(&scene), is_red).is_none());
}

/// The S4 at the middle of a floor with an image of `columns` by `columns` pixels.
fn on_a_floor(columns: u32, colour: impl Fn(u32, u32) -> [u8; 3]) -> Scene {
    let mut scene = scene();
    let image = RgbaImage::from_fn(columns, columns, |x, y| {
        let [r, g, b] = colour(x, y);
        Rgba([r, g, b, 255])
    });
    scene.world.floor_texture = Some(Texture::new("floor.png", image));
    scene
}

#[test]
fn a_floor_has_no_stairs_near_the_camera() {
    // One red half and one white: the border runs ahead of the robot, and a texel is 80 mm wide.
    let scene = on_a_floor(100, |_, y| if y < 50 { [255, 0, 0] } else { [255; 3] });
    let image = picture(&scene);
    let row: Vec<i32> = (0..320).map(|x| i32::from(image.get_pixel(x, 230)[1])).collect();
    let steps: Vec<i32> = row.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(row[0] < 10 && row[319] > 200, "red to the left, white to the right");
    assert!(steps.iter().all(|&step| (0..30).contains(&step)), "{steps:?}");
}

#[test]
fn a_floor_far_away_is_the_mean_of_what_a_pixel_covers() {
    // Stripes across the way, each of 20 mm: far away they are gray.
    let scene = on_a_floor(400, |x, _| if x % 2 == 0 { [255; 3] } else { [0; 3] });
    let image = picture(&scene);
    for y in 126..132 {
        for x in 100..220 {
            let level = i32::from(image.get_pixel(x, y)[0]);
            assert!((level - 116).abs() < 30, "{x} {y}: {level}");
        }
    }
    let near: Vec<u8> = (200..240).map(|y| image.get_pixel(160, y)[0]).collect();
    assert!(near.iter().max() > Some(&200) && near.iter().min() < Some(&30), "{near:?}");
}

/// A line along the robot's way, 20 mm wide, seen from 60 mm up: it stays a line as far as a pixel is narrower.
#[test]
fn a_line_ahead_stays_sharp_far_away() {
    let scene = on_a_floor(1600, |_, y| if (798..802).contains(&y) { [255; 3] } else { [0; 3] });
    let image = picture(&scene);
    // 2 m away: 8 rows below the horizon; a pixel is 7 mm wide.
    let row: Vec<u8> = (0..320).map(|x| image.get_pixel(x, 128)[0]).collect();
    assert!(row[159..161].iter().all(|&level| level > 150), "{row:?}");
    assert!(row[150] < 30 && row[170] < 30, "{row:?}");
}

#[test]
fn a_sign_shows_its_picture_to_those_who_come_along_its_heading() {
    let stop = Arc::new(ObjectKind::predefined("StopSign").unwrap());
    let seen = |heading: f64| {
        let mut scene = scene();
        scene.world.objects.push(Object::new(Arc::clone(&stop), Pose::new(5.0, 4.0, heading)));
        picture(&scene)
    };
    let red = |[r, g, b]: [u8; 3]| r > 90 && g < 60 && b < 60;
    let image = seen(0.0);
    // The plate is 130 mm wide and high and ends 430 mm above the floor.
    let depth = 1.0 - AHEAD;
    let row = |z: f64| 120.0 + focal() * (HEIGHT - z) / depth;
    let half = focal() * 0.065 / depth;
    let found = extent(&image, |p| red(p) || p.iter().all(|&c| c > 235));
    let [left, right, top, bottom] = extent(&image, red).unwrap();
    assert!((f64::from(right - left) - 2.0 * half).abs() < 0.15 * half, "{left} {right} {found:?}");
    assert!((f64::from(top) - row(0.430)).abs() < 4.0 && (f64::from(bottom) - row(0.300)).abs() < 4.0);
    let plate =
        image.enumerate_pixels().filter(|(x, y, _)| (left..=right).contains(x) && (top..=bottom).contains(y));
    let bright = plate.filter(|(.., p)| p.0.iter().all(|&c| c > 120)).count();
    assert!(bright > 100, "white letters: {bright}");
    assert_eq!(extent(&seen(std::f64::consts::PI), red), None, "its back is gray");
    assert!(extent(&seen(0.7), red).is_some());
}

#[test]
fn a_model_is_drawn_where_its_corners_are() {
    let mut scene = scene();
    let corners = [[0.0, -0.1, 0.0], [0.0, 0.2, 0.0], [0.0, 0.2, 0.3], [0.0, -0.1, 0.3]];
    let face = |order: [usize; 3]| Face {
        corners: order.map(|i| corners[i]),
        image_corners: [[0.0; 2]; 3],
        material: 0,
    };
    // Seen from before and from behind.
    let faces = vec![face([0, 1, 2]), face([3, 2, 0])];
    let mesh = Mesh { materials: vec![Material { colour: Colour::RED, image: None }], faces };
    let shape = Shape::Sphere { radius: 0.01 };
    let kind = ObjectKind { mesh: Some(Arc::new(mesh)), ..ObjectKind::new("flag", shape, Colour::GREEN) };
    scene.world.objects.push(Object::new(Arc::new(kind), Pose::new(6.0, 4.0, 0.0)));
    let depth = 2.0 - AHEAD;
    let expected = [
        160.0 - focal() * 0.2 / depth,
        160.0 + focal() * 0.1 / depth,
        120.0 - focal() * (0.3 - HEIGHT) / depth,
        120.0 + focal() * HEIGHT / depth,
    ];
    assert_extent(extent(&picture(&scene), is_red), expected);
    scene.world.objects[0].pose.heading = std::f64::consts::FRAC_PI_2;
    assert_eq!(extent(&picture(&scene), is_red), None, "from the side there is nothing to see");
}

#[test]
fn cones_narrow_upwards_and_have_their_colours() {
    for (name, colour) in [("Cone-B", [0, 0, 1]), ("Cone-Y", [1, 1, 0]), ("Cone-O", [1, 0, 0])] {
        let mut scene = scene();
        let kind = Arc::new(ObjectKind::predefined(name).unwrap());
        scene.world.objects.push(Object::new(kind, Pose::new(5.2, 4.0, 0.4)));
        let image = picture(&scene);
        let is_it = |p: [u8; 3]| {
            (0..3)
                .all(|i| if colour[i] == 1 { p[i] > 90 } else { p[i] < 110 || (name == "Cone-O" && i == 1) })
                && p.iter().max().unwrap() - p.iter().min().unwrap() > 60
        };
        let [left, right, top, bottom] = extent(&image, is_it).unwrap();
        let width = |y: u32| (left..=right).filter(|&x| is_it(image.get_pixel(x, y).0)).count();
        assert!(width(bottom) > 2 * width(top + 2), "{name}: {} {}", width(bottom), width(top + 2));
        assert!((left + right).abs_diff(319) <= 3, "{name}");
    }
}

#[test]
fn a_fisheye_measures_angles() {
    let mut scene = scene();
    scene.robots[0].spec = {
        let mut spec = RobotSpec::s4();
        let camera = spec.camera.as_mut().unwrap();
        (camera.field_of_view, camera.fisheye) = (units::from_deg(180.0), true);
        Arc::new(spec)
    };
    let middle = Point::new(4.0 + AHEAD, 4.0);
    // 160 columns for 90 degrees to either side.
    for degrees in [-80.0, -60.0, -10.0, 0.0, 33.0, 75.0] {
        let (sin, cos) = math::sin_cos(units::from_deg(degrees));
        let place = middle + crate::geometry::Vector::new(cos, sin) * 0.8;
        scene.world.objects = vec![object(Shape::Sphere { radius: 0.03 }, Colour::RED, place.x, place.y)];
        scene.world.objects[0].elevation = HEIGHT - 0.03;
        let [left, right, top, bottom] = extent(&picture(&scene), is_red).unwrap();
        let expected = 160.0 - degrees / 90.0 * 160.0;
        let found = 0.5 * f64::from(left + right + 1);
        assert!((found - expected).abs() <= 1.0, "{degrees}: {found}, {expected}");
        assert!((f64::from(top + bottom + 1) - 240.0).abs() <= 2.0, "{degrees}: {top} {bottom}");
        // A ball of 4.3 degrees is as large in the corner of the eye as in the middle.
        assert!((f64::from(right - left + 1) - 7.64).abs() <= 1.5, "{degrees}: {left} {right}");
    }
    // The horizon of a camera that looks up by 30 degrees lies 30 degrees lower.
    let mut robot = Simulation::new(&scene, SimOptions::ideal()).unwrap().robot(0).unwrap();
    robot.set_resolution(Resolution::Qvga).unwrap();
    robot.set_servo(2, 1.0 / 3.0).unwrap();
    robot.wait(2.0).unwrap();
    let expected = 120.0 + 30.0 / 90.0 * 160.0;
    assert!((f64::from(horizon(&robot.image().unwrap())) - expected).abs() <= 1.5);
}

#[test]
fn between_frames_the_image_stays() {
    let scene = scene();
    let options = SimOptions::with_noise(1.0, 5);
    let mut robot = Simulation::new(&scene, options).unwrap().robot(0).unwrap();
    robot.set_speed(crate::geometry::Twist::new(0.0, 1.0)).unwrap();
    let mut images = Vec::new();
    // 300 ms in steps of a tick: nine frames.
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

/// A scene with something of everything.
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

/// The FNV-1a digest of bytes.
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
    // Fixed, so that other platforms and processors can be compared with this one.
    assert_eq!((digest(&clean), digest(&take(1))), (0x5d06_252d_9053_1be6, 0x5d9e_09b6_d630_6540));
}

proptest! {
    #![proptest_config(crate::testing::cases(64))]

    /// Whatever stands wherever, also across the lens, a picture comes out, and from outside of everything the floor
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
