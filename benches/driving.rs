//! A step of each driving behaviour, and what is made of a scan of 360 beams.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use roverlab::drive::{
    AToB, AToBObservation, AToBParameters, CarDriver, CarToB, CarToBParameters, Chase, ChaseParameters,
    CoverageMap, CoverageMapParameters, CoveragePlan, Cruise, CruiseParameters, Follower,
    FollowerObservation, FollowerParameters, Formation, Goal, LidarWallFollower, LidarWallFollowerParameters,
    Method, OmniDriver, OmniParameters, OmniTracker, Path, PathFollower, PathFollowerParameters, Pid,
    PidParameters, PidWallFollower, PidWallFollowerParameters, RandomDrive, RandomDriveParameters, Tour,
    TourParameters, TwoLevelWallFollower, WallFollower, WallFollowerParameters, WallObservation, WallPhase,
    WallSide, robots_in,
};
use roverlab::geometry::{Point, Pose};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Lidar, LidarScan};
use roverlab::kinematics::{
    Ackermann, Differential, Displacement, OdometryErrors, OdometryUncertainty, Omni, PlanarTwist,
};
use roverlab::random::Stream;
use roverlab::scan::{
    Localisation, LocalisationMap, Localiser, LocaliserParameters, ScanFeaturesParameters, extract_features,
    local_extrema,
};
use roverlab::world::{RobotSpec, Scene, Wall, World};

const GOAL: Pose = Pose::new(1.45, 0.65, 0.0);

/// Planning a spline, and a step along it.
fn paths(c: &mut Criterion) {
    let plan = || Path::hermite(Pose::default(), GOAL, 1.0).expect("a path");
    assert!(plan().end().distance_to(GOAL.position()) < 1e-9, "a spline ends at its goal");
    c.bench_function("spline of 1.6 m: plan", |b| b.iter(plan));
    let round = || Path::dubins(Pose::default(), GOAL, 0.5).expect("a path");
    assert!(round().end().distance_to(GOAL.position()) < 1e-6, "a Dubins path ends at its goal");
    c.bench_function("Dubins path of 1.6 m: plan", |b| b.iter(round));
    let follower = PathFollower::new(plan(), PathFollowerParameters::default()).expect("a follower");
    let middle = plan().at(0.8).pose;
    c.bench_function("path follower: step", |b| {
        let mut follower = follower.clone();
        b.iter(|| follower.step(black_box(middle)));
    });
}

/// A step of each method.
fn methods(c: &mut Criterion) {
    let mut group = c.benchmark_group("step");
    for method in [Method::Turn, Method::Arc, Method::Dog, Method::Spline] {
        let mut drive = AToB::new(method, Goal::pose(GOAL), AToBParameters::default()).expect("a behaviour");
        let start = AToBObservation { pose: Pose::default(), done: true, stalled: false };
        drive.step(&start).expect("a command");
        group.bench_function(format!("{method:?}"), |b| {
            b.iter(|| {
                drive.step(black_box(&AToBObservation {
                    pose: Pose::new(0.1, 0.01, 0.1),
                    done: true,
                    stalled: false,
                }))
            });
        });
        let mut chase = Chase::new(method, ChaseParameters::default()).expect("a chase");
        group.bench_function(format!("{method:?}, moving goal"), |b| b.iter(|| chase.step(black_box(GOAL))));
    }
    group.finish();
}

/// Cars, wheels with rollers, a PID controller, and the covariance of odometry.
fn others(c: &mut Criterion) {
    let kinematics = Ackermann::new(0.26, 0.16, 0.5).expect("a car");
    let driver = CarDriver::new(kinematics, 0.5).expect("a driver");
    let goal = Goal::pose(Pose::new(2.0, 1.0, 1.0));
    let mut car =
        CarToB::new(Method::Spline, goal, driver, CarToBParameters::default()).expect("a behaviour");
    (0..200).for_each(|_| assert!(car.step(Pose::default()).expect("a command").is_some()));
    c.bench_function("car: step", |b| b.iter(|| car.step(black_box(Pose::new(0.1, 0.0, 0.0)))));

    let omni = OmniDriver::new(Omni::mecanum(0.18, 0.16).expect("a drive"), 0.47).expect("a driver");
    let twist = PlanarTwist::new(0.1, -0.2, 0.5);
    let back = omni.kinematics().forward(omni.kinematics().inverse(twist));
    assert!((back.left - twist.left).abs() < 1e-12, "forward undoes inverse");
    c.bench_function("omni: motors for a twist", |b| b.iter(|| omni.command(black_box(twist))));
    let route = [Point::new(1.0, 0.0), Point::new(1.0, 1.0)];
    let tracker = OmniTracker::new(Pose::default(), &route, OmniParameters::default()).expect("a tracker");
    c.bench_function("omni: step", |b| b.iter(|| tracker.step(black_box(3.0), Pose::new(0.5, 0.0, 0.0))));

    let mut pid = Pid::new(PidParameters { integral: 0.5, derivative: 0.1, ..PidParameters::default() })
        .expect("gains");
    c.bench_function("PID: step", |b| b.iter(|| pid.step(1.0, black_box(0.9), 0.01)));
    let errors = OdometryErrors { wheel_scale: 0.01, wheel_mismatch: 0.0003, track: 0.003, slip: 0.0005 };
    let start = OdometryUncertainty::new(Pose::default(), Differential { track: 0.09 }, errors);
    c.bench_function("odometry with covariance: step", |b| {
        let mut odometry = start;
        b.iter(|| odometry.advance(black_box(Displacement { length: 0.002, angle: 0.001 })));
    });
}

/// Following walls, driving at random, covering a floor, following robots.
fn behaviours(c: &mut Criterion) {
    let mut wall = WallFollower::new(WallFollowerParameters {
        side: Some(WallSide::Left),
        ..WallFollowerParameters::default()
    })
    .expect("a follower");
    // A wall to the left that it comes nearer to, and follows.
    let seen =
        |x: f64, left: f64| WallObservation { pose: Pose::new(x, 0.0, 0.0), front: 3.0, left, right: 2.0 };
    (0..100).for_each(|k| {
        wall.step(&seen(0.002 * f64::from(k), 0.155 - 0.0004 * f64::from(k))).expect("a speed");
    });
    assert_eq!(wall.phase(), WallPhase::Following);
    c.bench_function("wall following, distance sensors: step", |b| {
        b.iter(|| wall.step(black_box(&seen(0.2, 0.115))));
    });
    let mut pid = PidWallFollower::new(PidWallFollowerParameters::default()).expect("a follower");
    c.bench_function("wall following, PID: step", |b| {
        b.iter(|| pid.step(black_box(&seen(0.2, 0.155)), 0.02));
    });
    let mut book = TwoLevelWallFollower::default();
    c.bench_function("wall following, the book: step", |b| {
        b.iter(|| book.step(black_box(&seen(0.2, 0.155))));
    });

    let (world, scan) = (room(), scan(1.0));
    let mut lidar = LidarWallFollower::new(LidarWallFollowerParameters::default()).expect("a follower");
    c.bench_function("wall following, lidar: step", |b| b.iter(|| lidar.step(black_box(&scan))));
    let points: Vec<Point> = scan.points().collect();
    let mut random = RandomDrive::new(RandomDriveParameters::default(), Stream::new(1)).expect("a drive");
    c.bench_function("random drive: step", |b| b.iter(|| random.step(black_box(PLACE), &points)));
    let mut cruise = Cruise::new(vec![Point::new(3.0, 0.0)], CruiseParameters::default()).expect("a cruise");
    c.bench_function("leader: step", |b| b.iter(|| cruise.step(black_box(Pose::default()), &points)));
    let mut follower = Follower::new(FollowerParameters::default()).expect("a follower");
    c.bench_function("follow me, robots in the scan included: step", |b| {
        b.iter(|| {
            let candidates = robots_in(black_box(&scan), 0.06);
            let pose = Pose::default();
            follower.step(&FollowerObservation {
                time: 0.0,
                pose,
                candidates: &candidates,
                obstacles: &points,
            })
        });
    });
    let formation = Formation::at(Point::new(-0.5, 0.3));
    c.bench_function("formation: step", |b| {
        b.iter(|| formation.step(black_box(Pose::default()), Pose::new(0.6, -0.3, 0.1), 0.15, &points));
    });

    let map = CoverageMap::new(&world, PLACE.position(), CoverageMapParameters::default()).expect("a map");
    let plan = CoveragePlan::new(&map, PLACE.position()).expect("a plan");
    assert!(plan.share() > 0.94, "the plan covers the floor");
    let mut tour = Tour::new(plan.points(), TourParameters::default()).expect("a tour");
    c.bench_function("coverage: step", |b| b.iter(|| tour.step(black_box(PLACE))));
    let mut group = c.benchmark_group("planning");
    group.sample_size(10);
    group.bench_function("coverage of 4 square metres", |b| {
        b.iter(|| CoveragePlan::new(&map, PLACE.position()));
    });
    group.finish();
}

const PLACE: Pose = Pose::new(0.5, 0.6, 0.4);

/// A room of 2.4 m by 1.8 m that looks the same from nowhere else.
fn room() -> World {
    let mut world = World::walled(2.4, 1.8);
    world.walls.push(Wall::new(Point::new(0.0, 1.1), Point::new(0.7, 1.1)));
    world
}

/// A scan of 360 beams from a place in that room.
fn scan(noise: f64) -> LidarScan {
    let scene = Scene::with_robot(room(), RobotSpec::s4(), PLACE);
    let simulation = Simulation::new(&scene, SimOptions::with_noise(noise, 1)).expect("a simulation");
    simulation.robot(0).expect("a robot").scan().expect("a scan")
}

/// What is made of a scan.
fn scans(c: &mut Criterion) {
    let scan = scan(1.0);
    assert_eq!(scan.ranges.len(), 360);
    let parameters = ScanFeaturesParameters::default();
    let features = extract_features(&scan, &parameters).expect("features");
    assert!(features.walls.len() >= 5, "the walls are found");
    c.bench_function("360 beams: walls, corners, objects", |b| {
        b.iter(|| extract_features(black_box(&scan), &parameters));
    });
    c.bench_function("360 beams: peaks and dips", |b| b.iter(|| local_extrema(black_box(&scan), 5, 0.08)));

    let map = LocalisationMap::new(&room()).expect("a map");
    let mut localiser = Localiser::new(map, LocaliserParameters::default()).expect("a localiser");
    let nobody = localiser.clone();
    for _ in 0..3 {
        localiser.update(Pose::default(), &scan).expect("an update");
    }
    let Localisation::One(best) = localiser.localisation() else { panic!("the robot is found") };
    assert!(best.pose.distance_to(PLACE.position()) < 0.02, "in the right place");
    c.bench_function("360 beams: localisation, one place", |b| {
        b.iter(|| localiser.update(black_box(Pose::default()), &scan));
    });
    let mut group = c.benchmark_group("search");
    group.sample_size(10);
    group.bench_function("360 beams: localisation, all places", |b| {
        b.iter(|| nobody.clone().update(black_box(Pose::default()), &scan));
    });
    group.finish();
}

criterion_group!(benches, paths, methods, others, behaviours, scans);
criterion_main!(benches);
