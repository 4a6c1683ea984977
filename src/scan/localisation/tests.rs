use std::f64::consts::{FRAC_PI_2, TAU};

use super::*;
use crate::geometry::{Point, Pose, angle_difference, direction};
use crate::io::sim::{SimOptions, Simulation};
use crate::io::{Lidar, LidarScan, Manoeuvres, Odometry};
use crate::world::{RobotSpec, Scene, Wall, World};

/// A room that looks the same from nowhere else.
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

/// Turns on the spot and takes a scan now and then.
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
    // The error is what the covariance says, give or take.
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

/// A round room of straight pieces with a door: turned by one piece it looks nearly the same.
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
        // A third of a piece: the door alone tells the heading.
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
        // Each place is the true one turned about the middle of the room.
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
        LocaliserParameters { candidates: 0, ..LocaliserParameters::default() },
        LocaliserParameters { least_probability: 0.5, ..LocaliserParameters::default() },
    ] {
        assert!(Localiser::new(LocalisationMap::new(&room()).unwrap(), bad).is_err());
    }
}
