use proptest::prelude::*;

use super::*;
use crate::geometry::Pose;
use crate::io::control::{Halt, run, until};
use crate::io::sim::{NoiseModel, SimOptions, Simulation};
use crate::kinematics::OdometryErrors;
use crate::maze::generate::perfect;
use crate::maze::{Cell, Direction, Maze, Rig, Scale, WallState, mouse};
use crate::world::{RobotSpec, Scene};

const NO_ERRORS: OdometryErrors =
    OdometryErrors { wheel_scale: 0.0, wheel_mismatch: 0.0, track: 0.0, slip: 0.0 };

fn rig(spec: &RobotSpec) -> Rig {
    Rig::new(spec, NO_ERRORS, 0.01).unwrap()
}

/// A maze in which the only exit from the start leads north.
fn maze(seed: u64) -> Maze {
    let mut maze = perfect(6, 6, seed).unwrap();
    maze.set_goals([]);
    if maze.wall(Cell::default(), Direction::North) == WallState::Present {
        maze.set_start(Cell::default(), Direction::East);
    }
    maze
}

/// A full round that ends at its start, without contacts.
const GOOD: (LeftHandOutcome, bool, u32) = (LeftHandOutcome::Stopped, true, 0);

/// Drives a full round. Returns the outcome, whether the robot was where it believed to be, and the contacts.
fn round(
    maze: &Maze,
    spec: &RobotSpec,
    scale: Scale,
    parameters: LeftHandParameters,
    noise: NoiseModel,
    seed: u64,
) -> (LeftHandOutcome, bool, u32) {
    let start = scale.pose(maze.start(), maze.heading());
    let scene = Scene::with_robot(scale.world(maze), spec.clone(), start);
    let simulation = Simulation::new(&scene, SimOptions { seed, noise, ..SimOptions::default() }).unwrap();
    let mut robot = simulation.robot(0).unwrap();
    let mut rule = LeftHand::new(parameters, maze.heading()).unwrap();
    let outcome = run(&mut robot, &mut rule, 3600.0, |_, rule, _| {
        until((rule.cells() > 0 && rule.at() == (0, 0)) || rule.cells() > 200)
    });
    let outcome = outcome.unwrap();
    let end = simulation.truth().robot(0).unwrap();
    let home = rule.cells() == 2 * (maze.cell_count() - 1);
    let there = scale.cell_of(maze, end.pose.position()) == Some(maze.start());
    (outcome, home && there, end.contacts)
}

#[test]
fn open_loop_goes_round_without_errors_and_fails_with_the_books() {
    let spec = RobotSpec::s4();
    let printed = LeftHandParameters::as_printed();
    let drive = |noise, seed| round(&maze(seed), &spec, Scale::DOUBLED, printed, noise, seed);
    assert_eq!(drive(NoiseModel::ideal(), 1), GOOD);
    let failures = (0..10).filter(|&seed| drive(NoiseModel::textbook(), seed) != GOOD);
    assert!(failures.count() >= 8);
}

#[test]
fn controlled_it_goes_round_with_them() {
    let [ideal, textbook, real] = [NoiseModel::ideal(), NoiseModel::textbook(), NoiseModel::real()];
    for (spec, scale) in [(RobotSpec::s4(), Scale::DOUBLED), (mouse(), Scale::MICROMOUSE)] {
        let drive = CellDriveParameters::pid(&rig(&spec), scale, 0.5 * scale.cell);
        let parameters = LeftHandParameters::controlled(drive);
        for noise in [ideal, textbook, real] {
            for seed in 0..4 {
                let end = round(&maze(seed), &spec, scale, parameters, noise, seed);
                assert_eq!(end, GOOD, "{} {noise:?} {seed}", spec.name);
            }
        }
    }
}

/// A corridor with openings on both sides, between wall stubs.
fn comb() -> Maze {
    let mut maze = Maze::open(9, 3).unwrap();
    maze.set_goals([]);
    for x in 0..8 {
        for y in [0, 2] {
            maze.set_wall(Cell::new(x, y), Direction::East, WallState::Present);
        }
    }
    maze
}

#[test]
fn ends_of_walls_at_side_openings_do_not_lead_astray() {
    let (ideal, real) = (NoiseModel::ideal(), NoiseModel::real());
    for (spec, scale) in [(RobotSpec::s4(), Scale::DOUBLED), (mouse(), Scale::MICROMOUSE)] {
        for noise in [ideal, real] {
            let rig = Rig::new(&spec, NO_ERRORS, noise.range).unwrap();
            let drive = CellDriveParameters::pid(&rig, scale, 0.5 * scale.cell);
            let parameters = LeftHandParameters::controlled(drive);
            for seed in 0..10 {
                let end = round(&comb(), &spec, scale, parameters, noise, seed);
                assert_eq!(end, GOOD, "{} {noise:?} {seed}", spec.name);
            }
        }
    }
}

#[test]
fn the_place_in_a_cell_turns_with_the_robot() {
    let mut place = place::PlaceInCell::at(Pose::new(0.0, 0.0, 0.0), 0.36);
    place.predict(Pose::new(0.03, 0.01, 0.02));
    assert!((place.along - 0.03).abs() < 1e-12 && (place.off - 0.01).abs() < 1e-12);
    // Facing left, the longitudinal axis points to the right.
    place.predict(Pose::new(0.03, 0.01, 0.02 + std::f64::consts::FRAC_PI_2));
    assert!((place.along - 0.01).abs() < 1e-12 && (place.off + 0.03).abs() < 1e-12);
    assert!((place.turn - 0.02).abs() < 1e-12);
    place.predict(Pose::new(0.03, 0.01, 0.02 - std::f64::consts::FRAC_PI_2));
    assert!((place.along + 0.01).abs() < 1e-12 && (place.off - 0.03).abs() < 1e-12);
}

#[test]
fn of_a_hundred_mazes_the_controlled_rule_fails_in_none() {
    let failed = |spec: &RobotSpec, scale, parameters: LeftHandParameters| {
        let drive = |seed: u64| round(&maze(seed), spec, scale, parameters, NoiseModel::real(), seed);
        (0..100).filter(|&seed| drive(seed) != GOOD).count()
    };
    let printed = failed(&RobotSpec::s4(), Scale::DOUBLED, LeftHandParameters::as_printed());
    assert!(printed >= 70, "the printed rule fails in {printed} of 100");
    for (spec, scale) in [(RobotSpec::s4(), Scale::DOUBLED), (mouse(), Scale::MICROMOUSE)] {
        let drive = CellDriveParameters::pid(&rig(&spec), scale, 0.5 * scale.cell);
        assert_eq!(failed(&spec, scale, LeftHandParameters::controlled(drive)), 0, "{}", spec.name);
    }
}

#[test]
fn a_lidar_leads_round() {
    for seed in 0..4 {
        let (maze, scale) = (maze(seed), Scale::DOUBLED);
        let start = scale.pose(maze.start(), maze.heading());
        let scene = Scene::with_robot(scale.world(&maze), RobotSpec::s4(), start);
        let options = SimOptions { time_limit: Some(600.0), ..SimOptions::with_noise(1.0, seed) };
        let simulation = Simulation::new(&scene, options).unwrap();
        let truth = simulation.truth();
        let mut visited = vec![false; maze.cell_count()];
        let mut robot = simulation.robot(0).unwrap();
        let parameters = LidarLeftParameters::for_corridor(scale.cell - scale.wall);
        let mut seen = 0;
        let mut follower = LidarLeft::new(parameters).unwrap();
        let drive = run(&mut robot, &mut follower, 600.0, |_, _, step| {
            seen += step.seen.points().count();
            let cell = scale.cell_of(&maze, truth.robot(0).unwrap().pose.position()).unwrap();
            visited[maze.index(cell)] = true;
            until(visited.iter().all(|&visited| visited))
        });
        assert_eq!(drive.unwrap(), Halt::Stopped);
        assert_eq!(truth.robot(0).unwrap().contacts, 0, "seed {seed}");
        assert!(seen > 10_000);
    }
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn off_the_middle_is_what_the_walls_say(off in -0.02..0.02f64, left in any::<bool>(), right in any::<bool>()) {
        let spec = RobotSpec::s4();
        let drive = CellDriveParameters::proportional(&rig(&spec), Scale::DOUBLED, 0.18);
        let controller = CellDrive::new(drive).unwrap();
        let reading = |stands: bool, aside: f64| if stands { aside } else { aside + 0.36 };
        let readings = [1.0, reading(left, drive.aside - off), reading(right, drive.aside + off)];
        match controller.off_middle(readings) {
            Some(found) => prop_assert!((left || right) && (found - off).abs() < 1e-12),
            None => prop_assert!(!left && !right),
        }
    }

    #[test]
    fn the_left_hand_turns_to_what_is_free(readings in prop::array::uniform3(0.05..1.0f64)) {
        let rule = LeftHand::new(LeftHandParameters::as_printed(), Direction::North).unwrap();
        let [front, left, right] = readings.map(|reading| reading > 0.4);
        let expected = if left { 1 } else if front { 0 } else if right { -1 } else { 2 };
        prop_assert_eq!(rule.choose(readings), expected);
    }
}

#[test]
fn it_steers_to_the_middle_and_stops_at_walls() {
    let spec = RobotSpec::s4();
    let drive = CellDriveParameters::proportional(&rig(&spec), Scale::DOUBLED, 0.18);
    // Command on open ground, `x` metres on.
    let step = |x: f64, readings| {
        let mut controller = CellDrive::new(drive).unwrap();
        controller.step(Pose::default(), [1.0; 3], 0.01).unwrap();
        controller.step(Pose::new(x, 0.0, 0.0), readings, 0.01).unwrap()
    };
    // Left of the centre line, it turns right.
    let twist = step(0.0, [1.0, drive.aside - 0.01, drive.aside + 0.01]).unwrap();
    assert!(twist.angular < 0.0 && twist.linear == 0.18);
    assert_eq!(step(0.2, [1.0; 3]).map(|twist| twist.angular), Some(0.0));
    // A wall ahead ends the drive before odometry does; without one, odometry ends it.
    let nearly = 0.355 - drive.coast;
    assert_eq!(step(nearly, [drive.ahead - 0.001, 1.0, 1.0]), None);
    assert!(step(nearly, [1.0; 3]).is_some());
    assert_eq!(step(nearly + 0.006, [1.0; 3]), None);
    let broken = CellDriveParameters { speed: -1.0, ..drive };
    assert!(CellDrive::new(broken).unwrap_err().to_string().contains("speed"));
    let printed = LeftHandParameters { threshold: f64::NAN, ..LeftHandParameters::as_printed() };
    assert!(LeftHand::new(printed, Direction::North).unwrap_err().to_string().contains("threshold"));
    let lidar = LidarLeftParameters { period: 0.0, ..LidarLeftParameters::for_corridor(0.3) };
    assert!(LidarLeft::new(lidar).unwrap_err().to_string().contains("period"));
}

#[test]
fn a_robot_learns_how_far_it_rolls() {
    // It rolls 2 % farther than odometry reports, and passes a known point in each cell.
    let mut place = place::PlaceInCell::at(Pose::default(), 0.18);
    for step in 1..=60 {
        let truth = 0.09 * f64::from(step);
        place.predict(Pose::new(truth / 1.02, 0.0, 0.0));
        if step <= 40 {
            place.correct_along(truth, 5e-3);
        }
    }
    assert!((place.along - 5.4).abs() < 5e-3, "{place:?}");
}

#[test]
fn half_a_turn_is_followed_step_by_step() {
    let mut place = place::PlaceInCell::at(Pose::new(0.0, 0.0, 0.0), 0.18);
    place.predict(Pose::new(0.02, 0.01, 0.0));
    for step in 1..=20 {
        place.predict(Pose::new(0.02, 0.01, 0.16 * f64::from(step)));
    }
    assert!((place.along + 0.02).abs() < 1e-12 && (place.off + 0.01).abs() < 1e-12);
    assert!((place.turn - (3.2 - std::f64::consts::PI)).abs() < 1e-12);
}

/// A corridor of 16 cells to an opening on the left, followed by 4 more.
fn long_corridor() -> Maze {
    let mut maze = Maze::filled(21, 2, WallState::Present).unwrap();
    maze.set_goals([]);
    for x in 0..20 {
        maze.set_wall(Cell::new(x, 0), Direction::East, WallState::Absent);
    }
    maze.set_wall(Cell::new(16, 0), Direction::North, WallState::Absent);
    maze.set_start(Cell::default(), Direction::East);
    maze
}

#[test]
fn after_a_long_corridor_the_opening_is_found() {
    for (spec, scale) in [(RobotSpec::s4(), Scale::DOUBLED), (mouse(), Scale::MICROMOUSE)] {
        let drive = CellDriveParameters::pid(&rig(&spec), scale, 0.5 * scale.cell);
        let start = scale.pose(Cell::default(), Direction::East);
        // One robot in a hundred has wheels too unequal to succeed.
        for seed in 0..20 {
            let maze = long_corridor();
            let scene = Scene::with_robot(scale.world(&maze), spec.clone(), start);
            let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, seed)).unwrap();
            let mut rule = LeftHand::new(LeftHandParameters::controlled(drive), maze.heading()).unwrap();
            let mut robot = simulation.robot(0).unwrap();
            let outcome = run(&mut robot, &mut rule, 600.0, |_, rule, _| until(rule.at() == (16, 1)));
            assert_eq!(outcome.unwrap(), LeftHandOutcome::Stopped);
            let end = simulation.truth().robot(0).unwrap();
            let cell = scale.cell_of(&maze, end.pose.position());
            assert_eq!((cell, end.contacts), (Some(Cell::new(16, 1)), 0), "{} {seed}", spec.name);
        }
    }
}
