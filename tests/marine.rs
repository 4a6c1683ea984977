//! Craft in simulated water, by the public API.

use std::sync::Arc;

use roverlab::geometry::{Aabb, Point, Point3, Pose, Twist, Vector, Vector3, angle_difference};
use roverlab::io::sim::{Fleet, Mishap, SimOptions, SimRobot, Simulation};
use roverlab::io::{
    Camera, Clock, DistanceSensors, Drive, Encoders, Inertial, Manoeuvres, Motors, Odometry, Psd, Servos,
};
use roverlab::kinematics::marine::{CraftSpec, HullPart};
use roverlab::world::formats::robi;
use roverlab::world::{
    DriveSpec, HeightField, Object, ObjectKind, RobotSpec, Scene, Shape, Terrain, Wall, Water, Waves, World,
};

const DOWN: Psd = Psd(6);
const UP: Psd = Psd(5);

/// A pool of 6 m by 10 m and 2 m depth with a rim, the water 100 mm below it: the book's, smaller.
fn pool() -> World {
    let area = Aabb::new(Point::origin(), Point::new(6.0, 10.0));
    let rim = |at: Point| {
        let inside = at.x.min(6.0 - at.x).min(at.y).min(10.0 - at.y);
        if inside > 0.25 { 0.0 } else { 2.0 }
    };
    let surface = HeightField::from_fn(121, 201, area, rim).unwrap();
    World {
        terrain: Some(Terrain::new("pool.png", surface)),
        water_level: Some(1.9),
        ..World::empty(6.0, 10.0)
    }
}

fn mako_in(world: World) -> (Simulation, SimRobot) {
    craft_in(world, RobotSpec::mako(), SimOptions::ideal())
}

fn craft_in(world: World, spec: RobotSpec, options: SimOptions) -> (Simulation, SimRobot) {
    let scene = Scene::with_robot(world, spec, Pose::new(3.0, 5.0, 0.0));
    let simulation = Simulation::new(&scene, options).unwrap();
    let robot = simulation.robot(0).unwrap();
    (simulation, robot)
}

fn both(robot: &mut SimRobot, motors: [u8; 2], fraction: f64) {
    for motor in motors {
        robot.set_motor(motor, fraction).unwrap();
    }
}

#[test]
fn mako_floats_dives_and_comes_up_again() {
    let (simulation, mut mako) = mako_in(pool());
    let z = || simulation.truth().pose_in_space(0).unwrap().position.z;
    let afloat = z();
    assert!((afloat - 1.45).abs() < 0.05, "{afloat}");
    assert!((mako.distance(DOWN).unwrap() - afloat).abs() < 1e-9 && mako.distance(UP).unwrap().is_infinite());
    mako.wait(3.0).unwrap();
    assert!((z() - afloat).abs() < 0.01, "{} after {afloat}", z());
    both(&mut mako, [2, 4], -1.0);
    mako.wait(3.0).unwrap();
    let dived = z();
    assert!(dived < afloat - 0.6 && dived > 0.3, "{dived}");
    // Without thrust it comes up slowly, with thrust faster.
    both(&mut mako, [2, 4], 0.0);
    mako.wait(2.0).unwrap();
    let turned = z();
    mako.wait(1.0).unwrap();
    let by_itself = z() - turned;
    both(&mut mako, [2, 4], 1.0);
    mako.wait(0.7).unwrap();
    let before = z();
    mako.wait(1.0).unwrap();
    let with_thrust = z() - before;
    assert!(by_itself > 0.05 && with_thrust > 1.5 * by_itself, "{by_itself} {with_thrust}");
    mako.wait(10.0).unwrap();
    assert!((z() - afloat).abs() < 0.1, "{} {afloat}", z());
    assert!((mako.distance(DOWN).unwrap() - z()).abs() < 0.01);
    let truth = simulation.truth();
    assert_eq!((truth.robot(0).unwrap().contacts, truth.mishap(0).unwrap()), (0, None));
}

#[test]
fn thrusters_drive_ahead_and_turn_as_wheels_do() {
    let (simulation, mut mako) = mako_in(pool());
    let pose = || simulation.truth().pose(0).unwrap();
    both(&mut mako, [1, 3], 0.5);
    mako.wait(3.0).unwrap();
    let ahead = pose();
    assert!(ahead.x > 3.7 && (ahead.y - 5.0).abs() < 0.01 && ahead.heading.abs() < 0.01, "{ahead:?}");
    mako.set_motor(1, -1.0).unwrap();
    mako.set_motor(3, 1.0).unwrap();
    mako.wait(2.0).unwrap();
    assert!(pose().heading > 0.5, "{:?}", pose());
    mako.set_motor(1, 1.0).unwrap();
    mako.set_motor(3, -1.0).unwrap();
    mako.wait(8.0).unwrap();
    assert!(mako.turn_rates().unwrap().z < -0.3);
    assert!(mako.set_motor(5, 0.0).is_err() && mako.encoder(1).is_err());
}

#[test]
fn speeds_and_ways_are_held_in_closed_loop() {
    let (simulation, mut mako) = mako_in(pool());
    mako.set_speed(Twist::new(0.3, 0.0)).unwrap();
    mako.wait(6.0).unwrap();
    assert!((mako.speed().unwrap().linear - 0.3).abs() < 0.003, "{:?}", mako.speed());
    mako.set_speed(Twist::new(0.0, 0.4)).unwrap();
    mako.wait(6.0).unwrap();
    assert!((mako.speed().unwrap().angular - 0.4).abs() < 0.01, "{:?}", mako.speed());
    mako.set_speed(Twist::default()).unwrap();
    mako.wait(10.0).unwrap();
    let start = mako.pose().unwrap();
    mako.straight(0.8, 0.2).unwrap();
    mako.wait_done().unwrap();
    mako.turn(1.0, 0.3).unwrap();
    mako.wait_done().unwrap();
    mako.wait(5.0).unwrap();
    let end = mako.pose().unwrap();
    assert!((start.distance_to(end.position()) - 0.8).abs() < 0.1, "{start:?} {end:?}");
    assert!((angle_difference(end.heading, start.heading) - 1.0).abs() < 0.1, "{start:?} {end:?}");
    assert_eq!(simulation.truth().robot(0).unwrap().contacts, 0);
}

/// A turn is over at its angle, however far the craft coasts meanwhile, and a way at its length after a turn.
#[test]
fn manoeuvres_of_a_moving_craft_end() {
    let (_, mut mako) = mako_in(pool());
    mako.set_speed(Twist::new(0.2, 0.0)).unwrap();
    mako.wait(4.0).unwrap();
    mako.turn(1.0, 0.5).unwrap();
    mako.wait(20.0).unwrap();
    assert!(mako.is_done().unwrap());
    mako.set_speed(Twist::new(0.0, 0.5)).unwrap();
    mako.wait(4.0).unwrap();
    mako.straight(0.5, 0.2).unwrap();
    mako.wait(20.0).unwrap();
    assert!(mako.is_done().unwrap());
}

#[test]
fn walls_and_the_floor_stop_it_and_count() {
    let (simulation, mut mako) = mako_in(pool());
    both(&mut mako, [2, 4], -1.0);
    mako.wait(20.0).unwrap();
    let truth = simulation.truth();
    let on_the_floor = truth.pose_in_space(0).unwrap();
    assert!(on_the_floor.position.z.abs() < 0.01 && on_the_floor.tilt() < 0.05, "{on_the_floor:?}");
    let touched = truth.robot(0).unwrap().contacts;
    assert!((1..=3).contains(&touched), "{touched}");
    // Against the rim of the pool, which is hills, and against a wall.
    both(&mut mako, [2, 4], 0.0);
    mako.wait(10.0).unwrap();
    both(&mut mako, [1, 3], 1.0);
    mako.wait(10.0).unwrap();
    let nose = truth.pose(0).unwrap().x + 0.67;
    assert!((nose - 5.77).abs() < 0.08, "{nose}");
    let mut walled = pool();
    walled.walls.push(Wall { height: 3.0, ..Wall::new(Point::new(4.5, 0.0), Point::new(4.5, 10.0)) });
    let (simulation, mut mako) = mako_in(walled);
    both(&mut mako, [1, 3], 1.0);
    mako.wait(10.0).unwrap();
    let nose = simulation.truth().pose(0).unwrap().x + 0.67;
    assert!(nose < 4.51 && nose > 4.4, "{nose}");
    assert!(simulation.truth().robot(0).unwrap().contacts > 0);
}

#[test]
fn a_current_carries_it_and_odometry_does_not_know() {
    let water = Water { current: vec![(0.0, Vector::new(0.1, -0.05))], ..Water::default() };
    let (simulation, mut mako) = mako_in(World { water, ..pool() });
    mako.wait(10.0).unwrap();
    let pose = simulation.truth().pose(0).unwrap();
    assert!(pose.x > 3.3 && pose.y < 4.9, "{pose:?}");
    let odometry = mako.pose().unwrap();
    // It is carried along, and so moves backward through the water at first.
    assert!(odometry.x < 0.0, "{odometry:?}");
}

#[test]
fn waves_rock_what_floats_and_hardly_what_is_deep() {
    let waves = Waves { height: 0.1, period: 2.0, direction: 0.0, irregular: true };
    let deep = Aabb::new(Point::new(-20.0, -20.0), Point::new(20.0, 20.0));
    let floor = HeightField::from_fn(2, 2, deep, |_| -20.0).unwrap();
    let sea = World {
        terrain: Some(Terrain::new("sea", floor)),
        water_level: Some(0.0),
        water: Water { waves: Some(waves), ..Water::default() },
        ..World::empty(6.0, 10.0)
    };
    let (simulation, mut raft) = craft_in(sea, RobotSpec::solar_raft(), SimOptions::ideal());
    let mut heights = Vec::new();
    for _ in 0..400 {
        raft.wait(0.1).unwrap();
        heights.push(simulation.truth().pose_in_space(0).unwrap().position.z);
    }
    let mean = heights.iter().sum::<f64>() / 400.0;
    let deviation = (heights.iter().map(|z| (z - mean) * (z - mean)).sum::<f64>() / 400.0).sqrt();
    // Of waves of this height the surface has 25 mm.
    assert!((0.015..0.04).contains(&deviation), "{deviation}");
}

#[test]
fn wind_pushes_a_boat_and_not_a_craft_that_has_dived() {
    let water = Water { wind: Vector::new(0.0, 8.0), ..Water::default() };
    let world = || World { water: water.clone(), ..pool() };
    let (simulation, mut raft) = craft_in(world(), RobotSpec::solar_raft(), SimOptions::ideal());
    raft.wait(10.0).unwrap();
    assert!(simulation.truth().pose(0).unwrap().y > 5.2);
    let mut mako = Scene::with_robot(world(), RobotSpec::mako(), Pose::new(3.0, 5.0, 0.0));
    mako.robots[0].elevation = 0.2;
    let simulation = Simulation::new(&mako, SimOptions::ideal()).unwrap();
    simulation.robot(0).unwrap().wait(1.0).unwrap();
    assert_eq!(simulation.truth().pose(0).unwrap().y, 5.0);
}

#[test]
fn what_is_light_floats_and_what_is_heavy_sinks() {
    let shape = Shape::Cylinder { radius: 0.1, height: 0.4 };
    let kind = |mass, buoyancy| ObjectKind {
        mass,
        buoyancy: Some(buoyancy),
        ..ObjectKind::new("buoy", shape, roverlab::world::Colour::WHITE)
    };
    let mut world = pool();
    for (mass, y) in [(3.0, 2.0), (20.0, 8.0)] {
        world.objects.push(Object::new(Arc::new(kind(mass, 0.012)), Pose::new(2.0, y, 0.0)));
    }
    let (simulation, _mako) = mako_in(world);
    // A quarter of its height is under water.
    assert!((simulation.truth().object_elevation(0).unwrap() - 1.8).abs() < 1e-9);
    assert_eq!(simulation.truth().object_elevation(1).unwrap(), 0.0);
}

#[test]
fn craft_that_cannot_be_are_refused_or_named() {
    let with = |change: &dyn Fn(&mut CraftSpec)| {
        let mut spec = RobotSpec::mako();
        let DriveSpec::Craft(craft) = &mut spec.drive else { unreachable!() };
        change(Arc::make_mut(craft));
        spec
    };
    let refused = |spec: RobotSpec| {
        let scene = Scene::with_robot(pool(), spec, Pose::new(3.0, 5.0, 0.0));
        Simulation::new(&scene, SimOptions::ideal()).unwrap_err().to_string()
    };
    assert!(refused(with(&|craft| craft.hull.clear())).contains("hull parts"));
    assert!(refused(with(&|craft| craft.mass = f64::NAN)).contains("mass"));
    let long_and_thick = [[9.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert!(refused(with(&|craft| craft.inertia = long_and_thick)).contains("largest principal moment"));
    let tangled = [[2.0, 1.9, 0.0], [1.9, 2.0, 0.0], [0.0, 0.0, 2.0]];
    assert!(refused(with(&|craft| craft.inertia = tangled)).contains("largest principal moment"));
    let negative = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
    assert!(refused(with(&|craft| craft.inertia = negative)).contains("least principal moment"));
    let negative = |size| with(&|craft| craft.hull.push(HullPart::Box { size, centre: Point3::origin() }));
    assert!(refused(negative(Vector3::new(-0.2, 0.3, 0.1))).contains("hull part"));
    assert!(refused(negative(Vector3::new(0.2, f64::NAN, 0.1))).contains("hull part"));
    // Without thrusters it drifts; heavier than water it lies on the floor.
    let (_, mut mako) = craft_in(pool(), with(&|craft| craft.thrusters.clear()), SimOptions::ideal());
    assert!(mako.set_motor(1, 1.0).is_err());
    mako.set_speed(Twist::new(1.0, 1.0)).unwrap();
    mako.wait(1.0).unwrap();
    let (simulation, mut mako) = craft_in(pool(), with(&|craft| craft.mass = 60.0), SimOptions::ideal());
    mako.wait(2.0).unwrap();
    assert!(simulation.truth().pose_in_space(0).unwrap().position.z.abs() < 0.02);
    // A pool without water, and water above the world.
    let (simulation, mut mako) = mako_in(World { water_level: None, ..pool() });
    mako.wait(2.0).unwrap();
    assert!(simulation.truth().pose_in_space(0).unwrap().position.z.abs() < 0.05);
    let (simulation, mut mako) = mako_in(World { water_level: Some(50.0), ..pool() });
    mako.wait(2.0).unwrap();
    assert!(simulation.truth().pose_in_space(0).unwrap().position.z > 40.0);
    // Numbers that grow beyond all bounds: quarantined, and named.
    let broken = with(&|craft| {
        craft.added_mass = [0.0; 6];
        craft.inertia = [[1e-9, 0.0, 0.0], [0.0, 1e-9, 0.0], [0.0, 0.0, 1e-9]];
        craft.thrusters[0].force = 1e6;
        craft.centre_of_mass = craft.hull[0].centre();
    });
    let (simulation, mut mako) = craft_in(pool(), broken, SimOptions::ideal());
    mako.set_motor(1, 1.0).unwrap();
    mako.wait(20.0).unwrap();
    assert!(simulation.truth().pose_in_space(0).unwrap().is_finite());
    assert_eq!(simulation.truth().mishap(0).unwrap(), Some(Mishap::Broken));
    let murky = World { water: Water { turbidity: -1.0, ..Water::default() }, ..pool() };
    let scene = Scene::with_robot(murky, RobotSpec::mako(), Pose::new(3.0, 5.0, 0.0));
    let error = Simulation::new(&scene, SimOptions::ideal()).unwrap_err().to_string();
    assert!(error.contains("turbidity"), "{error}");
    let windy = World { water: Water { wind: Vector::new(f64::NAN, 0.0), ..Water::default() }, ..pool() };
    let scene = Scene::with_robot(windy, RobotSpec::mako(), Pose::new(3.0, 5.0, 0.0));
    assert!(Simulation::new(&scene, SimOptions::ideal()).is_err());
}

#[test]
fn a_strangers_description_floats() {
    let text = "drive AUV_DRIVE\nmass 20 0 0 0\ncollider box 400 300 900 0 0 0\npsd 6 PSD_DOWN 0 0 0 0 0 0\n";
    let parsed = robi::parse(text, "mako.robi").unwrap();
    let DriveSpec::Craft(craft) = &parsed.value.drive else { panic!("{:?}", parsed.value.drive) };
    assert_eq!(craft.thrusters.len(), 4);
    let (simulation, mut robot) = craft_in(pool(), parsed.value.clone(), SimOptions::ideal());
    robot.wait(3.0).unwrap();
    let afloat = simulation.truth().pose_in_space(0).unwrap();
    assert!((1.5..2.0).contains(&afloat.position.z) && afloat.tilt() < 0.1, "{afloat:?}");
    both(&mut robot, [2, 4], -1.0);
    robot.wait(4.0).unwrap();
    assert!(simulation.truth().pose_in_space(0).unwrap().position.z < afloat.position.z - 0.3);
    assert_eq!(robi::parse(&robi::print(&parsed.value), "mako.robi").unwrap().value, parsed.value);
    for spec in [RobotSpec::mako(), RobotSpec::solar_raft()] {
        let back = robi::parse(&robi::print(&spec), "x.robi").unwrap().value;
        assert_eq!(back.drive, spec.drive);
    }
}

#[test]
fn craft_of_a_fleet_move_as_alone() {
    let mut scene = Scene::with_robot(pool(), RobotSpec::mako(), Pose::new(2.0, 3.0, 0.0));
    let other = roverlab::world::RobotPlacement::new(Arc::new(RobotSpec::mako()), Pose::new(2.0, 7.0, 0.0));
    scene.robots.push(other);
    let mut fleet = Fleet::new(&scene, SimOptions::ideal()).unwrap();
    for robot in 0..2 {
        fleet
            .control(robot, 0.1, |mako| {
                mako.set_motor(1, 0.4)?;
                mako.set_motor(3, 0.5)?;
                Ok(std::ops::ControlFlow::Continue(()))
            })
            .unwrap();
    }
    fleet.run_for(5.0).unwrap();
    let (one, two) = (fleet.pose(0).unwrap(), fleet.pose(1).unwrap());
    assert!(
        (two.y - one.y - 4.0).abs() < 1e-9 && (two.x - one.x).abs() < 1e-9 && one.x > 2.5,
        "{one:?} {two:?}"
    );
}

#[test]
fn a_camera_sees_less_through_turbid_and_deep_water() {
    let picture = |turbidity: f64, level: f64| {
        let water = Water { turbidity, ..Water::default() };
        let (_, mut mako) = mako_in(World { water, water_level: Some(level), ..pool() });
        mako.set_servo(2, -1.0).unwrap();
        mako.wait(4.0).unwrap();
        let image = mako.image().unwrap();
        let [mut red, mut blue] = [0.0, 0.0];
        for pixel in image.pixels() {
            (red, blue) = (red + f64::from(pixel.0[0]), blue + f64::from(pixel.0[2]));
        }
        let count = f64::from(image.width() * image.height());
        (red / count, blue / count)
    };
    let (clear, deep, turbid) = (picture(0.0, 1.9), picture(0.0, 6.0), picture(1.5, 1.9));
    assert!(clear.0 < 0.7 * clear.1 && clear.1 > 150.0, "red fades first: {clear:?}");
    assert!(deep.0 < 0.5 * clear.0 && deep.1 < clear.1, "{deep:?} {clear:?}");
    assert!(turbid.1 < 0.5 * clear.1, "{turbid:?} {clear:?}");
}
