//! Rays against hills, beside parry3d's answers to the same; a tracked robot on hills, its camera, and plans.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::query::{Ray as ParryRay, RayCast};
use parry3d_f64::shape::{HeightField as ParryField, HeightFieldCellStatus};
use parry3d_f64::utils::Array2;
use roverlab::geometry::{Aabb, Point, Point3, Pose, Twist, Vector, Vector3, math};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Camera, Clock, DistanceSensors, Drive, Lidar, LidarScan, Psd, Resolution};
use roverlab::nav::elevation::{Climber, ElevationMap, ElevationPlanner, Objective};
use roverlab::random::Stream;
use roverlab::world::{HeightField, RobotSpec, Scene, Terrain, World};

const SIDE: f64 = 5.0;
const TOP: f64 = 0.5;
const MAX_RANGE: f64 = 9.999;
const COMPARED: usize = 1_000_000;
/// Rays of one timed round.
const TIMED: usize = 4096;

/// Smooth hills of `samples` each way: waves of many lengths.
fn hills(samples: usize) -> HeightField {
    let mut stream = Stream::new(1);
    let waves: Vec<(Vector, f64, f64)> = (0..24)
        .map(|_| {
            let wave = Vector::new(stream.between(-6.0, 6.0), stream.between(-6.0, 6.0));
            (wave, stream.between(0.0, std::f64::consts::TAU), 1.0 / (1.0 + wave.norm()))
        })
        .collect();
    let total: f64 = waves.iter().map(|(_, _, size)| size).sum();
    let height = |at: Point| {
        let sum: f64 =
            waves.iter().map(|(wave, phase, size)| size * math::sin(wave.dot(&at.coords) + phase)).sum();
        0.5 * TOP * (1.0 + sum / total)
    };
    let area = Aabb::new(Point::origin(), Point::new(SIDE, SIDE));
    HeightField::from_fn(samples, samples, area, height).expect("a good field")
}

/// The same triangles of parry's: its y is up, and its rows go along z.
fn parry_field(field: &HeightField) -> ParryField {
    let (rows, columns) = (field.rows(), field.columns());
    let mut heights = Array2::repeat(rows, columns, 0.0);
    for row in 0..rows {
        for column in 0..columns {
            heights[(row, column)] = field.sample(column, row);
        }
    }
    let mut parry = ParryField::new(heights, ParryVector::new(SIDE, 1.0, SIDE));
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            parry.set_cell_status(row, column, HeightFieldCellStatus::ZIGZAG_SUBDIVISION);
        }
    }
    parry
}

fn parry_cast(field: &ParryField, origin: Point3, direction: Vector3) -> f64 {
    let from = ParryVector::new(origin.x - 0.5 * SIDE, origin.z, origin.y - 0.5 * SIDE);
    let ray = ParryRay::new(from, ParryVector::new(direction.x, direction.z, direction.y));
    field.cast_local_ray(&ray, MAX_RANGE, false).unwrap_or(f64::INFINITY)
}

/// A ray in any direction from anywhere over, under or beside the hills.
fn any_ray(stream: &mut Stream) -> (Point3, Vector3) {
    let mut part = |low, high| stream.between(low, high);
    let origin = Point3::new(part(-1.0, 6.0), part(-1.0, 6.0), part(-0.5, 1.5));
    let direction = Vector3::new(part(-1.0, 1.0), part(-1.0, 1.0), part(-0.5, 0.5));
    (origin, direction.try_normalize(1e-3).unwrap_or(Vector3::x()))
}

/// A ray of a sensor: 60 mm above the ground, at most 20 degrees up or down.
fn sensor_ray(field: &HeightField, stream: &mut Stream) -> (Point3, Vector3) {
    let at = Point::new(stream.between(0.1, 4.9), stream.between(0.1, 4.9));
    let height = field.height(at).expect("a place on the hills") + 0.06;
    let (yaw, pitch) = (stream.between(-3.1, 3.1), stream.between(-0.35, 0.35));
    let ((sy, cy), (sp, cp)) = (math::sin_cos(yaw), math::sin_cos(pitch));
    (Point3::new(at.x, at.y, height), Vector3::new(cp * cy, cp * sy, sp))
}

/// Whether a hit is on the surface, and the ray does not cross it before: what to believe where two differ.
fn is_first_hit(field: &HeightField, origin: Point3, direction: Vector3, range: f64) -> bool {
    let above = |t: f64| {
        let at = origin + direction * t;
        field.height(at.xy()).map(|height| at.z - height)
    };
    let on_surface = range.is_infinite() || above(range).is_none_or(|z| z.abs() < 1e-6);
    let until = range.min(MAX_RANGE) - 1e-6;
    let sides = (0..4000).filter_map(|i| above(until * f64::from(i) / 4000.0));
    let mut signs = sides.map(|z| z > 0.0);
    let first = signs.next();
    on_surface && first.is_none_or(|first| signs.all(|sign| sign == first))
}

/// Panics unless both find the same; on an edge of the field or of two triangles parry may lose a ray.
fn check(field: &HeightField, parry: &ParryField) {
    let mut stream = Stream::new(2);
    let (mut hits, mut lost) = (0, 0);
    for number in 0..COMPARED {
        let (origin, direction) =
            if number % 2 == 0 { any_ray(&mut stream) } else { sensor_ray(field, &mut stream) };
        let ours = field.cast_ray(origin, direction, MAX_RANGE);
        let theirs = parry_cast(parry, origin, direction);
        hits += usize::from(ours.is_finite());
        if !(ours == theirs || (ours - theirs).abs() < 1e-6) {
            lost += 1;
            assert!(is_first_hit(field, origin, direction, ours), "{origin} {direction}: {ours} {theirs}");
            assert!(ours < theirs, "{origin} {direction}: {ours} {theirs}");
        }
    }
    println!("{COMPARED} rays, {hits} hits: {lost} that parry loses, all others equal within 1e-6 m");
    assert!(lost * 100_000 <= COMPARED);
}

fn rays(c: &mut Criterion) {
    let field = hills(512);
    let parry = parry_field(&field);
    check(&field, &parry);
    let mut stream = Stream::new(3);
    let sensors: Vec<_> = (0..TIMED).map(|_| sensor_ray(&field, &mut stream)).collect();
    let any: Vec<_> = (0..TIMED).map(|_| any_ray(&mut stream)).collect();
    for (name, rays) in [("terrain rays of sensors", sensors), ("terrain rays from anywhere", any)] {
        let mut group = c.benchmark_group(name);
        group.throughput(Throughput::Elements(TIMED as u64));
        group.bench_function("roverlab", |b| {
            b.iter(|| rays.iter().map(|&(o, d)| black_box(field.cast_ray(o, d, MAX_RANGE))).sum::<f64>());
        });
        group.bench_function("parry", |b| {
            b.iter(|| rays.iter().map(|&(o, d)| black_box(parry_cast(&parry, o, d))).sum::<f64>());
        });
        group.finish();
    }
}

/// A tracked robot on a field of 512 by 512 samples.
fn simulation() -> Simulation {
    let terrain = Terrain::new("hills.png", hills(512));
    let world = World { terrain: Some(terrain), ..World::empty(SIDE, SIDE) };
    let scene = Scene::with_robot(world, RobotSpec::blizzard(), Pose::new(2.5, 2.5, 0.6));
    Simulation::new(&scene, SimOptions::ideal()).expect("a good scene")
}

/// Ten seconds of driving, to and fro, from one start, with four PSDs at 10 Hz, and a lidar of 360 beams.
fn driving(c: &mut Criterion) {
    for (name, lidar) in [("terrain drive 10 s, 4 PSDs", false), ("terrain drive 10 s, 360 beams", true)] {
        let simulation = simulation();
        let (mut robot, mut scan) = (simulation.robot(0).expect("the robot"), LidarScan::default());
        let start = simulation.truth().pose(0).expect("a pose");
        c.bench_function(name, |b| {
            b.iter(|| {
                simulation.truth().set_pose(0, start).expect("a place");
                for step in 0..100 {
                    let speed = if step < 50 { 0.2 } else { -0.2 };
                    robot.set_speed(Twist::new(speed, 0.1)).expect("a drive");
                    for psd in [Psd::FRONT, Psd::LEFT, Psd::RIGHT, Psd::BACK] {
                        black_box(robot.distance(psd).expect("a distance"));
                    }
                    if lidar {
                        robot.scan_into(&mut scan).expect("a scan");
                    }
                    robot.wait(0.1).expect("time");
                }
            });
        });
        assert_eq!(simulation.truth().mishap(0).expect("a robot"), None);
    }
}

/// An image of QVGA, and the tenth of a second to the next.
fn camera(c: &mut Criterion) {
    let mut robot = simulation().robot(0).expect("the robot");
    robot.set_resolution(Resolution::Qvga).expect("a camera");
    robot.set_speed(Twist::new(0.0, 0.5)).expect("a drive");
    let mut image = robot.image().expect("an image");
    c.bench_function("terrain image, QVGA", |b| {
        b.iter(|| {
            robot.wait(0.1).expect("time");
            robot.image_into(&mut image).expect("an image");
        });
    });
}

/// Plans from corner to corner of 512 x 512 samples.
fn planning(c: &mut Criterion) {
    let map = ElevationMap::new(&hills(512), &Climber::of(&RobotSpec::blizzard())).expect("hills");
    let (start, goal) = (Point::new(0.3, 0.3), Point::new(SIDE - 0.3, SIDE - 0.3));
    let mut group = c.benchmark_group("plans on 512 x 512");
    for (name, objective) in [
        ("length", Objective::Length),
        ("energy", Objective::Energy { resistance: 0.1 }),
        ("time", Objective::Time { speed: 0.3, climb: 0.05 }),
    ] {
        let mut planner = ElevationPlanner::astar(&map, objective).expect("a good objective");
        planner.plan(start, goal).expect("a way");
        group.bench_function(name, |b| b.iter(|| planner.plan(black_box(start), goal)));
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = rays, driving, camera, planning
}
criterion_main!(benches);
