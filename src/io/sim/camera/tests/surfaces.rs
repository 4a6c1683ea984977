//! Floor images, 3D models and fisheye pictures.

use super::*;
use crate::world::{Face, Material, Mesh, Texture};

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
    // One half red, one white: the border runs ahead of the robot; a texel is 80 mm wide.
    let scene = on_a_floor(100, |_, y| if y < 50 { [255, 0, 0] } else { [255; 3] });
    let image = picture(&scene);
    let row: Vec<i32> = (0..320).map(|x| i32::from(image.get_pixel(x, 230)[1])).collect();
    let steps: Vec<i32> = row.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(row[0] < 10 && row[319] > 200, "red to the left, white to the right");
    assert!(steps.iter().all(|&step| (0..30).contains(&step)), "{steps:?}");
}

#[test]
fn a_floor_far_away_is_the_mean_of_what_a_pixel_covers() {
    // Transverse stripes of 20 mm, gray far away.
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

/// A line 20 mm wide along the robot's way, seen from a height of 60 mm, where pixels are much deeper than
/// wide.
#[test]
fn a_line_ahead_stays_sharp_far_away() {
    let scene = on_a_floor(1600, |_, y| if (798..802).contains(&y) { [255; 3] } else { [0; 3] });
    let image = picture(&scene);
    // At one and two metres, a pixel is 4 and 7 mm wide, and 60 and 230 mm deep.
    for (y, least, reach) in [(136, 200, 5), (128, 90, 6)] {
        let row: Vec<u8> = (0..320).map(|x| image.get_pixel(x, y)[0]).collect();
        assert!(row[159..161].iter().all(|&level| level > least), "{row:?}");
        assert!(row[..160 - reach].iter().chain(&row[160 + reach..]).all(|&level| level < 10), "{row:?}");
    }
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
    // The plate is 130 mm wide and high; its upper edge is at 430 mm.
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
    // Visible from both sides.
    let faces = vec![face([0, 1, 2]), face([3, 2, 0])];
    let mesh = Mesh { materials: vec![Material { colour: Colour::RED, image: None }], faces };
    let shape = Shape::Sphere { radius: 0.01 };
    let kind = ObjectKind { mesh: Some(Arc::new(mesh)), ..ObjectKind::new("flag", shape, Colour::GREEN) };
    let pose = Pose::new(6.0, 4.0, 0.0);
    let robot = RobotSpec { mesh: kind.mesh.clone(), ..RobotSpec::s4() };
    scene.robots.push(RobotPlacement::new(Arc::new(robot), pose));
    let of_a_robot = picture(&scene);
    scene.robots.pop();
    scene.world.objects.push(Object::new(Arc::new(kind), pose));
    assert!(of_a_robot == picture(&scene), "a robot's model is drawn as an object's");
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
        let widest = (top..=bottom).map(width).max().unwrap();
        assert!(widest > 3 * width(top + 2), "{name}: {widest} {}", width(top + 2));
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
        // A ball of 4.3 degrees is as large at the edge as in the middle.
        assert!((f64::from(right - left + 1) - 7.64).abs() <= 1.5, "{degrees}: {left} {right}");
    }
    // The horizon of a camera tilted up by 30 degrees is 30 degrees lower.
    let mut robot = Simulation::new(&scene, SimOptions::ideal()).unwrap().robot(0).unwrap();
    robot.set_resolution(Resolution::Qvga).unwrap();
    robot.set_servo(2, 1.0 / 3.0).unwrap();
    robot.wait(2.0).unwrap();
    let expected = 120.0 + 30.0 / 90.0 * 160.0;
    assert!((f64::from(horizon(&robot.image().unwrap())) - expected).abs() <= 1.5);
}
