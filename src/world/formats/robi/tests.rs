use proptest::prelude::*;

use super::{parse, parse_with_model, print};
use crate::geometry::{Aabb, Point, units};
use crate::kinematics::marine::Craft;
use crate::world::formats::MemoryFiles;
use crate::world::formats::source::Files;
use crate::world::{
    Axis, Body, CameraSpec, Collider, DriveSpec, Footprint, InertialSpec, LidarSpec, MotorSpec, Mount,
    PsdSpec, RobotSpec,
};

const DRIVE: &str = "drive DIFFERENTIAL_DRIVE\nwheel 54 3600 1100 45\n";

fn robot(text: &str) -> RobotSpec {
    parse(text, "robots/Robo.robi").unwrap().value
}

fn psds(lines: &str) -> Vec<(u8, f64, f64, f64, f64)> {
    let spec = robot(&format!("{DRIVE}{lines}"));
    let round = |v: f64| (v * 1e9).round() / 1e6;
    let flat = |p: &PsdSpec| {
        let m = p.mount;
        (p.id, round(m.x), round(m.y), round(m.z), units::to_deg(m.yaw).round())
    };
    spec.psds.iter().map(flat).collect()
}

#[test]
fn a_whole_description() {
    let text = "# a robot\r\nDRIVE differential_drive extra words\r\nname \"My Bot\"\r\nmodel ..\\m\\bot.obj 1 2 3 0 90 0\r\n\
                mass 2.5 0 30 -10\r\naxis 22.7 10.8\r\nwheel 54 3600 1100 45 ; both\r\n\
                collider box 95 74 65 0 46 -50\r\ncollider box 95 40 30 0 30 60\r\n\
                camera 62 0 60 0 0 482 162\r\nfisheye 120\r\nlidar 180 181 -5\r\n";
    let parsed = parse(text, "x.robi").unwrap();
    let warnings: Vec<String> = parsed.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings, ["x.robi:4:7: `model`: cameras see the robot's outline instead"]);
    let spec = parsed.value;
    assert_eq!((spec.name.as_str(), spec.mass), ("My Bot", 2.5));
    assert_eq!(spec.model, Some(r"..\m\bot.obj".into()));
    assert_eq!(spec.body.model_offset, [0.001, 0.002, 0.003]);
    assert_eq!(spec.body.mass_centre, [-0.01, 0.0, 0.03]);
    assert_eq!(spec.body.axle, [0.0108, 0.0227]);
    let DriveSpec::Differential { wheel_diameter, track, max_wheel_speed, ticks_per_turn } = spec.drive
    else {
        panic!("{:?}", spec.drive)
    };
    assert_eq!((wheel_diameter, track, ticks_per_turn), (0.054, 0.09, 1100.0));
    assert_eq!(max_wheel_speed, units::from_deg(3600.0));
    let Footprint::Rectangle(b) = spec.footprint else { panic!("{:?}", spec.footprint) };
    assert!((b.min - Point::new(-0.0933, -0.0475)).norm() < 1e-12, "{b:?}");
    assert!((b.max - Point::new(0.0642, 0.0475)).norm() < 1e-12, "{b:?}");
    assert!((spec.height - 0.083).abs() < 1e-12);
    let camera = spec.camera.unwrap();
    assert!((camera.mount.x - 0.0512).abs() < 1e-12 && camera.mount.z == 0.06 && camera.fisheye);
    assert_eq!(camera.field_of_view, units::from_deg(120.0));
    let lidar = spec.lidar.unwrap();
    assert_eq!(
        (lidar.points, lidar.field_of_view, lidar.tilt),
        (181, units::from_deg(180.0), units::from_deg(-5.0))
    );
}

/// A triangle with corners at the model's origin, 100 mm to the right of it, and 200 mm up and 400 mm ahead.
const TRIANGLE: &str = "v 0 0 0\nv -0.1 0 0\nv 0 0.2 0.4\nf 1 2 3\n";

/// Corners of a robot's model: ahead of the driven axle, to its left and up (mm).
fn corners(model: &str) -> [[f64; 3]; 3] {
    let mut files = MemoryFiles([("bot.obj".into(), TRIANGLE.into())].into());
    let text = format!("{DRIVE}axis 20 10\n{model}\n");
    let parsed = parse_with_model(&text, "x.robi", &mut Files::new(&mut files, false)).unwrap();
    assert_eq!(parsed.warnings, []);
    let mesh = parsed.value.mesh.unwrap();
    assert_eq!(mesh.faces.len(), 1);
    mesh.faces[0].corners.map(|corner| corner.map(|metres| (metres * 1000.0).round() + 0.0))
}

#[test]
fn a_model_stands_where_its_line_says() {
    assert_eq!(corners("model bot.obj"), [[-10.0, 0.0, 0.0], [-10.0, -100.0, 0.0], [390.0, 0.0, 200.0]]);
    let shifted = corners("model bot.obj 1 2 3 0 0 0");
    assert_eq!(shifted, [[-7.0, -1.0, 2.0], [-7.0, -101.0, 2.0], [393.0, -1.0, 202.0]]);
    // To the right, and downwards.
    let turned = corners("model bot.obj 0 0 0 0 90 0");
    assert_eq!(turned, [[-10.0, 0.0, 0.0], [-110.0, 0.0, 0.0], [-10.0, -400.0, 200.0]]);
    let dived = corners("model bot.obj 0 0 0 90 0 0");
    assert_eq!(dived[2], [190.0, 0.0, -400.0]);
    let rolled = corners("model bot.obj 0 0 0 0 0 90");
    assert_eq!(rolled[1..], [[-10.0, 0.0, 100.0], [390.0, 200.0, 0.0]]);
}

#[test]
fn a_model_that_is_missing_is_named_at_its_place() {
    let text = format!("{DRIVE}model bot.obj\n");
    let read =
        |tolerant| parse_with_model(&text, "x.robi", &mut Files::new(&mut MemoryFiles::default(), tolerant));
    let message = "x.robi:3:7: found `bot.obj`, which does not exist; expected a file that exists";
    assert_eq!(read(false).unwrap_err().to_string(), message);
    let parsed = read(true).unwrap();
    assert_eq!((parsed.value.mesh, parsed.warnings.len()), (None, 1));
    assert!(parsed.warnings[0].to_string().starts_with(message), "{}", parsed.warnings[0]);
}

/// The four contradictory kinds of existing files all describe the same kind of robot.
#[test]
fn distance_sensors_of_all_files_in_use() {
    let old = "psd PSD_FRONT 1 60 20 30 0\npsd PSD_LEFT 2 56 45 30 90\npsd PSD_RIGHT 3 56 -45 30 -90";
    assert_eq!(
        psds(old),
        [(1, 60.0, 20.0, 30.0, 0.0), (2, 56.0, 45.0, 30.0, 90.0), (3, 56.0, -45.0, 30.0, -90.0)]
    );
    let new = "psd 1 PSD_FRONT 60 20 30 0 0 0\npsd 2 PSD_LEFT 56 45 30 0 90 0\npsd 3 PSD_RIGHT 56 -45 30 0 -90 0\n\
               psd 4 PSD_BACK 61 20 -30 0 180 0";
    assert_eq!(psds(new)[..3], psds(old)[..]);
    assert_eq!(psds(new)[3].4, 180.0);
    let book = "psd 1 PSD_FRONT 0 60 30 0 0 0\npsd 2 PSD_LEFT 45 60 30 0 0 -90\npsd 3 PSD_RIGHT -45 60 30 0 0 90\n\
                psd 4 PSD_BACK 0 -60 30 0 0 -180\npsd 5 PSD_FL 0 60 30 0 0 -45\npsd 8 PSD_FFR 0 60 30 0 0 25\n\
                psd 9 SLANTED 0 60 30 0 0 25";
    assert_eq!(
        psds(book),
        [
            (1, 60.0, 0.0, 30.0, 0.0),
            (2, 60.0, 45.0, 30.0, 90.0),
            (3, 60.0, -45.0, 30.0, -90.0),
            (4, -60.0, 0.0, 30.0, 180.0),
            (5, 60.0, 0.0, 30.0, 45.0),
            (8, 60.0, 0.0, 30.0, -25.0),
            (9, 60.0, 0.0, 30.0, -25.0),
        ]
    );
    assert_eq!(psds("psd 1 PSD_FRONT 0 60 30 0 0 0"), [(1, 60.0, 0.0, 30.0, 0.0)]);
}

/// All three rotations of a sensor, with both kinds of columns, which are determined by the other sensors.
#[test]
fn sensors_turn_about_all_axes() {
    let turns = |lines: &str| {
        let spec = robot(&format!("{DRIVE}{lines}"));
        let of = |mount: Mount| [mount.roll, mount.pitch, mount.yaw].map(|turn| units::to_deg(turn).round());
        (
            spec.psds.iter().map(|psd| of(psd.mount)).collect::<Vec<_>>(),
            spec.lidar.map(|lidar| of(lidar.mount)),
        )
    };
    let left = "psd 2 PSD_LEFT 56 45 30 0 90 0\npsd 7 DOWN 60 0 30 90 0 0\npsd 8 AHEAD_DOWN 60 0 30 30 -20 0\n\
                lidar 0 0 100 -5 10 3 180 0 180";
    let expected = vec![[0.0, 0.0, 90.0], [0.0, 90.0, 0.0], [0.0, 30.0, -20.0]];
    assert_eq!(turns(left), (expected.clone(), Some([3.0, -5.0, 10.0])));
    let clockwise = "psd 2 PSD_LEFT 45 56 30 0 0 -90\npsd 7 DOWN 0 60 30 90 0 0\npsd 8 AHEAD_DOWN 0 60 30 30 0 20\n\
                     lidar 0 0 100 -5 -3 -10 180 0 180";
    assert_eq!(turns(clockwise), (expected, Some([3.0, -5.0, 10.0])));
    assert_eq!(psds("psd 7 PSD_FRONT 0 60 30 0 0 0\npsd 8 DOWN 0 60 30 90 0 0")[1].1, 60.0);
    assert_eq!(turns("psd DOWN 7 60 0 30 90 0 0").0, [[0.0, 90.0, 0.0]]);
    assert_eq!(turns("lidar 0 0 100 0 0 4 180 0 180").1, Some([4.0, 0.0, 0.0]));
    let parsed = parse(&format!("{DRIVE}psd 7 DOWN 60 0 30 0 20 5"), "x.robi").unwrap();
    assert!(parsed.warnings[0].to_string().contains("its line of sight"), "{:?}", parsed.warnings);
}

#[test]
fn an_inertial_unit_has_channels() {
    let spec = |line: &str| robot(&format!("{DRIVE}{line}")).inertial;
    assert_eq!(spec("inertial 1 2 3"), InertialSpec { attitude: Some([1, 2, 3]), ..InertialSpec::default() });
    assert_eq!(spec("inertial 9 10 11 12 13 14 15 16 17"), InertialSpec::ALL);
    assert_eq!(spec("inertial 0 0 0 4 5 6").turn_rates, Some([4, 5, 6]));
    for (line, expected) in [
        ("inertial 1 2", "3, 6 or 9 channels"),
        ("inertial 1 2 0", "three channels from 1 to 255, or 0 0 0"),
        ("inertial 1 2 1", "each channel once"),
        ("inertial 1 2 256", "0 to 255"),
    ] {
        let error = parse(&format!("{DRIVE}{line}"), "x.robi").unwrap_err();
        assert!(error.to_string().contains(expected), "{line}: {error}");
    }
}

#[test]
fn all_forms_of_the_lidar() {
    let lidar = |line: &str| robot(&format!("{DRIVE}{line}")).lidar.unwrap();
    let book = lidar("lidar 0 0 100 0 0 0 180 10 180");
    assert_eq!(book.mount, Mount { z: 0.1, ..Mount::default() });
    assert_eq!(
        (book.points, book.field_of_view, book.tilt),
        (180, units::from_deg(180.0), units::from_deg(10.0))
    );
    let code = lidar("lidar 180 90 10");
    assert_eq!(
        (code.points, code.field_of_view, code.tilt),
        (90, units::from_deg(180.0), units::from_deg(10.0))
    );
    let documented = lidar("lidar 90 10");
    assert_eq!((documented.points, documented.field_of_view), (90, std::f64::consts::TAU));
}

#[test]
fn a_car_has_two_axles() {
    let spec = robot(
        "drive ACKERMANN_DRIVE\naxel drive 30 -100\naxel turn 31 150\nwheel drive 60 1800 500 80\nwheel turn 50 1 1 70\n\
         steering 25\nmotor 0.3 1500\n",
    );
    let DriveSpec::Ackermann { wheel_diameter, wheelbase, max_steering, track, .. } = spec.drive else {
        panic!("{:?}", spec.drive)
    };
    assert_eq!((wheel_diameter, wheelbase, track), (0.06, 0.25, 0.16));
    assert_eq!(max_steering, units::from_deg(25.0));
    assert_eq!(spec.motor, MotorSpec { time_constant: 0.3, max_acceleration: 1.5 });
    assert_eq!(spec.body.turn_axle_height, 0.031);
}

#[test]
fn other_drives_and_old_keywords_are_read_with_warnings() {
    let parsed = parse("drive SAIL_DRIVE\nwheel 54 3600 1100 45\ndiameter 54\nspeed 3", "Snow.robi").unwrap();
    let messages: Vec<String> = parsed.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        messages,
        [
            "Snow.robi:1:7: unknown drive `SAIL_DRIVE`; read as DIFFERENTIAL_DRIVE with a `wheel` line, as \
             AUV_DRIVE without one",
            "Snow.robi:3:1: unknown keyword `diameter`; the line is skipped",
            "Snow.robi:4:1: unknown keyword `speed`; the line is skipped",
        ]
    );
    assert_eq!(parsed.value.name, "Snow");
    assert_eq!(parsed.value.footprint, Footprint::Disc { radius: 0.072 });
}

#[test]
fn a_stranger_of_an_unknown_drive_without_wheels_floats() {
    let text = "drive SUBMARINE_DRIVE\nmass 35 0 0 0\ncollider box 1340 460 645 0 230 0\n";
    let parsed = parse(text, "mako.robi").unwrap();
    let DriveSpec::Craft(craft) = &parsed.value.drive else { panic!("{:?}", parsed.value.drive) };
    assert!(Craft::new(craft, 0.01).unwrap().reserve(1000.0) > 0.0 && craft.thrusters.len() == 4);
}

/// Not only once it is put into a world.
#[test]
fn a_craft_that_cannot_be_is_refused_at_once() {
    for lines in ["mass 0.000001 0 0 0\ncollider box 134 46 64 0 23 0", "mass 30 0 0 0\ninertia 0 1 1 0 0 0"]
    {
        let error = parse(&format!("drive AUV_DRIVE\n{lines}\n"), "mako.robi").unwrap_err().to_string();
        assert!(error.contains("found a least principal inertia of "), "{error}");
    }
}

#[test]
fn built_in_robots_survive() {
    let named = RobotSpec::PREDEFINED.map(|name| RobotSpec::predefined(name).unwrap());
    for spec in named.into_iter().chain([RobotSpec::race_car()]) {
        assert_eq!(robot(&print(&spec)), spec);
    }
}

#[test]
fn sensors_beside_the_axle_are_not_mistaken_for_others() {
    let text = "drive OMNI_DRIVE\nwheel 54 3600 1100 45\npsd PSD_FRONT 1 0 20 30 0\ncamera 1e-9 20 30 0 0 9 9\naxel drive 0 40\n";
    for text in [text, &text.replace("drive 0 40", "drive 0 0")] {
        let spec = robot(text);
        assert_eq!((spec.psds[0].mount.y, spec.camera.unwrap().mount.y), (0.02, 0.02));
        assert_eq!(robot(&print(&spec)), spec);
    }
}

fn metres() -> impl Strategy<Value = f64> {
    prop_oneof![0.001..2.0f64, (1..2000i32).prop_map(|mm| f64::from(mm) / 1000.0)]
}

fn degrees(limit: i32) -> impl Strategy<Value = f64> {
    (1 - limit..=limit).prop_map(|deg| units::from_deg(f64::from(deg)))
}

fn collider() -> impl Strategy<Value = Collider> {
    let place = || proptest::array::uniform3(-2.0..2.0f64);
    prop_oneof![
        (proptest::array::uniform3(metres()), place())
            .prop_map(|(size, centre)| Collider::Box { size, centre }),
        (metres(), place()).prop_map(|(radius, centre)| Collider::Sphere { radius, centre }),
        (metres(), metres(), place()).prop_map(|(radius, height, centre)| {
            Collider::Capsule { radius, height, axis: Axis::Up, centre }
        }),
    ]
}

#[test]
fn belts_have_names_and_sizes() {
    for name in ["TRACKED_DRIVE", "track_drive", "CHAIN_DRIVE"] {
        let spec = robot(&format!("drive {name}\nwheel 60 900 1200 90\ntracks 250 60\nfriction 0.6"));
        let DriveSpec::Tracked { track, length, width, .. } = spec.drive else { panic!("{:?}", spec.drive) };
        assert_eq!((track, length, width, spec.friction), (0.18, 0.25, 0.06, 0.6));
    }
    let parsed = parse("drive TRACKED_DRIVE\nwheel 60 900 1200 90", "Snow.robi").unwrap();
    assert!(parsed.warnings[0].to_string().contains("no `tracks` line"), "{:?}", parsed.warnings);
    let wide = parse("drive TRACKED_DRIVE\nwheel 60 900 1200 90\ntracks 250 181", "Snow.robi").unwrap_err();
    assert!(wide.to_string().contains("belts 181 mm wide"), "{wide}");
}

prop_compose! {
    fn drive()(
        kind in 0..4,
        (length, slim) in (metres(), 0.01..1.0f64),
        (wheel_diameter, track, wheelbase) in (metres(), metres(), metres()),
        max_wheel_speed in 1..9999i32,
        ticks_per_turn in 1.0..9999.0f64,
        steering in 1..90i32,
    ) -> DriveSpec {
        let max_wheel_speed = units::from_deg(f64::from(max_wheel_speed));
        let max_steering = units::from_deg(f64::from(steering));
        match kind {
            0 => DriveSpec::Differential { wheel_diameter, track, max_wheel_speed, ticks_per_turn },
            3 => DriveSpec::Tracked { wheel_diameter, track, length, width: slim * track, max_wheel_speed, ticks_per_turn },
            1 => DriveSpec::Omni { wheel_diameter, track, wheelbase, max_wheel_speed, ticks_per_turn },
            _ => DriveSpec::Ackermann { wheel_diameter, track, wheelbase, max_steering, max_wheel_speed, ticks_per_turn, dynamics: None },
        }
    }
}

prop_compose! {
    fn psd()(
        id in any::<u8>(), x in prop_oneof![Just(0.0), metres()], y in -1.0..1.0f64, z in -1.0..1.0f64,
        (pitch, yaw) in (prop_oneof![Just(0.0), degrees(180)], prop_oneof![Just(0.0), degrees(180)]), range in metres(),
    ) -> PsdSpec {
        let name = if yaw == 0.0 || yaw == std::f64::consts::PI { "PSD_FRONT" } else if yaw > 0.0 { "PSD_LEFT" } else { "PSD_FR" };
        let y = match name { "PSD_LEFT" => y.abs(), "PSD_FR" => -y.abs(), _ => y };
        PsdSpec { id, name: name.into(), mount: Mount { x, y, z, roll: 0.0, pitch, yaw }, max_range: range }
    }
}

prop_compose! {
    fn camera()(
        (x, y, z) in (metres(), -1.0..1.0f64, -1.0..1.0f64),
        (yaw, tilt) in (degrees(180), degrees(180)),
        (max_pan, max_tilt, view) in (0..500i32, 0..500i32, 1..180i32),
        fisheye in any::<bool>(),
    ) -> CameraSpec {
        let angle = |deg| units::from_deg(f64::from(deg));
        CameraSpec {
            mount: Mount { x, y, z, yaw, ..Mount::default() },
            tilt,
            max_pan: angle(max_pan),
            max_tilt: angle(max_tilt),
            field_of_view: angle(view),
            fisheye,
        }
    }
}

prop_compose! {
    fn lidar()(x in metres(), y in -1.0..1.0f64, (roll, pitch, yaw) in (degrees(180), degrees(180), degrees(180)), fov in 1..=360i32, tilt in degrees(90),
               points in 1..9999usize, max_range in metres()) -> LidarSpec
    {
        let field_of_view = units::from_deg(f64::from(fov));
        LidarSpec { mount: Mount { x, y, z: 0.1, roll, pitch, yaw }, field_of_view, tilt, points, max_range }
    }
}

prop_compose! {
    fn body()(
        colliders in proptest::collection::vec(collider(), 0..3),
        mass_centre in proptest::array::uniform3(-1.0..1.0f64),
        turned in any::<bool>(),
        offset in proptest::array::uniform3(-1.0..1.0f64),
    ) -> Body {
        let (model_offset, model_rotation) = if turned { (offset, [0.0, units::from_deg(90.0), 0.0]) } else { ([0.0; 3], [0.0; 3]) };
        Body { colliders, mass_centre, model_offset, model_rotation, ..Body::default() }
    }
}

prop_compose! {
    fn spec()(
        name in "[A-Za-z0-9 #-]{1,9}",
        drive in drive(),
        body in body(),
        outline in (0.01..1.0f64, 0.01..1.0f64, -1.0..0.0f64, -1.0..0.0f64),
        (disc, height, mass, friction) in (any::<bool>(), metres(), 0.0..99.0f64, 0.0..2.0f64),
        motor in (0.0..1.0f64, metres()),
        psds in proptest::collection::vec(psd(), 0..4),
        lidar in proptest::option::of(lidar()),
        camera in proptest::option::of(camera()),
        (tilts, rates, pulls) in (any::<bool>(), any::<bool>(), any::<bool>()),
    ) -> RobotSpec {
        let rectangle = Aabb::new(Point::new(outline.2, outline.3), Point::new(outline.0, outline.1));
        let footprint = if disc { Footprint::Disc { radius: outline.0 } } else { Footprint::Rectangle(rectangle) };
        let motor = MotorSpec { time_constant: motor.0, max_acceleration: motor.1 };
        let model = Some(r"m\a b.obj".into());
        let (depth_sensor, dvl, compass) = (None, rates.then_some(9.5), tilts && rates);
        let inertial = InertialSpec {
            attitude: tilts.then_some([1, 2, 3]),
            turn_rates: rates.then_some([6, 5, 4]),
            acceleration: pulls.then_some([200, 8, 255]),
        };
        RobotSpec { name, drive, motor, footprint, height, mast: None, mass, friction, psds, lidar, camera, depth_sensor, dvl, inertial, compass, model, mesh: None, body }
    }
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn what_is_printed_reads_back(spec in spec()) {
        prop_assert_eq!(robot(&print(&spec)), spec);
    }

    #[test]
    fn what_was_read_survives_printing(
        axle in -999..999i32, tenths in 0..9,
        colliders in "(collider (box [1-9]{1,3} 7 [1-9]\\.[0-9] 0 -[0-9]{1,2} [0-9]{1,3}|sphere [1-9]{1,2} 0 4 0|capsule 3 [1-9] 0 0 0)\n){0,3}",
        psds in "(psd [1-4] (LEFT|RIGHT|FRONT|B) (0|-?[0-9]{1,3}\\.[0-9]{1,2}) -?[0-9]{1,2} 3 0 (90|0|-180) (0|0|25)\n){0,4}",
        drive in "(DIFFERENTIAL|ACKERMANN|OMNI)_DRIVE\n(axel turn 3 2000\\.[0-9]{1,6}\n)?",
        rest in "(camera (0|[0-9]{1,3}\\.[0-9]{1,4}) [0-9]{1,2} 3 10 400 30 30\n)?(lidar [0-9]\\.[0-9]{1,9} 2 3 0 0 [0-9] 9 9 9\n)?",
    ) {
        let text = format!("drive {drive}axis 1 {axle}.{tenths}\n{colliders}{psds}{rest}");
        let spec = robot(&text);
        prop_assert_eq!(spec.validate(), Ok(()));
        prop_assert_eq!(robot(&print(&spec)), spec);
    }

    #[test]
    fn no_text_panics(text in "((drive|psd|lidar|camera|collider|wheel|axel|box|turn| |\n|;|\"|-|[0-9.]{1,3}| 1| 2 3){1,12}\n){0,6}") {
        if let Ok(parsed) = parse(&format!("drive OMNI_DRIVE\n{text}"), "x.robi") {
            prop_assert_eq!(parsed.value.validate(), Ok(()));
            prop_assert_eq!(robot(&print(&parsed.value)), parsed.value);
        }
    }
}
