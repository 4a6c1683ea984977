//! A fast car, whose mass and tyres count, among walls, cones and other cars.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use roverlab::geometry::{Point, Pose, Twist, angle_difference, math};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::wrappers::Traced;
use roverlab::io::{
    Camera, Clock, Drive, Encoders, ErrorKind, Lidar, Manoeuvres, Motors, Odometry, Radio, Resolution,
    RobotIo, StallDetector,
};
use roverlab::race::{Cone, ConeColour, ConeTrack};
use roverlab::world::formats::{MemoryFiles, esobj, robi, sim};
use roverlab::world::{RobotSpec, Scene, World};

/// Cars among cones.
fn race(cones: &[(f64, f64)], cars: &[Pose], options: SimOptions) -> Simulation {
    let cones = cones.iter().map(|&(x, y)| Cone::new(Point::new(x, y), ConeColour::Blue)).collect();
    let scene = ConeTrack { cones, ..ConeTrack::default() }.scene(cars);
    Simulation::new(&scene, options).unwrap()
}

/// What a car in a thread of its own goes through, and what it has learned.
fn drive(robot: impl RobotIo, speed: f64) -> Vec<u8> {
    let mut car = Traced::new(robot, Vec::new()).whole_scans();
    for step in 0..20 {
        car.set_speed(Twist::new(speed, 0.1 * f64::from(step % 5) - 0.2)).unwrap();
        car.scan().unwrap();
        car.send(1 + step % 2, b"passing").unwrap();
        car.wait(0.25).unwrap();
        car.receive().unwrap();
        car.pose().unwrap();
    }
    car.finish().1.unwrap()
}

#[test]
fn two_cars_that_each_wait_five_seconds_see_five_seconds() {
    let starts = [0.0, 4.0].map(|y| Pose::new(0.0, y, 0.0));
    let race = race(&[], &starts, SimOptions::default());
    let cars = [0, 1].map(|index| race.robot(index).unwrap());
    let times = thread::scope(|scope| {
        let wait = |mut car: roverlab::io::sim::SimRobot| {
            car.wait(5.0).unwrap();
            car.now().unwrap()
        };
        cars.map(|car| scope.spawn(move || wait(car))).map(|thread| thread.join().unwrap())
    });
    assert!(times.iter().all(|time| (time - 5.0).abs() < 0.01), "{times:?}");
    assert!((race.truth().time() - 5.0).abs() < 0.02);
}

#[test]
fn twenty_races_of_two_threads_under_load_are_equal_to_the_byte() {
    let run = || {
        let cones: Vec<_> = (0..30).flat_map(|i| [-1.0, 5.0].map(|y| (3.0 * f64::from(i), y))).collect();
        let starts = [0.0, 4.0].map(|y| Pose::new(0.0, y, 0.0));
        let race = race(&cones, &starts, SimOptions::default());
        let [first, second] = [0, 1].map(|index| race.robot(index).unwrap());
        let logs = thread::scope(|scope| {
            let second = scope.spawn(|| drive(second, 3.0));
            [drive(first, 9.0), second.join().unwrap()]
        });
        let truths = [0, 1].map(|car| format!("{:?}", race.truth().robot(car).unwrap()));
        (logs, truths)
    };
    let idle = run();
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                while !over.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        for number in 1..20 {
            assert!(run() == idle, "run {number}");
        }
        over.store(true, Ordering::Relaxed);
    });
}

#[test]
fn a_car_against_a_wall_is_stalled_and_stands() {
    let start = Pose::new(3.0, 5.0, 0.0);
    let scene = Scene::with_robot(World::walled(20.0, 10.0), RobotSpec::race_car(), start);
    let simulation = Simulation::new(&scene, SimOptions::default()).unwrap();
    let mut car = simulation.robot(0).unwrap();
    car.set_speed(Twist::new(6.0, 0.0)).unwrap();
    car.wait(1.0).unwrap();
    assert!(!car.is_stalled().unwrap());
    car.wait(4.0).unwrap();
    assert!(car.is_stalled().unwrap());
    assert!(car.speed().unwrap().linear.abs() < 0.2, "{:?}", car.speed());
    let truth = simulation.truth().robot(0).unwrap();
    // The nose is 2.15 m ahead of the axle, and the wall 10 mm thick.
    assert!((truth.pose.x - (20.0 - 0.005 - 2.15)).abs() < 0.005 && truth.contacts == 1, "{truth:?}");
    // Who stands because nothing is asked of it is not stalled.
    car.set_speed(Twist::STOP).unwrap();
    car.wait(1.0).unwrap();
    assert!(!car.is_stalled().unwrap());
    car.straight(2.0, 2.0).unwrap();
    car.wait_done().unwrap();
    assert!(car.is_stalled().unwrap() && !car.is_done().unwrap() && car.remaining().unwrap() > 1.9);
    car.straight(-2.0, 2.0).unwrap();
    car.wait_done().unwrap();
    assert!(car.is_done().unwrap() && !car.is_stalled().unwrap() && car.remaining().unwrap() == 0.0);
}

#[test]
fn a_car_slides_along_a_slanted_wall() {
    let start = Pose::new(5.0, 2.0, 0.5);
    let scene = Scene::with_robot(World::walled(60.0, 5.0), RobotSpec::race_car(), start);
    let simulation = Simulation::new(&scene, SimOptions::ideal()).unwrap();
    let mut car = simulation.robot(0).unwrap();
    car.set_speed(Twist::new(4.0, 0.0)).unwrap();
    car.wait(3.0).unwrap();
    let truth = simulation.truth().robot(0).unwrap();
    assert!(truth.contacts > 0 && truth.pose.x > 8.0 && truth.pose.y < 5.0, "{truth:?}");
}

#[test]
fn manoeuvres_end_where_they_should() {
    for (length, angle, speed) in [(10.0, 0.0, 3.0), (-6.0, 0.0, 2.0), (12.0, 1.2, 3.0), (30.0, -0.5, 8.0)] {
        let race = race(&[], &[Pose::default()], SimOptions::ideal());
        let mut car = race.robot(0).unwrap();
        car.curve(length, angle, speed).unwrap();
        assert!(!car.is_done().unwrap() && (car.remaining().unwrap() - length.abs()).abs() < 0.01);
        car.wait_done().unwrap();
        assert!(car.is_done().unwrap() && car.remaining().unwrap() == 0.0);
        let pose = race.truth().pose(0).unwrap();
        let goal = roverlab::kinematics::advance(
            Pose::default(),
            roverlab::kinematics::Displacement { length, angle },
        );
        let away = pose.distance_to(goal.position());
        // At 8 m/s, tyres that slip bend a curve less than wheels that roll.
        let share = if speed > 4.0 { 0.10 } else { 0.02 };
        assert!(away < share * length.abs(), "{length} {angle}: {away} m off, at {pose:?}");
        assert!(angle_difference(pose.heading, angle).abs() < 0.1, "{length} {angle}: {pose:?}");
        // The encoder counts what the axle rolled: 1000 ticks for a turn of a wheel half a metre wide.
        let rolled = car.encoder(1).unwrap() as f64 * 0.5 * std::f64::consts::PI / 1000.0;
        assert!((rolled - length).abs() < 0.02, "{rolled} of {length}");
    }
    let race = race(&[], &[Pose::default()], SimOptions::ideal());
    let error = race.robot(0).unwrap().turn(1.0, 1.0).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Unsupported);
}

#[test]
fn cones_fall_and_are_gone() {
    let race = race(&[(10.0, 0.5), (30.0, 0.0), (10.0, 4.0)], &[Pose::default()], SimOptions::ideal());
    let (mut car, truth) = (race.robot(0).unwrap(), race.truth());
    let first = |scan: roverlab::io::LidarScan| scan.ranges.into_iter().fold(f64::INFINITY, f64::min);
    // From the nose to what the lidar sees of the cone at its own height.
    let reach = math::hypot(10.0 - 2.15, 0.5);
    assert!((first(car.scan().unwrap()) - reach + 0.065).abs() < 0.01);
    car.set_speed(Twist::new(4.0, 0.0)).unwrap();
    car.wait(4.0).unwrap();
    let now = truth.robot(0).unwrap();
    assert_eq!((now.contacts, now.contact_places.as_slice()), (1, &[Point::new(10.0, 0.5)][..]));
    assert_eq!([0, 1, 2].map(|cone| truth.has_fallen(cone).unwrap()), [true, false, false]);
    assert!(!car.is_stalled().unwrap() && now.pose.x > 13.0, "a cone does not hold it: {now:?}");
    assert!(truth.has_fallen(3).is_err());
    // A hand puts it up again.
    truth.set_object(0, Pose::new(20.0, 0.0, 0.0)).unwrap();
    assert!(!truth.has_fallen(0).unwrap());
    car.wait(2.5).unwrap();
    assert_eq!(truth.robot(0).unwrap().contacts, 2);
}

#[test]
fn a_camera_sees_a_cone_until_it_falls() {
    let race = race(&[(6.0, 0.3)], &[Pose::default()], SimOptions::ideal());
    let mut car = race.robot(0).unwrap();
    car.set_resolution(Resolution::Vga).unwrap();
    let blue = |image: image::RgbImage| image.pixels().filter(|p| p[2] > p[0].saturating_add(60)).count();
    let before = blue(car.image().unwrap());
    assert!(before > 80, "{before}");
    car.straight(8.0, 3.0).unwrap();
    car.wait_done().unwrap();
    car.straight(-8.0, 3.0).unwrap();
    car.wait_done().unwrap();
    assert!(race.truth().has_fallen(0).unwrap(), "{:?}", race.truth().robot(0));
    assert_eq!(blue(car.image().unwrap()), 0, "{:?}", race.truth().robot(0));
}

#[test]
fn what_is_heavier_than_a_robot_does_not_fall() {
    let mut world = World::walled(4.0, 2.0);
    let kind = std::sync::Arc::new(ConeColour::Orange.kind());
    world.objects.push(roverlab::world::Object::new(kind, Pose::new(2.0, 1.0, 0.0)));
    for (mass, contacts, x) in [(0.3, 1, 1.8), (0.5, 1, 3.4)] {
        let spec = RobotSpec { mass, ..RobotSpec::s4() };
        let scene = Scene::with_robot(world.clone(), spec, Pose::new(1.0, 1.0, 0.0));
        let simulation = Simulation::new(&scene, SimOptions::ideal()).unwrap();
        let mut robot = simulation.robot(0).unwrap();
        robot.straight(2.5, 0.5).unwrap();
        robot.wait_done().unwrap();
        let truth = simulation.truth().robot(0).unwrap();
        assert!(truth.contacts == contacts && (truth.pose.x - x).abs() < 0.15, "{mass} kg: {truth:?}");
    }
}

#[test]
fn cars_meet_as_solids() {
    let starts = [Pose::default(), Pose::new(12.0, 0.0, 0.0)];
    let race = race(&[], &starts, SimOptions::ideal());
    let mut car = race.robot(0).unwrap();
    car.set_motor(1, 0.2).unwrap();
    car.wait(5.0).unwrap();
    let truths = [0, 1].map(|car| race.truth().robot(car).unwrap());
    assert!(truths.iter().all(|truth| truth.contacts == 1), "{truths:?}");
    // Nose to tail.
    assert!((truths[0].pose.x - (12.0 - 0.45 - 2.15)).abs() < 0.01, "{truths:?}");
}

#[test]
fn a_script_places_cars_and_cones() {
    let files = [
        ("racer.robi", robi::print(&RobotSpec::race_car())),
        ("cone.esObj", esobj::print(&ConeColour::Blue.kind())),
        ("field.wld", "floor 40000 20000\n".to_owned()),
    ];
    let mut files = MemoryFiles(files.map(|(name, text)| (name.to_owned(), text.into_bytes())).into());
    let script =
        "world field.wld\nrobot racer.robi\nobject cone.esObj\nRaceCar 3000 5000 0\ncone-blue 12000 5200 0\n";
    let scene = sim::parse(script, "race.sim", &mut files).unwrap().value;
    assert_eq!(*scene.robots[0].spec, RobotSpec::race_car());
    let simulation = Simulation::new(&scene, SimOptions::default()).unwrap();
    let mut car = simulation.robot(0).unwrap();
    car.set_speed(Twist::new(5.0, 0.0)).unwrap();
    car.wait(3.0).unwrap();
    assert!(simulation.truth().has_fallen(0).unwrap());
}

#[test]
fn noise_of_commands_bends_and_slows_a_car() {
    let way = |command: f64| {
        let mut options = SimOptions::ideal();
        options.noise.command = command;
        let race = race(&[], &[Pose::default()], options);
        let mut car = race.robot(0).unwrap();
        car.set_speed(Twist::new(3.0, 0.6)).unwrap();
        car.wait(3.0).unwrap();
        race.truth().pose(0).unwrap()
    };
    let apart = way(0.05).distance_to(way(0.0).position());
    assert!(apart > 0.05 && apart < 2.0, "{apart}");
}

#[test]
fn numbers_that_are_no_car_are_named() {
    let mut spec = RobotSpec::race_car();
    let roverlab::world::DriveSpec::Ackermann { dynamics: Some(dynamics), .. } = &mut spec.drive else {
        panic!("a racing car has tyres")
    };
    dynamics.grip = f64::NAN;
    let scene = Scene::with_robot(World::empty(1.0, 1.0), spec, Pose::default());
    let error = Simulation::new(&scene, SimOptions::default()).unwrap_err();
    assert_eq!(error.to_string(), "robot RaceCar: grip is NaN; expected more than 0 and less than 100");
}
