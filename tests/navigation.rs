//! Navigation in the simulator: the scan filter, the scan matcher and DistBug as their users have them.

use std::f64::consts::PI;

use roverlab::geometry::{Point, Pose, Twist, Vector, angle_difference, units};
use roverlab::io::control::{self, Behaviour, LidarObservation};
use roverlab::io::sim::{NoiseModel, SimOptions, SimRobot, Simulation, Truth};
use roverlab::io::wrappers::{Fault, Faulty};
use roverlab::io::{Clock, Drive, ErrorKind, Lidar, LidarScan, Manoeuvres, Odometry};
use roverlab::nav::{
    BugEvent, BugOutcome, BugParameters, DistBug, Navigator, NavigatorOutcome, NavigatorParameters,
    NavigatorPhase,
};
use roverlab::scan::{
    Localisation, LocalisationMap, Localiser, LocaliserParameters, ScanFilter, ScanMatcher,
};
use roverlab::world::{Footprint, RobotSpec, Scene, Wall, World};

/// A room with a block in it.
fn room() -> World {
    let mut world = World::walled(3.0, 3.0);
    let block = [(1.8, 1.2), (2.3, 1.2), (2.3, 2.0), (1.8, 2.0)];
    world.add_loop(&block.map(|(x, y)| Point::new(x, y)));
    world
}

fn robot_in(world: World, start: Pose, options: SimOptions) -> (SimRobot, Truth) {
    let scene = Scene::with_robot(world, RobotSpec::s4(), start);
    let simulation = Simulation::new(&scene, options).expect("a valid scene");
    let truth = simulation.truth();
    (simulation.robot(0).expect("one robot"), truth)
}

const START: Pose = Pose::new(0.8, 0.8, 0.3);

#[test]
fn the_filter_takes_most_of_the_noise_out_of_scans_of_a_moving_robot() {
    let (mut noisy, _) =
        robot_in(room(), START, SimOptions { noise: ranges_only(0.02), ..SimOptions::default() });
    let (mut exact, _) = robot_in(room(), START, SimOptions::ideal());
    let mut filter = ScanFilter::new();
    let (mut raw_error, mut filtered_error, mut count) = (0.0, 0.0, 0.0);
    for step in 0..60 {
        let scan = noisy.scan().unwrap();
        let truth = exact.scan().unwrap();
        filter.update(noisy.pose().unwrap(), &scan).unwrap();
        if step >= 30 {
            for ((filtered, raw), exact) in filter.ranges().zip(&scan.ranges).zip(&truth.ranges) {
                raw_error += (raw - exact).abs();
                // Beams at an edge belong to one surface or the other: such an error is not noise.
                filtered_error += (filtered - exact).abs().min(0.1);
                count += 1.0;
            }
        }
        for robot in [&mut noisy, &mut exact] {
            robot.set_speed(Twist::new(0.1, 0.4)).unwrap();
            robot.wait(0.05).unwrap();
        }
    }
    let (raw, filtered) = (raw_error / count, filtered_error / count);
    assert!(filtered < 0.5 * raw, "{filtered} against {raw}");
    assert!((filter.noise() - 0.02).abs() < 0.005, "{}", filter.noise());
}

/// The mean over both sides of a corner would lie several millimetres behind it.
#[test]
fn the_filter_keeps_a_corner_that_points_at_the_robot() {
    let corner = Point::new(1.0, 1.0);
    let world = World {
        walls: [Vector::x(), Vector::y()].map(|side| Wall::new(corner, corner + side)).into(),
        ..World::walled(2.0, 2.0)
    };
    let start = Pose::new(0.75, 0.75, 0.25 * PI);
    let (mut robot, _) = robot_in(world, start, SimOptions::ideal());
    let mut filter = ScanFilter::new();
    for _ in 0..60 {
        filter.update(robot.pose().unwrap(), &robot.scan().unwrap()).unwrap();
        robot.set_speed(Twist::new(0.1, 0.0)).unwrap();
        robot.wait(0.05).unwrap();
    }
    let position = start.compose(&robot.pose().unwrap()).position();
    let seen = filter.ranges().fold(f64::INFINITY, f64::min);
    let distance = (corner - position).norm();
    assert!(distance < 0.08 && (seen - distance).abs() < 0.003, "{seen} for {distance}");
}

fn ranges_only(sigma: f64) -> NoiseModel {
    NoiseModel { range: sigma, ..NoiseModel::ideal() }
}

#[test]
fn the_filter_wants_a_full_turn() {
    let half = LidarScan {
        angle_min: -0.5 * PI,
        angle_increment: PI / 180.0,
        ranges: vec![1.0; 180],
        ..LidarScan::default()
    };
    let error = ScanFilter::new().update(Pose::default(), &half).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::InvalidInput);
    assert_eq!(
        error.to_string(),
        "lidar scan is 180 beams over 3.14 rad; expected at least 36 beams over a full turn"
    );
}

#[test]
fn matching_scans_takes_back_the_drift_of_odometry() {
    for seed in 1..=5 {
        let (mut robot, truth) = robot_in(room(), START, SimOptions::with_noise(2.0, seed));
        let mut matcher = ScanMatcher::new();
        let mut filter = ScanFilter::new();
        for step in 0..400 {
            let scan = robot.scan().unwrap();
            let points: Vec<Point> = scan.points().collect();
            let corrected = matcher.update(robot.pose().unwrap(), &points);
            filter.update(corrected, &scan).unwrap();
            if step >= 12 {
                matcher.learn(&filter.points().collect::<Vec<_>>());
            }
            let ahead = if step % 100 < 60 { 0.15 } else { 0.0 };
            let twist = if step < 12 { Twist::STOP } else { Twist::new(ahead, 0.8) };
            robot.set_speed(twist).unwrap();
            robot.wait(0.05).unwrap();
        }
        let measured = robot.pose().unwrap();
        let odometry = START.compose(&measured);
        let estimate = START.compose(&matcher.corrected(measured));
        let actual = truth.pose(0).unwrap();
        let drift = odometry.distance_to(actual.position());
        let rest = estimate.distance_to(actual.position());
        let heading = angle_difference(estimate.heading, actual.heading).abs();
        let turn_drift = angle_difference(odometry.heading, actual.heading).abs();
        assert!(
            rest < 0.02 && heading < 0.02,
            "seed {seed}: {rest} m, {heading} rad; odometry {drift} m, {turn_drift} rad"
        );
        assert!(matcher.references() < 30);
    }
}

/// Runs DistBug and returns its verdict, its events and what is true at the end.
fn run(
    world: World,
    start: Pose,
    goal: Point,
    options: SimOptions,
) -> (BugOutcome, Vec<BugEvent>, Pose, u32) {
    let (mut robot, truth) = robot_in(world, start, options);
    let mut bug = DistBug::new(start.to_local(goal), BugParameters::default()).unwrap();
    let mut events = Vec::new();
    let outcome =
        control::run(&mut robot, &mut bug, 300.0, |_, bug, _| events.extend(bug.take_events())).unwrap();
    let truth = truth.robot(0).unwrap();
    (outcome, events, truth.pose, truth.contacts)
}

#[test]
fn a_goal_in_sight_is_reached_without_a_hit() {
    let goal = Point::new(1.2, 2.5);
    let (outcome, events, pose, contacts) = run(room(), START, goal, SimOptions::ideal());
    assert_eq!((outcome, contacts), (BugOutcome::Reached, 0));
    assert_eq!(events, [BugEvent::End(BugOutcome::Reached)]);
    assert!(pose.distance_to(goal) < 0.05);
}

#[test]
fn hits_and_leaves_alternate_and_get_nearer() {
    let goal = Point::new(2.6, 2.0);
    for noise in [0.0, 1.0] {
        let (outcome, events, pose, contacts) = run(room(), START, goal, SimOptions::with_noise(noise, 3));
        assert_eq!((outcome, contacts), (BugOutcome::Reached, 0), "noise {noise}");
        assert!(pose.distance_to(goal) < 0.05);
        let kinds: Vec<_> = events.iter().map(std::mem::discriminant).collect();
        assert!(kinds.windows(2).all(|pair| pair[0] != pair[1]), "{events:?}");
        assert!(matches!(events[0], BugEvent::Hit { .. }));
    }
}

#[test]
fn a_walled_in_goal_is_unreachable() {
    let mut world = World::walled(3.0, 3.0);
    let ring: Vec<Point> = (0..24)
        .map(|i| Point::new(2.0, 2.0) + roverlab::geometry::direction(PI * f64::from(i) / 12.0) * 0.4)
        .collect();
    world.add_loop(&ring);
    for noise in [0.0, 1.0] {
        let options = SimOptions::with_noise(noise, 2);
        let (outcome, _, _, contacts) = run(world.clone(), START, Point::new(2.0, 2.0), options);
        assert_eq!((outcome, contacts), (BugOutcome::Unreachable, 0), "noise {noise}");
    }
}

#[test]
fn a_robot_in_a_box_says_so() {
    let mut world = World::walled(3.0, 3.0);
    let side = 0.075;
    let corners = [(-side, -side), (side, -side), (side, side), (-side, side)];
    world.add_loop(&corners.map(|(x, y)| Point::new(START.x + x, START.y + y)));
    let (outcome, ..) = run(world, START, Point::new(2.0, 2.0), SimOptions::ideal());
    assert_eq!(outcome, BugOutcome::Unreachable);
}

#[test]
fn time_runs_out() {
    let (mut robot, _) = robot_in(room(), START, SimOptions::ideal());
    let mut bug = DistBug::new(Point::new(5.0, 0.0), BugParameters::default()).unwrap();
    assert_eq!(control::run(&mut robot, &mut bug, 1.0, |_, _, _| {}).unwrap(), BugOutcome::TimedOut);
}

#[test]
fn bad_parameters_and_readings_are_named() {
    let parameters = BugParameters { step: -1.0, ..BugParameters::default() };
    let error = DistBug::new(Point::origin(), parameters).unwrap_err();
    assert_eq!(error.to_string(), "STEP is -1; expected a positive, finite number");
    assert!(DistBug::new(Point::new(f64::NAN, 0.0), BugParameters::default()).is_err());
    let mut bug = DistBug::new(Point::new(1.0, 0.0), BugParameters::default()).unwrap();
    let odometry = Pose::new(f64::NAN, 0.0, 0.0);
    let observation = LidarObservation { odometry, ..LidarObservation::default() };
    assert_eq!(bug.step(0.0, &observation).unwrap_err().kind(), ErrorKind::InvalidInput);
}

#[test]
fn nan_ranges_do_not_stop_the_run() {
    let (mut robot, _) = robot_in(room(), START, SimOptions::ideal());
    let mut scan = robot.scan().unwrap();
    scan.ranges.iter_mut().step_by(3).for_each(|range| *range = f64::NAN);
    let mut bug = DistBug::new(Point::new(1.0, 0.0), BugParameters::default()).unwrap();
    let observation = LidarObservation { scan, ..LidarObservation::default() };
    for _ in 0..50 {
        let decision = bug.step(0.0, &observation).unwrap();
        assert!(decision.continue_value().is_some_and(|twist| twist.is_finite()));
    }
}

#[test]
fn a_blind_lidar_and_a_stopped_clock_end_the_run_with_an_error() {
    let mut bug = DistBug::new(Point::new(1.0, 0.0), BugParameters::default()).unwrap();
    let (mut robot, _) = robot_in(room(), START, SimOptions::ideal());
    let mut scan = robot.scan().unwrap();
    scan.ranges.fill(f64::NAN);
    let observation = LidarObservation { scan, ..LidarObservation::default() };
    assert_eq!(
        bug.step(0.0, &observation).unwrap_err().to_string(),
        "lidar scan is NaN and NaN at beams 0 and 1; expected a distance at one of two neighbours at least"
    );

    let fault: Fault = "clock@2".parse().unwrap();
    let mut faulty = Faulty::new(robot, vec![fault]);
    let error = control::run(&mut faulty, &mut bug, 100.0, |_, _, _| {}).unwrap_err();
    assert_eq!(error.to_string(), "the robot's clock stands still");
}

/// For a small robot a cell behind a thin wall may be the nearest free one.
#[test]
fn a_place_behind_a_wall_is_not_the_nearest_one() {
    let footprint = Footprint::Disc { radius: 0.02 };
    for gap in [0.06, 0.07, 0.074, 0.078] {
        let mut world = World::walled(2.0, 1.0);
        for x in [1.0, 1.0 + gap] {
            world.walls.push(Wall::new(Point::new(x, 0.0), Point::new(x, 1.0)));
        }
        let goal = Point::new(1.0 + 0.5 * gap, 0.5);
        let parameters = NavigatorParameters::for_footprint(footprint);
        let navigator = Navigator::new(&world, Pose::new(0.3, 0.5, 0.0), goal, parameters).unwrap();
        assert_eq!(navigator.phase(), NavigatorPhase::Ended(NavigatorOutcome::Unreachable), "{gap}");
    }
}

mod campaigns {
    use super::*;
    use roverlab::geometry::direction;
    use roverlab::random::Stream;

    /// A closed cell with a corridor into it, both turned, and the goal in the cell.
    fn corridor(half_width: f64, heading: f64) -> (World, Point) {
        let (mut world, along) = (World::walled(3.0, 2.0), direction(heading));
        let across = Vector::new(-along.y, along.x);
        let goal = Point::new(1.5, 1.0);
        let side = [(-0.6, half_width), (-0.3, half_width), (-0.3, 0.3), (0.3, 0.3)];
        let corners = side.into_iter().chain(side.into_iter().rev().map(|(x, y)| (x, -y)));
        let corners: Vec<Point> = corners.map(|(x, y)| goal + along * x + across * y).collect();
        world.walls.extend(corners.windows(2).map(|ends| Wall::new(ends[0], ends[1])));
        (world, goal)
    }

    /// Whichever way a corridor runs, it is a way if the robot's disc has 4 mm to spare on either side, and
    /// none if it lacks any.
    #[test]
    #[ignore = "takes a minute: cargo test --release --all-features --test navigation -- --ignored"]
    fn corridors_are_ways_where_the_robot_fits() {
        let mut stream = Stream::new(1);
        for number in 0..1000 {
            let spare =
                if stream.chance(0.5) { stream.between(0.004, 0.02) } else { stream.between(-0.02, 0.0) };
            let heading = stream.between(-PI, PI);
            // The disc with its least clearance, and half of the wall.
            let (world, goal) = corridor(0.072 + 0.005 + spare, heading);
            let start = Pose::new(stream.between(0.2, 0.5), stream.between(0.2, 1.8), heading);
            let parameters = NavigatorParameters { match_scans: false, ..NavigatorParameters::default() };
            let mut navigator = Navigator::new(&world, start, goal, parameters).unwrap();
            let ended = navigator.phase() == NavigatorPhase::Ended(NavigatorOutcome::Unreachable);
            assert_eq!(ended, spare < 0.0, "{spare} m to spare at {heading}");
            if !ended && number % 10 == 0 {
                let (mut robot, truth) = robot_in(world, start, SimOptions::ideal());
                let outcome = control::run(&mut robot, &mut navigator, 120.0, |_, _, _| {}).unwrap();
                let contacts = truth.robot(0).unwrap().contacts;
                assert_eq!((outcome, contacts), (NavigatorOutcome::Reached, 0), "{spare} m at {heading}");
            }
        }
    }
}

/// Around a block on an open floor, four poses look alike, some of them beyond the floor's edge: a robot that
/// drives past it, and off the floor, never knows which of them is its own, and does not forget it either.
#[test]
fn a_pose_off_the_floor_is_not_forgotten() {
    let mut world = World::empty(4.0, 4.0);
    world.add_loop(&[(1.76, 2.76), (2.76, 2.76), (2.76, 3.76), (1.76, 3.76)].map(|(x, y)| Point::new(x, y)));
    let map = LocalisationMap::new(&world).unwrap();
    for (seed, start) in [(1.62, 1.09, 32.0), (1.86, 0.92, 109.0), (0.5, 2.0, -100.0), (3.6, 1.0, 60.0)]
        .map(|(x, y, heading)| Pose::new(x, y, units::from_deg(heading)))
        .into_iter()
        .enumerate()
    {
        for noise in [0.0, 1.0] {
            let scene = Scene::with_robot(world.clone(), RobotSpec::s4(), start);
            let simulation = Simulation::new(&scene, SimOptions::with_noise(noise, seed as u64)).unwrap();
            let mut robot = simulation.robot(0).unwrap();
            let mut localiser = Localiser::new(map.clone(), LocaliserParameters::default()).unwrap();
            for _ in 0..15 {
                let (odometry, scan) = (robot.pose().unwrap(), robot.scan().unwrap());
                localiser.update(odometry, &scan).unwrap();
                let truth = simulation.truth().robot(0).unwrap().pose;
                let is_true = |pose: Pose| pose.distance_to(truth.position()) < 0.15;
                let found = localiser.hypotheses();
                let wrong = format!("{start:?} {noise} at {truth:?}: {found:?}");
                assert!(!matches!(localiser.localisation(), Localisation::One(_)), "{wrong}");
                assert!(found.is_empty() || found.iter().any(|other| is_true(other.pose)), "{wrong}");
                robot.straight(0.2, 0.2).unwrap();
                robot.wait_done().unwrap();
            }
        }
    }
}
