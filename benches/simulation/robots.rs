//! Robots that drive: how much faster than real time a world runs.

use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput};
use roverlab::geometry::{Point, Pose, Twist, direction, math};
use roverlab::io::sim::{Fleet, SimOptions, SimRobot, Simulation, Truth};
use roverlab::io::{Clock, Drive, Lidar, LidarScan, LidarSettings, Odometry, Result};
use roverlab::race::{Cone, ConeColour, ConeTrack};
use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, Shape, World};
use roverlab_bench::fleet::{PERIOD, avoid, avoiders};
use roverlab_bench::{building, free_poses, thicket};

/// A robot that looks around with its lidar ten times a second.
struct Looker {
    robot: SimRobot,
    truth: Truth,
    scan: LidarScan,
}

impl Looker {
    fn new(world: World, noise: f64) -> Self {
        let pose = free_poses(&world, 1, 0.3, 5)[0];
        let scene = Scene::with_robot(world, RobotSpec::s4(), pose);
        let simulation = Simulation::new(&scene, SimOptions::with_noise(noise, 1)).expect("a good scene");
        let mut robot = simulation.robot(0).expect("the only robot");
        let settings = LidarSettings { field_of_view: PI, tilt: 0.0, points: 180 };
        robot.configure_lidar(settings).expect("an S4 has a lidar");
        Self { robot, truth: simulation.truth(), scan: LidarScan::default() }
    }

    /// One second: ten scans, ten commands, a hundred ticks.
    fn drive_a_second(&mut self) -> Result<()> {
        for _ in 0..10 {
            self.robot.scan_into(&mut self.scan)?;
            let ranges = &self.scan.ranges;
            let nearest = |beams: &[f64]| beams.iter().copied().fold(1.0, f64::min);
            let (right, ahead, left) =
                (nearest(&ranges[..70]), nearest(&ranges[70..110]), nearest(&ranges[110..]));
            self.robot.set_speed(avoid(ahead, left, right))?;
            self.robot.wait(PERIOD - 3e-4)?;
        }
        Ok(())
    }
}

/// Four walls and twenty discs.
fn discs() -> World {
    let mut world = World::walled(4.0, 4.0);
    let kind = ObjectKind::new("drum", Shape::Cylinder { radius: 0.1, height: 0.2 }, Colour::RED);
    let kind = Arc::new(kind);
    world.objects =
        free_poses(&world, 20, 0.3, 4).into_iter().map(|p| Object::new(Arc::clone(&kind), p)).collect();
    world
}

/// Seconds that pass in the world for one of ours, by the fastest of many slices: what else the machine does
/// counts as little as can be.
#[allow(clippy::disallowed_methods, reason = "a benchmark is about real time")]
pub(super) fn real_time_factor(slices: usize, seconds: f64, mut run: impl FnMut()) -> f64 {
    let times = (0..slices).map(|_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    });
    seconds / times.fold(f64::INFINITY, f64::min)
}

/// Checks that the robot gets about and hurts nobody, and that the same seed gives the same run.
fn check_looker(world: &World, noise: f64) -> f64 {
    let end = || {
        let mut looker = Looker::new(world.clone(), noise);
        (0..60).for_each(|_| looker.drive_a_second().expect("nothing fails"));
        looker.truth.robot(0).expect("the only robot")
    };
    let told = end();
    assert!(told.path_length > 3.0, "it drove {} m in a minute", told.path_length);
    assert!(told.contacts == 0 || noise > 0.0, "{} contacts", told.contacts);
    assert_eq!(told, end(), "the same seed");
    let mut looker = Looker::new(world.clone(), noise);
    real_time_factor(200, 5.0, || (0..5).for_each(|_| looker.drive_a_second().expect("nothing fails")))
}

/// One robot with a lidar of 180 beams: a second of its life.
pub(crate) fn one_robot(c: &mut Criterion) {
    let mut group = c.benchmark_group("a second of a robot with a lidar");
    for (name, world) in [("20 discs, 4 walls", discs()), ("600 walls", building(1))] {
        for noise in [0.0, 1.0] {
            let factor = check_looker(&world, noise);
            println!("one robot, {name}, noise {noise}: {factor:.0} times real time");
            let mut looker = Looker::new(world.clone(), noise);
            group.bench_function(BenchmarkId::new(name, format!("noise {noise}")), |b| {
                b.iter(|| looker.drive_a_second().expect("nothing fails"));
            });
        }
    }
    group.finish();
}

/// The ring that a racing car drives, and how fast.
const RING: f64 = 15.0;
const RACE_SPEED: f64 = 8.0;
/// Control steps of a race, each of five ticks.
const RACE_STEPS: u32 = 4000;

/// A racing car on the right of a ring of 120 cones, with noise.
fn race() -> Simulation {
    let cones = (0..60).flat_map(|i| {
        let outwards = direction(TAU * f64::from(i) / 60.0);
        [RING - 2.0, RING + 2.0].map(|radius| Point::new(0.0, RING) + outwards * radius)
    });
    let cones = cones.map(|place| Cone::new(place, ConeColour::Orange)).collect();
    let scene = ConeTrack { cones, ..ConeTrack::default() }.scene(&[Pose::default()]);
    Simulation::new(&scene, SimOptions::with_noise(1.0, 1)).expect("a good scene")
}

/// Drives along the ring by pure pursuit, twenty times a second, by odometry; if it looks, with a scan each
/// time.
fn drive_race(race: &Simulation, looks: bool) -> Result<()> {
    let (mut car, mut scan) = (race.robot(0)?, LidarScan::default());
    let begin = car.now()?;
    for step in 1..=RACE_STEPS {
        if looks {
            car.scan_into(&mut scan)?;
        }
        let (pose, speed) = (car.pose()?, car.speed()?);
        let along = math::atan2(pose.y - RING, pose.x);
        let local = pose.to_local(Point::new(0.0, RING) + direction(along + 4.0 / RING) * RING);
        let curvature = 2.0 * local.y / local.coords.norm_squared();
        car.set_speed(Twist::new(RACE_SPEED, speed.linear.max(2.0) * curvature))?;
        let next = begin + 0.05 * f64::from(step);
        let wait = next - car.now()?;
        car.wait(wait)?;
    }
    Ok(())
}

/// A race: 20,000 ticks of a car whose tyres slip, without and with 4,000 scans.
pub(crate) fn racing(c: &mut Criterion) {
    let mut group = c.benchmark_group("20,000 ticks of a race among 120 cones");
    group.sample_size(20);
    for (name, looks) in [("driven", false), ("driven and scanned", true)] {
        let end = || {
            let race = race();
            drive_race(&race, looks).expect("nothing fails");
            race.truth().robot(0).expect("the only car")
        };
        let told = end();
        assert!(told.path_length > 1400.0, "it drove {} m in 200 s", told.path_length);
        assert_eq!(told, end(), "the same seed");
        group.bench_function(name, |b| {
            let drive = |race: &mut Simulation| drive_race(race, looks).expect("nothing fails");
            b.iter_batched_ref(race, drive, BatchSize::PerIteration);
        });
    }
    group.finish();
}

pub(super) fn run(fleet: &mut Fleet<'_>, seconds: f64) {
    fleet.run_for(black_box(seconds)).expect("nothing fails");
}

/// Checks that most robots get about, and that two runs are the same.
fn check_fleet(world: &World, robots: usize) {
    let ends = || {
        let mut fleet = avoiders(world, robots);
        run(&mut fleet, 5.0);
        (0..robots).map(|robot| fleet.truth(robot).expect("a robot")).collect::<Vec<_>>()
    };
    let told = ends();
    let movers = told.iter().filter(|robot| robot.path_length > 0.3).count();
    assert!(movers * 10 > robots * 8, "{movers} of {robots} move");
    assert!(told == ends(), "the same seed");
}

/// A thousand robots at once: a second of their lives.
pub(crate) fn fleet(c: &mut Criterion) {
    let world = thicket(2000, 1);
    check_fleet(&world, 1000);
    let mut fleet = avoiders(&world, 1000);
    run(&mut fleet, 2.0);
    let factor = real_time_factor(200, PERIOD, || run(&mut fleet, PERIOD));
    println!("1000 robots with three PSDs, {} walls: {factor:.0} times real time", world.walls.len());
    let mut group = c.benchmark_group("a second of a fleet");
    group.sample_size(20);
    group.throughput(Throughput::Elements(1000));
    // A fleet of the same age each time: as it grows older, more of its robots rub along walls.
    let young = || {
        let mut fleet = avoiders(&world, 1000);
        run(&mut fleet, 2.0);
        fleet
    };
    group.bench_function("1000 robots, 2000 walls", |b| {
        b.iter_batched_ref(young, |fleet| run(fleet, 1.0), BatchSize::LargeInput);
    });
    run(&mut fleet, 600.0);
    let factor = real_time_factor(50, PERIOD, || run(&mut fleet, PERIOD));
    println!("the same after ten minutes: {factor:.0} times real time");
    group.finish();
}
