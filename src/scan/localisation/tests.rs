use std::f64::consts::{FRAC_PI_2, PI, TAU};

use proptest::prelude::*;

use super::*;
use crate::geometry::{Point, Pose, Twist, angle_difference, direction};
use crate::io::sim::{NoiseModel, SimOptions, Simulation};
use crate::io::{Clock, Drive, Lidar, LidarScan, Manoeuvres, Odometry};
use crate::kinematics::OdometryErrors;
use crate::random::Stream;
use crate::world::generate::{CourseOptions, obstacle_course};
use crate::world::{RobotSpec, Scene, Wall, World};

/// A room without symmetries.
fn room() -> World {
    let mut world = World::walled(2.4, 1.8);
    world.walls.push(Wall::new(Point::new(0.0, 1.1), Point::new(0.7, 1.1)));
    world
}

fn localiser(world: &World) -> Localiser {
    Localiser::new(LocalisationMap::new(world).unwrap(), LocaliserParameters::default()).unwrap()
}

fn simulation(world: &World, start: Pose, noise: f64, seed: u64) -> Simulation {
    let scene = Scene::with_robot(world.clone(), RobotSpec::s4(), start);
    Simulation::new(&scene, SimOptions::with_noise(noise, seed)).unwrap()
}

/// Turns on the spot and scans after each turn.
fn look_round(simulation: &Simulation, localiser: &mut Localiser, scans: u32) {
    let mut robot = simulation.robot(0).unwrap();
    for _ in 0..scans {
        robot.turn(0.4, 1.5).unwrap();
        robot.wait_done().unwrap();
        let (odometry, scan) = (robot.pose().unwrap(), robot.scan().unwrap());
        localiser.update(odometry, &scan).unwrap();
    }
}

fn assert_found(localiser: &Localiser, truth: Pose) {
    let found = localiser.localisation();
    let best = found.best().unwrap_or_else(|| panic!("lost at {truth:?}"));
    let (off, turn) =
        (best.pose.distance_to(truth.position()), angle_difference(best.pose.heading, truth.heading));
    assert!(off < 0.02 && turn.abs() < 0.02, "{off} m, {turn} rad at {truth:?}");
    // The error agrees with the covariance.
    let deviation = (best.covariance[(0, 0)] + best.covariance[(1, 1)]).sqrt();
    assert!(off < 5.0 * deviation + 0.002, "{off} m with {deviation} m");
}

#[test]
fn a_place_is_found_wherever_it_is() {
    let world = room();
    for (seed, start) in [
        Pose::new(0.4, 0.5, 0.0),
        Pose::new(2.0, 1.4, 2.0),
        Pose::new(0.3, 1.5, -1.5),
        Pose::new(1.2, 0.9, 3.0),
    ]
    .into_iter()
    .enumerate()
    {
        for noise in [0.0, 1.0, 2.0] {
            let simulation = simulation(&world, start, noise, seed as u64);
            let mut localiser = localiser(&world);
            look_round(&simulation, &mut localiser, 6);
            assert_eq!(localiser.localisation().count(), 1, "{start:?} {noise}");
            assert_found(&localiser, simulation.truth().pose(0).unwrap());
        }
    }
}

/// Errors of position and heading in stated deviations, after a ride on a circle and turns on the spot.
fn errors_of_a_ride(noise: f64, seed: u64) -> [f64; 2] {
    let (world, start) = (room(), Pose::new(1.2, 0.55, 0.0));
    let simulation = simulation(&world, start, noise, seed);
    let NoiseModel { wheel_scale, wheel_mismatch, track, slip, range, .. } = NoiseModel::real().scaled(noise);
    let odometry = OdometryErrors { wheel_scale, wheel_mismatch, track, slip };
    let parameters = LocaliserParameters { range_error: range, odometry, ..LocaliserParameters::default() };
    let mut localiser = Localiser::new(LocalisationMap::new(&world).unwrap(), parameters).unwrap();
    localiser.start_at(start);
    let mut robot = simulation.robot(0).unwrap();
    for step in 0..25 {
        robot.set_speed(if step < 15 { Twist::new(0.2, 0.57) } else { Twist::new(0.0, 1.5) }).unwrap();
        robot.wait(0.4).unwrap();
        localiser.update(robot.pose().unwrap(), &robot.scan().unwrap()).unwrap();
    }
    let (found, truth) = (localiser.hypotheses()[0], simulation.truth().pose(0).unwrap());
    let turn = angle_difference(found.pose.heading, truth.heading).abs();
    [found.pose.distance_to(truth.position()) / found.deviation(), turn / found.covariance[(2, 2)].sqrt()]
}

/// With strong noise, wheels err by far more than usual, and beams by more than the narrowest gate once was
/// wide: errors of the heading were twice the stated deviations.
#[test]
fn stated_deviations_hold_with_strong_noise() {
    for noise in [1.0, 4.0, 5.0] {
        let rides: Vec<_> = (0..30).map(|seed| errors_of_a_ride(noise, seed)).collect();
        for (axis, name) in [(0, "position"), (1, "heading")] {
            let square: f64 = rides.iter().map(|errors| errors[axis] * errors[axis]).sum();
            let size = (square / rides.len() as f64).sqrt();
            let worst = rides.iter().map(|errors| errors[axis]).fold(0.0, f64::max);
            assert!(
                size < 0.8 && worst < 2.5,
                "{name} at noise {noise}: {size} deviations, at worst {worst}"
            );
        }
    }
}

/// In a round room of straight pieces, poses turned by half a piece fit their surroundings best.
#[test]
fn a_pose_between_two_turned_ones_is_found() {
    let options = CourseOptions { unreachable_share: 0.0, ..CourseOptions::default() };
    let world = obstacle_course(&mut Stream::new(7), &options).unwrap().world;
    let start = Pose::new(2.822_376_9, 2.247_382_8, 2.471_942_98);
    let simulation = simulation(&world, start, 1.0, 55);
    let mut localiser = localiser(&world);
    let mut robot = simulation.robot(0).unwrap();
    localiser.update(robot.pose().unwrap(), &robot.scan().unwrap()).unwrap();
    let found = localiser.hypotheses().iter().any(|place| {
        let turn = angle_difference(place.pose.heading, start.heading).abs();
        place.pose.distance_to(start.position()) < 0.02 && turn < 0.03
    });
    assert!(found, "{:?}", localiser.hypotheses());
}

/// A round room of straight pieces with a door: rotated by one piece, it looks nearly the same.
#[test]
fn a_round_room_is_not_taken_for_itself_turned() {
    const PIECES: usize = 40;
    let middle = Point::new(1.0, 1.0);
    let corner = |i: usize| middle + direction(TAU * i as f64 / PIECES as f64) * 0.6;
    let mut world = World::empty(2.0, 2.0);
    world.walls.extend((3..PIECES).map(|i| Wall::new(corner(i), corner(i + 1))));
    for seed in 0..8_u64 {
        let start = Pose::new(0.9 + 0.03 * seed as f64, 1.1, 0.7 * seed as f64);
        let simulation = simulation(&world, start, 1.0, seed);
        let mut localiser = localiser(&world);
        look_round(&simulation, &mut localiser, 8);
        assert_eq!(localiser.localisation().count(), 1, "{start:?}");
        let (found, truth) = (localiser.hypotheses()[0].pose, simulation.truth().pose(0).unwrap());
        // A third of a piece: only the door determines the heading.
        let turn = angle_difference(found.heading, truth.heading).abs();
        assert!(turn < TAU / 120.0 && found.distance_to(truth.position()) < 0.03, "{found:?} at {truth:?}");
    }
}

#[test]
fn symmetric_worlds_leave_as_many_places_as_look_alike() {
    for (world, count) in [(World::walled(2.0, 1.5), 2), (World::walled(1.6, 1.6), 4)] {
        let size = world.floor.size();
        let start = Pose::new(0.5, 0.6, 0.7);
        let simulation = simulation(&world, start, 1.0, 3);
        let mut localiser = localiser(&world);
        look_round(&simulation, &mut localiser, 10);
        let Localisation::Several(found, _) = localiser.localisation() else {
            panic!("{:?}", localiser.localisation())
        };
        assert_eq!(found, count);
        let truth = simulation.truth().pose(0).unwrap();
        // Each pose is the true one, rotated about the centre of the room.
        let middle = Point::new(0.5 * size.x, 0.5 * size.y);
        for place in localiser.hypotheses() {
            let turn = angle_difference(place.pose.heading, truth.heading);
            let quarter = (turn / FRAC_PI_2).round() * FRAC_PI_2;
            let arm = Pose::new(0.0, 0.0, quarter).to_world(Point::from(truth.position() - middle));
            assert!((turn - quarter).abs() < 0.03 && place.pose.distance_to(middle + arm.coords) < 0.03);
        }
        assert!(localiser.hypotheses().iter().all(|place| place.probability > 0.5 / count as f64));
    }
}

/// Scan of a lidar with a range of 10 m and noise of 10 mm.
fn scan_at(map: &LocalisationMap, pose: &Pose, seed: u64) -> LidarScan {
    let mut scan = LidarScan {
        angle_min: -PI,
        angle_increment: TAU / 360.0,
        range_max: 10.0,
        mount: Pose::default(),
        ranges: vec![0.0; 360],
    };
    map.expect(&mut map.scanner(&scan, 1), pose, &mut scan.ranges);
    let mut stream = Stream::new(seed);
    for range in &mut scan.ranges {
        let measured = *range + 0.01 * stream.normal();
        *range = if measured > scan.range_max { f64::INFINITY } else { measured };
    }
    scan
}

/// In halls with a visible corner, all four symmetric poses are reported, each the true one rotated.
#[test]
fn all_places_of_an_empty_hall_that_look_alike_are_told() {
    for (seed, size, place) in
        [(1, 10.0, Point::new(3.1, 4.2)), (2, 20.0, Point::new(6.0, 13.5)), (3, 28.0, Point::new(24.0, 5.0))]
    {
        let world = World::walled(size, size);
        let mut localiser = localiser(&world);
        let truth = Pose::new(place.x, place.y, 0.4);
        let scan = scan_at(localiser.map(), &truth, seed);
        localiser.update(Pose::default(), &scan).unwrap();
        assert_eq!(localiser.localisation().count(), 4, "{size} m");
        let middle = Point::new(0.5 * size, 0.5 * size);
        for quarter in 0..4 {
            let turn = FRAC_PI_2 * f64::from(quarter);
            let arm = Pose::new(0.0, 0.0, turn).to_world(Point::from(place - middle));
            let is_told = |found: &Hypothesis| {
                found.pose.distance_to(middle + arm.coords) < 0.03
                    && angle_difference(found.pose.heading, truth.heading + turn).abs() < 0.01
            };
            assert!(localiser.hypotheses().iter().any(is_told), "{quarter} quarters in {size} m");
        }
    }
}

/// Along a long wall, and even more in the open, positions cannot be told apart.
#[test]
fn where_little_is_seen_the_robot_is_lost() {
    let world = World::walled(60.0, 60.0);
    for place in [Pose::new(30.0, 4.0, 1.0), Pose::new(25.0, 9.9, 0.0), Pose::new(30.0, 30.0, 0.0)] {
        let mut localiser = localiser(&world);
        let scan = scan_at(localiser.map(), &place, 1);
        localiser.update(Pose::default(), &scan).unwrap();
        assert_eq!(localiser.localisation(), Localisation::Lost, "{place:?}");
        // Standing still, it does not search again; elsewhere it does.
        localiser.update(Pose::new(0.0, 0.01, 0.0), &scan).unwrap();
        assert_eq!(localiser.searches(), 1);
        let corner = scan_at(localiser.map(), &Pose::new(4.0, 3.0, 0.0), 2);
        localiser.update(Pose::new(30.0, 0.0, 0.0), &corner).unwrap();
        assert_eq!((localiser.searches(), localiser.localisation().count()), (2, 4));
    }
}

proptest! {
    #![proptest_config(crate::testing::cases(24))]

    /// In any world, the true pose is among those found, unless there are too many.
    #[test]
    fn the_search_leaves_no_pose_out(
        ends in proptest::collection::vec(((0.0..9.0), (0.0..7.0), (-2.0..2.0), (-2.0..2.0)), 0..6),
        place in (0.3..8.7, 0.3..6.7, -3.1..3.1),
        seed in 0..1000u64,
    ) {
        let mut world = World::walled(9.0, 7.0);
        world.walls.extend(ends.iter().map(|&(x, y, u, v): &(f64, f64, f64, f64)| {
            Wall::new(Point::new(x, y), Point::new(x + u, y + v))
        }));
        let map = LocalisationMap::new(&world).unwrap();
        let truth = Pose::new(place.0, place.1, place.2);
        prop_assume!(map.is_free(truth.position(), 0.1));
        let scan = scan_at(&map, &truth, seed);
        let (bounds, parameters) = (map.within_reach(0.0), LocaliserParameters::default());
        if let Some(found) = search::search(&map, &bounds, &scan, &parameters, 0.85) {
            let is_near = |pose: &Pose| {
                pose.distance_to(truth.position()) < 0.2 && angle_difference(pose.heading, truth.heading).abs() < 0.05
            };
            prop_assert!(found.iter().any(is_near), "{truth:?} is not among {} poses", found.len());
        }
    }
}

#[test]
fn a_robot_that_was_carried_away_is_found_again() {
    let world = room();
    let simulation = simulation(&world, Pose::new(0.4, 0.5, 0.0), 1.0, 1);
    let mut localiser = localiser(&world);
    look_round(&simulation, &mut localiser, 4);
    assert_found(&localiser, simulation.truth().pose(0).unwrap());
    simulation.truth().set_pose(0, Pose::new(2.0, 1.4, 2.5)).unwrap();
    look_round(&simulation, &mut localiser, 16);
    assert_found(&localiser, simulation.truth().pose(0).unwrap());
    assert!(localiser.searches() > 1);
}

#[test]
fn in_another_world_the_robot_is_lost() {
    let simulation = simulation(&World::walled(5.0, 5.0), Pose::new(2.5, 2.5, 0.0), 1.0, 1);
    let mut localiser = localiser(&World::walled(1.5, 1.2));
    look_round(&simulation, &mut localiser, 4);
    assert_eq!((localiser.localisation(), localiser.localisation().count()), (Localisation::Lost, 0));
    assert!(localiser.localisation().best().is_none());
}

#[test]
fn wrong_input_is_refused() {
    let mut localiser = localiser(&room());
    assert!(localiser.update(Pose::default(), &LidarScan::default()).is_err());
    let scan = LidarScan {
        angle_increment: 0.1,
        range_max: 5.0,
        ranges: vec![f64::INFINITY; 60],
        ..LidarScan::default()
    };
    assert!(localiser.update(Pose::new(f64::NAN, 0.0, 0.0), &scan).is_err());
    for bad in [
        LocaliserParameters { radius: 0.0, ..LocaliserParameters::default() },
        LocaliserParameters { least_probability: 0.5, ..LocaliserParameters::default() },
    ] {
        assert!(Localiser::new(LocalisationMap::new(&room()).unwrap(), bad).is_err());
    }
}
