//! Worlds with hills: what robots do on them, and what their sensors see.

#[allow(unreachable_pub, reason = "the library's own, which is public there with the feature `testing`")]
#[path = "../src/testing/cases.rs"]
mod cases;

use std::f64::consts::{FRAC_PI_2, PI};

use proptest::prelude::*;
use roverlab::geometry::{Aabb, Point, Pose, Vector, Vector3, angle_difference, math, units};
use roverlab::io::sim::{Mishap, SimOptions, Simulation, TICK};
use roverlab::io::{Clock, DistanceSensors, Drive, ErrorKind, Inertial, Lidar, Manoeuvres, Odometry, Psd};
use roverlab::world::{
    Colour, HeightField, InertialSpec, LidarSpec, Mount, Object, ObjectKind, PsdSpec, RobotPlacement,
    RobotSpec, Scene, Shape, Terrain, Wall, World,
};

/// A world of 4 m by 4 m whose ground is a function.
fn world(samples: usize, height: impl FnMut(Point) -> f64) -> World {
    let area = Aabb::new(Point::origin(), Point::new(4.0, 4.0));
    let surface = HeightField::from_fn(samples, samples, area, height).unwrap();
    World { terrain: Some(Terrain::new("made.png", surface)), ..World::empty(4.0, 4.0) }
}

fn simulation(world: World, spec: RobotSpec, pose: Pose) -> Simulation {
    Simulation::new(&Scene::with_robot(world, spec, pose), SimOptions::ideal()).unwrap()
}

/// A ramp from x = 1 m to 2 m, and a level bank behind.
fn ramp(at: Point) -> f64 {
    0.2 * (at.x - 1.0).clamp(0.0, 1.0)
}

#[test]
fn a_robot_drives_up_a_ramp_with_its_nose_up() {
    let simulation = simulation(world(401, ramp), RobotSpec::labbot(), Pose::new(0.5, 2.0, 0.0));
    let (mut robot, truth) = (simulation.robot(0).unwrap(), simulation.truth());
    assert!(truth.pose_in_space(0).unwrap().position.z.abs() < 1e-3);
    robot.straight(1.0, 0.2).unwrap();
    robot.wait_done().unwrap();
    let on_ramp = truth.pose_in_space(0).unwrap();
    let [_, pitch, _] = on_ramp.roll_pitch_yaw();
    assert!((pitch + math::atan(0.2)).abs() < 0.01, "{pitch}");
    assert!((on_ramp.position.z - ramp(on_ramp.position.xy())).abs() < 2e-3, "{on_ramp:?}");
    robot.straight(1.0, 0.2).unwrap();
    robot.wait_done().unwrap();
    let above = truth.pose_in_space(0).unwrap();
    assert!((above.position.z - 0.2).abs() < 2e-3 && above.tilt() < 0.01, "{above:?}");
    // The way over the ground is longer than the way over the map, and wheels know the former.
    let ahead = above.position.x - 0.5;
    assert!((1.95..1.99).contains(&ahead), "{ahead}");
    assert!((robot.pose().unwrap().x - 2.0).abs() < 5e-3);
    assert_eq!((truth.mishap(0).unwrap(), truth.robot(0).unwrap().contacts), (None, 0));
}

/// Today's complaint: a ramp and walls of 200 mm, and a program that asks for 5 m.
#[test]
fn nobody_drives_out_through_a_steep_rim() {
    let rim = |at: Point| {
        let inside = (0.1..3.9).contains(&at.x) && (0.1..3.9).contains(&at.y);
        if inside { ramp(at) * 0.5 } else { 0.4 }
    };
    for spec in [RobotSpec::s4(), RobotSpec::labbot(), RobotSpec::car()] {
        let simulation = simulation(world(401, rim), spec, Pose::new(0.8, 2.0, 0.3));
        let mut robot = simulation.robot(0).unwrap();
        robot.straight(5.0, 0.3).unwrap();
        let _ = robot.wait(25.0);
        let end = simulation.truth().pose_in_space(0).unwrap();
        assert!(end.position.x < 3.95 && end.position.z < 0.3, "{end:?}");
    }
}

#[test]
fn sensors_tilt_with_their_robot_and_see_the_ground() {
    let simulation = simulation(world(401, ramp), RobotSpec::s4(), Pose::new(0.5, 2.0, 0.0));
    let mut robot = simulation.robot(0).unwrap();
    // Level, 30 mm up: the ramp is as high 0.15 m behind its foot, which is at 1 m.
    let ahead = robot.distance(Psd::FRONT).unwrap();
    assert!((ahead - (0.65 - 0.06)).abs() < 2e-3, "{ahead}");
    assert_eq!(robot.distance(Psd::BACK).unwrap(), f64::INFINITY);
    let scan = robot.scan().unwrap();
    let front = scan.ranges[scan.beam_at(0.0).unwrap()];
    assert!((front - 0.7).abs() < 5e-3, "{front}");
    robot.straight(1.0, 0.2).unwrap();
    robot.wait_done().unwrap();
    // On the ramp it looks along the slope, over the bank, and down at the floor behind nothing.
    assert_eq!(robot.distance(Psd::FRONT).unwrap(), f64::INFINITY);
    let back = robot.distance(Psd::BACK).unwrap();
    assert!((0.4..0.9).contains(&back), "{back}");
}

/// An S4 with sensors that look straight down in front and at its left, and one that looks obliquely down.
fn looking_down() -> RobotSpec {
    let mut spec = RobotSpec::s4();
    let down = |id, x, y, pitch: f64| PsdSpec {
        id,
        name: "DOWN".into(),
        mount: Mount { x, y, z: 0.08, pitch: units::from_deg(pitch), ..Mount::default() },
        max_range: PsdSpec::DEFAULT_MAX_RANGE,
    };
    spec.psds.extend([down(5, 0.12, 0.0, 90.0), down(6, 0.0, 0.05, 90.0), down(7, 0.05, 0.0, 30.0)]);
    spec
}

#[test]
fn a_sensor_that_looks_down_sees_the_floor_and_what_lies_on_it() {
    for hills in [false, true] {
        let mut flat = if hills { world(41, |_| 0.0) } else { World::empty(4.0, 4.0) };
        let plate = ObjectKind::new("plate", Shape::Cylinder { radius: 0.05, height: 0.02 }, Colour::RED);
        flat.objects.push(Object::new(plate.into(), Pose::new(1.0, 2.05, 0.0)));
        flat.walls.push(Wall::new(Point::new(1.3, 1.0), Point::new(1.3, 3.0)));
        let simulation = simulation(flat, looking_down(), Pose::new(1.0, 2.0, 0.0));
        let mut robot = simulation.robot(0).unwrap();
        let [front, left, oblique] = [5, 6, 7].map(|id| robot.distance(Psd(id)).unwrap());
        assert!((front - 0.08).abs() < 2e-4, "{front}");
        assert!((left - 0.06).abs() < 2e-4, "{left}");
        assert!((oblique - 0.16).abs() < 1e-3, "{oblique}");
    }
}

#[test]
fn a_sensor_that_looks_down_sees_a_cliff() {
    let cliff = |at: Point| if at.x < 2.0 { 0.4 } else { 0.0 };
    let simulation = simulation(world(401, cliff), looking_down(), Pose::new(1.93, 2.0, 0.0));
    let (front, left) = {
        let mut robot = simulation.robot(0).unwrap();
        (robot.distance(Psd(5)).unwrap(), robot.distance(Psd(6)).unwrap())
    };
    assert!((left - 0.08).abs() < 1e-3 && (front - 0.48).abs() < 0.01, "{left} {front}");
}

#[test]
fn a_lidar_with_its_nose_down_sees_the_floor_ahead_and_nothing_behind() {
    for hills in [false, true] {
        let flat = if hills { world(41, |_| 0.0) } else { World::empty(4.0, 4.0) };
        let mount = Mount { z: 0.1, pitch: 0.2, ..Mount::default() };
        let spec = RobotSpec { lidar: Some(LidarSpec { mount, ..LidarSpec::default() }), ..RobotSpec::s4() };
        let simulation = simulation(flat, spec, Pose::new(2.0, 2.0, 0.7));
        let scan = simulation.robot(0).unwrap().scan().unwrap();
        for (beam, &range) in scan.ranges.iter().enumerate() {
            let down = math::sin(0.2) * math::cos(scan.angle(beam));
            let far = if down > 0.0 { 0.1 / down } else { f64::INFINITY };
            let near = far < 1.5 && (range - far).abs() < 5e-3;
            assert!(near || (far >= 1.5 && range > 1.4), "beam {beam}: {range} instead of {far}");
        }
    }
}

/// A plane of 10 degrees that rises along x.
fn incline(at: Point) -> f64 {
    math::tan(units::from_deg(10.0)) * at.x
}

#[test]
fn an_inertial_unit_tells_how_its_robot_stands() {
    let rise = units::from_deg(10.0);
    for (heading, roll, pitch) in [(0.0, 0.0, -rise), (FRAC_PI_2, -rise, 0.0), (PI, 0.0, rise)] {
        let simulation = simulation(world(41, incline), RobotSpec::blizzard(), Pose::new(2.0, 2.0, heading));
        let mut robot = simulation.robot(0).unwrap();
        robot.wait(1.0).unwrap();
        let found = robot.attitude().unwrap();
        let near = |a: f64, b: f64| angle_difference(a, b).abs() < 3e-3;
        assert!(near(found.roll, roll) && near(found.pitch, pitch) && near(found.yaw, heading), "{found:?}");
        assert!(robot.turn_rates().unwrap().norm() < 1e-3);
        let up = found.frame().rotate(robot.acceleration().unwrap());
        assert!((up - Vector3::new(0.0, 0.0, 9.81)).norm() < 0.01, "{up:?}");
    }
}

#[test]
fn an_inertial_unit_feels_turns_and_a_fall_and_a_hand() {
    let with_unit = RobotSpec { inertial: InertialSpec::ALL, ..RobotSpec::s4() };
    let level = simulation(World::empty(4.0, 4.0), with_unit, Pose::new(2.0, 2.0, 0.0));
    let mut robot = level.robot(0).unwrap();
    robot.set_speed(roverlab::geometry::Twist::new(0.2, 0.5)).unwrap();
    robot.wait(3.0).unwrap();
    assert!((robot.turn_rates().unwrap() - Vector3::new(0.0, 0.0, 0.5)).norm() < 1e-6);
    // Towards the middle of its circle, to the left.
    let pull = robot.acceleration().unwrap();
    assert!((pull - Vector3::new(0.0, 0.1, 9.81)).norm() < 1e-3, "{pull:?}");
    level.truth().set_pose(0, Pose::new(1.0, 1.0, 2.0)).unwrap();
    assert_eq!(robot.acceleration().unwrap(), Vector3::new(0.0, 0.0, 9.81));
    let hills = simulation(world(41, |_| 0.0), RobotSpec::blizzard(), Pose::new(2.0, 2.0, 0.0));
    let (mut robot, truth) = (hills.robot(0).unwrap(), hills.truth());
    truth.drop_robot(0, 0, Pose::new(2.0, 2.0, 0.0), 0.5).unwrap();
    robot.wait(0.2).unwrap();
    assert!(robot.acceleration().unwrap().norm() < 1e-6, "weightless: {:?}", robot.acceleration());
    robot.wait(2.0).unwrap();
    assert!((robot.acceleration().unwrap().z - 9.81).abs() < 0.01);
}

#[test]
fn an_inertial_unit_errs_by_seed_and_wanders() {
    let readings = |seed, noise| {
        let scene = Scene::with_robot(world(41, |_| 0.0), RobotSpec::blizzard(), Pose::new(2.0, 2.0, 0.0));
        let simulation = Simulation::new(&scene, SimOptions::with_noise(noise, seed)).unwrap();
        let mut robot = simulation.robot(0).unwrap();
        let mut read = || {
            robot.wait(1.0).unwrap();
            (robot.attitude().unwrap(), robot.turn_rates().unwrap(), robot.acceleration().unwrap())
        };
        (0..600).map(|_| read()).collect::<Vec<_>>()
    };
    assert_eq!(readings(1, 1.0), readings(1, 1.0));
    assert_ne!(readings(1, 1.0)[0], readings(2, 1.0)[0]);
    assert!(
        readings(1, 0.0).iter().all(|(attitude, rates, _)| attitude.yaw.abs() < 1e-9 && rates.norm() < 1e-9)
    );
    let runs: Vec<_> = (0..40).map(|seed| readings(seed, 1.0)).collect();
    let spread = |value: &dyn Fn(&(roverlab::io::Attitude, Vector3, Vector3)) -> f64, second: usize| {
        (runs.iter().map(|run| value(&run[second]) * value(&run[second])).sum::<f64>() / 40.0).sqrt()
    };
    // A bias and a part drawn each time, 0.5 degrees each; the yaw's grows by as much in a minute.
    let degrees = |radians: f64| units::to_deg(radians);
    let (roll, yaw) = (
        |r: &(roverlab::io::Attitude, _, _)| degrees(r.0.roll),
        |r: &(roverlab::io::Attitude, _, _)| degrees(r.0.yaw),
    );
    let (early, late) = (spread(&roll, 0), spread(&roll, 599));
    assert!((0.45..1.0).contains(&early) && (0.45..1.0).contains(&late), "{early} {late}");
    let late = spread(&yaw, 599);
    assert!((1.1..2.5).contains(&late), "{late}");
}

#[test]
fn a_robot_without_an_inertial_unit_says_so() {
    let simulation = simulation(world(41, |_| 0.0), RobotSpec::s4(), Pose::new(2.0, 2.0, 0.0));
    let mut robot = simulation.robot(0).unwrap();
    for error in
        [robot.attitude().unwrap_err(), robot.turn_rates().unwrap_err(), robot.acceleration().unwrap_err()]
    {
        assert_eq!(error.kind(), ErrorKind::Unsupported);
    }
}

#[test]
fn walls_and_objects_stand_on_the_ground() {
    let mut world = world(401, |at| 0.1 * at.x);
    world.walls.push(Wall::new(Point::new(3.0, 0.5), Point::new(3.0, 3.5)));
    let can = ObjectKind::new("can", Shape::Cylinder { radius: 0.05, height: 0.12 }, Colour::RED);
    world.objects.push(Object::new(can.into(), Pose::new(2.0, 1.0, 0.0)));
    let simulation = simulation(world, RobotSpec::s4(), Pose::new(1.0, 2.0, 0.0));
    let (mut robot, truth) = (simulation.robot(0).unwrap(), simulation.truth());
    assert!((truth.object_elevation(0).unwrap() - 0.2).abs() < 1e-6);
    // Across the slope and along it.
    let slant = math::hypot(1.0, 0.1);
    let ahead = robot.distance(Psd::FRONT).unwrap();
    assert!((ahead - (1.995 * slant - 0.06)).abs() < 5e-3, "{ahead}");
    robot.straight(3.0, 0.3).unwrap();
    let _ = robot.wait(12.0);
    let end = truth.robot(0).unwrap();
    assert!(end.contacts > 0 && (end.pose.x - 2.935).abs() < 0.01, "{end:?}");
    truth.set_pose(0, Pose::new(1.0, 1.0, 0.0)).unwrap();
    let ahead = robot.distance(Psd::FRONT).unwrap();
    assert!(ahead < 0.95 * slant && ahead > 0.8, "{ahead}");
}

/// A box holds on to a slope that a ball rolls down; a steeper one takes both, up to the wall at its foot.
#[test]
fn things_slide_and_roll_down_to_what_is_in_their_way() {
    for (rise, slides) in [(0.4, false), (0.7, true)] {
        let mut world = world(81, move |at| rise * at.x);
        world.walls.push(Wall::new(Point::new(1.0, 0.0), Point::new(1.0, 4.0)));
        let shapes = [Shape::Box { length: 0.1, width: 0.1, height: 0.1 }, Shape::Sphere { radius: 0.03 }];
        for (shape, y) in shapes.into_iter().zip([1.0, 3.0]) {
            let kind = ObjectKind { mass: 0.2, fixed: false, ..ObjectKind::new("thing", shape, Colour::RED) };
            world.objects.push(Object::new(kind.into(), Pose::new(3.0, y, 0.0)));
        }
        let simulation = simulation(world, RobotSpec::blizzard(), Pose::new(0.5, 2.0, 0.0));
        let truth = simulation.truth();
        simulation.robot(0).unwrap().wait(20.0).unwrap();
        let [cube, ball] = [0, 1].map(|thing| truth.object(thing).unwrap());
        assert_eq!(cube.x < 2.9, slides, "{cube:?}");
        let foot = |thing: Pose, half: f64| (thing.x - (1.005 + half)).abs() < 0.03;
        assert!(foot(ball, 0.03) && (!slides || foot(cube, 0.05)), "{ball:?} {cube:?}");
        assert!((truth.object_elevation(1).unwrap() - rise * ball.x).abs() < 1e-6);
    }
}

/// It is moved out of the wall, but gets no speed from that.
#[test]
fn a_robot_placed_into_a_wall_is_not_thrown() {
    let wall = Wall::new(Point::new(2.08, 1.0), Point::new(2.08, 3.0));
    for spec in [RobotSpec::s4(), RobotSpec::blizzard()] {
        let name = spec.name.clone();
        let world = World { walls: vec![wall], ..world(65, ramp) };
        let simulation = simulation(world, spec, Pose::new(2.0, 2.0, 0.3));
        simulation.robot(0).unwrap().wait(1.0).unwrap();
        let truth = simulation.truth();
        let moved = (truth.pose(0).unwrap().position() - Point::new(2.0, 2.0)).norm();
        assert!(moved < 0.25 && truth.mishap(0).unwrap().is_none(), "{name}: {moved}");
    }
}

#[test]
fn a_robot_that_drives_over_a_cliff_falls() {
    let cliff = |at: Point| if at.x < 2.0 { 0.4 } else { 0.0 };
    let simulation = simulation(world(401, cliff), RobotSpec::s4(), Pose::new(1.0, 2.0, 0.0));
    let (mut robot, truth) = (simulation.robot(0).unwrap(), simulation.truth());
    robot.straight(2.0, 0.3).unwrap();
    let _ = robot.wait(8.0);
    assert_eq!(truth.mishap(0).unwrap(), Some(Mishap::Fell));
    assert!(truth.pose_in_space(0).unwrap().position.z < 0.2);
    // A hand puts it back, and it drives again.
    truth.set_pose(0, Pose::new(1.0, 2.0, 3.0)).unwrap();
    assert_eq!(truth.mishap(0).unwrap(), None);
    robot.straight(0.3, 0.3).unwrap();
    robot.wait_done().unwrap();
    assert!((truth.pose(0).unwrap().distance_to(Point::new(1.0, 2.0)) - 0.3).abs() < 0.01);
}

#[test]
fn off_the_world_is_a_fall_without_end() {
    let simulation = simulation(world(41, |_| 0.0), RobotSpec::s4(), Pose::new(3.5, 2.0, 0.0));
    let (mut robot, truth) = (simulation.robot(0).unwrap(), simulation.truth());
    robot.straight(2.0, 0.3).unwrap();
    let _ = robot.wait(8.0);
    assert_eq!(truth.mishap(0).unwrap(), Some(Mishap::Fell));
    let end = truth.pose_in_space(0).unwrap();
    assert!(end.is_finite() && end.position.z < -0.5, "{end:?}");
}

#[test]
fn water_drowns_and_a_drop_lands() {
    let mut wet = world(101, |at| 0.2 * (at.x - 2.0));
    wet.water_level = Some(0.0);
    let wet = simulation(wet, RobotSpec::labbot(), Pose::new(3.0, 2.0, std::f64::consts::PI));
    let mut robot = wet.robot(0).unwrap();
    robot.straight(2.5, 0.3).unwrap();
    let _ = robot.wait(12.0);
    assert_eq!(wet.truth().mishap(0).unwrap(), Some(Mishap::Drowned));

    let mut placed = RobotPlacement::new(RobotSpec::s4().into(), Pose::new(2.0, 2.0, 0.5));
    placed.elevation = 0.05;
    let scene = Scene { robots: vec![placed], ..Scene::new(world(101, |_| 0.3)) };
    let dry = Simulation::new(&scene, SimOptions::ideal()).unwrap();
    assert!((dry.truth().pose_in_space(0).unwrap().position.z - 0.35).abs() < 1e-6);
    dry.robot(0).unwrap().wait(2.0).unwrap();
    let landed = dry.truth().pose_in_space(0).unwrap();
    assert!((landed.position.z - 0.3).abs() < 1e-3 && landed.tilt() < 0.01, "{landed:?}");
}

#[test]
fn a_level_floor_drowns_and_catches_as_hills_do() {
    let wet = World { water_level: Some(0.9), ..World::walled(6.0, 6.0) };
    let wet = simulation(wet, RobotSpec::labbot(), Pose::new(1.0, 3.0, 0.0));
    let mut robot = wet.robot(0).unwrap();
    robot.straight(1.0, 0.3).unwrap();
    let _ = robot.wait(4.0);
    let truth = wet.truth();
    assert_eq!(truth.mishap(0).unwrap(), Some(Mishap::Drowned));
    assert!(truth.pose(0).unwrap().x < 1.1);

    let mut placed = RobotPlacement::new(RobotSpec::s4().into(), Pose::new(2.0, 2.0, 0.0));
    placed.elevation = 0.05;
    let scene = Scene { robots: vec![placed], ..Scene::new(World::walled(4.0, 4.0)) };
    let dry = Simulation::new(&scene, SimOptions::ideal()).unwrap();
    dry.robot(0).unwrap().wait(2.0).unwrap();
    let landed = dry.truth().pose_in_space(0).unwrap();
    assert!(landed.position.z.abs() < 1e-3 && landed.tilt() < 0.01, "{landed:?}");
}

proptest! {
    #![proptest_config(cases::cases(24))]
    /// Hills without a hill are a floor.
    #[test]
    fn level_hills_are_a_floor(
        robot in 0..4_usize, heading in -3.0..3.0f64, length in -0.6..0.6f64, angle in -2.0..2.0f64,
    ) {
        let spec = [RobotSpec::s4(), RobotSpec::labbot(), RobotSpec::omni(), RobotSpec::car()][robot].clone();
        let angle = if robot == 3 { 0.2 * angle.signum() * length.abs() } else { angle };
        let start = Pose::new(2.0, 2.0, heading);
        let ends = [world(41, |_| 0.25), World::empty(4.0, 4.0)].map(|world| {
            let simulation = simulation(world, spec.clone(), start);
            let mut robot = simulation.robot(0).unwrap();
            robot.curve(length, angle, 0.2).unwrap();
            robot.wait_done().unwrap();
            (simulation.truth().pose(0).unwrap(), robot.pose().unwrap())
        });
        let [(hills, by_wheels), (floor, by_wheels_there)] = ends;
        let apart = (hills.position() - floor.position()).norm();
        let turned = roverlab::geometry::angle_difference(hills.heading, floor.heading);
        prop_assert!(apart < 2e-3 && turned.abs() < 5e-3, "{:?} {:?}", hills, floor);
        prop_assert_eq!(by_wheels, by_wheels_there);
    }

    /// A robot that stands still on a slope it holds on does so for ever; on a steeper one it slides down.
    #[test]
    fn robots_hold_on_or_slide_down(degrees in prop_oneof![2.0..14.0f64, 42.0..50.0f64], heading in -3.0..3.0f64) {
        let rise = math::tan(units::from_deg(degrees));
        let simulation = simulation(world(41, |at| rise * at.x), RobotSpec::s4(), Pose::new(2.0, 2.0, heading));
        let mut robot = simulation.robot(0).unwrap();
        robot.wait(100.0 * TICK).unwrap();
        let moved = simulation.truth().pose(0).unwrap().position() - Point::new(2.0, 2.0);
        if degrees < 25.0 {
            prop_assert!(moved.norm() < 1e-3, "{}", moved);
        } else {
            prop_assert!(moved.dot(&Vector::x()) < -0.02, "{}", moved);
        }
    }
}

/// The book's crater in small: a tracked robot drives up to its rim.
#[test]
fn a_tracked_robot_climbs_where_it_skids() {
    let crater = |at: Point| {
        let beyond_rim = (at - Point::new(2.0, 2.0)).norm_squared() - 1.0;
        0.15 * math::exp(-beyond_rim * beyond_rim)
    };
    let simulation = simulation(world(257, crater), RobotSpec::blizzard(), Pose::new(0.4, 0.4, 0.785));
    let (mut robot, truth) = (simulation.robot(0).unwrap(), simulation.truth());
    let start = truth.pose_in_space(0).unwrap().position.z;
    robot.straight(1.2, 0.2).unwrap();
    robot.wait_done().unwrap();
    let end = truth.pose_in_space(0).unwrap();
    assert!(end.position.z > start + 0.1, "{end:?}");
    assert_eq!(truth.mishap(0).unwrap(), None);
    robot.turn(1.5, 0.5).unwrap();
    robot.wait_done().unwrap();
    assert!(truth.pose(0).unwrap().heading > 1.5, "{:?}", truth.pose(0));
}
