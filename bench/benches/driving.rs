//! A step of each behaviour that drives from A to B.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use roverlab::drive::{
    AToB, AToBObservation, AToBParameters, CarDriver, CarParameters, CarToB, Chase, ChaseParameters,
    FollowerParameters, Goal, Method, OmniDriver, OmniParameters, OmniTracker, Path, PathFollower, Pid,
    PidParameters,
};
use roverlab::geometry::{Point, Pose};
use roverlab::kinematics::{
    Ackermann, Differential, Displacement, OdometryErrors, OdometryUncertainty, Omni, PlanarTwist,
};

const GOAL: Pose = Pose::new(1.45, 0.65, 0.0);

/// Planning a spline, and a step along it.
fn paths(c: &mut Criterion) {
    let plan = || Path::hermite(Pose::default(), GOAL, 1.0).expect("a path");
    assert!(plan().end().distance_to(GOAL.position()) < 1e-9, "a spline ends at its goal");
    c.bench_function("spline of 1.6 m: plan", |b| b.iter(plan));
    let round = || Path::dubins(Pose::default(), GOAL, 0.5).expect("a path");
    assert!(round().end().distance_to(GOAL.position()) < 1e-6, "a Dubins path ends at its goal");
    c.bench_function("Dubins path of 1.6 m: plan", |b| b.iter(round));
    let follower = PathFollower::new(plan(), FollowerParameters::default()).expect("a follower");
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
        let start = AToBObservation { pose: Pose::default(), done: true };
        drive.step(&start).expect("a command");
        group.bench_function(format!("{method:?}"), |b| {
            b.iter(|| {
                drive.step(black_box(&AToBObservation { pose: Pose::new(0.1, 0.01, 0.1), done: true }))
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
    let driver = CarDriver { kinematics, full_speed: 0.5 };
    let goal = Goal::pose(Pose::new(2.0, 1.0, 1.0));
    let mut car = CarToB::new(Method::Spline, goal, driver, CarParameters::default()).expect("a behaviour");
    (0..200).for_each(|_| assert!(car.step(Pose::default()).expect("a command").is_some()));
    c.bench_function("car: step", |b| b.iter(|| car.step(black_box(Pose::new(0.1, 0.0, 0.0)))));

    let omni = OmniDriver { kinematics: Omni::mecanum(0.18, 0.16).expect("a drive"), full_speed: 0.47 };
    let twist = PlanarTwist::new(0.1, -0.2, 0.5);
    let back = omni.kinematics.forward(omni.kinematics.inverse(twist));
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

criterion_group!(benches, paths, methods, others);
criterion_main!(benches);
