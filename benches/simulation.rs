//! The questions that a simulator asks a world, beside parry2d's answers to the same.

#[path = "simulation/craft.rs"]
mod craft;
#[path = "simulation/robots.rs"]
mod robots;

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use parry2d_f64::math::{Pose as ParryPose, Vector as ParryVector};
use parry2d_f64::query::{self, Ray as ParryRay, RayCast};
use parry2d_f64::shape::{Ball, Compound, Cuboid, Polyline, SharedShape};
use roverlab::geometry::{Point, Pose, Vector, direction, math};
use roverlab::random::Stream;
use roverlab::world::space::{Scanner, Solid, SolidId, Space, Span};
use roverlab::world::{Footprint, World};
use roverlab_bench::{building, free_poses};

const Z: f64 = 0.1;
const MAX_RANGE: f64 = 9.999;
const ROBOT: Footprint = Footprint::Disc { radius: 0.06 };
const ROBOT_SPAN: Span = Span { bottom: 0.0, top: 0.09 };

/// The walls as one body of parry's, under its tree.
fn parry_boxes(world: &World) -> Compound {
    let parts = world.walls.iter().map(|wall| {
        let along = wall.line.b - wall.line.a;
        let middle = wall.line.a + along * 0.5;
        let pose = ParryPose::new(ParryVector::new(middle.x, middle.y), math::atan2(along.y, along.x));
        let half = ParryVector::new(0.5 * along.norm(), 0.5 * wall.thickness);
        (pose, SharedShape::new(Cuboid::new(half)))
    });
    Compound::new(parts.collect())
}

/// The walls' outlines as line segments of parry's, under its tree.
fn parry_outlines(world: &World) -> Polyline {
    let mut vertices = Vec::new();
    let mut edges = Vec::new();
    for wall in &world.walls {
        let along = wall.line.b - wall.line.a;
        let across = Vector::new(-along.y, along.x) * (0.5 * wall.thickness / along.norm());
        let corners =
            [wall.line.a - across, wall.line.b - across, wall.line.b + across, wall.line.a + across];
        let first = vertices.len() as u32;
        vertices.extend(corners.map(|corner| ParryVector::new(corner.x, corner.y)));
        edges.extend((0..4).map(|i| [first + i, first + (i + 1) % 4]));
    }
    Polyline::new(vertices, Some(edges))
}

fn parry_cast(shape: &dyn RayCast, eye: Point, d: Vector) -> f64 {
    let ray = ParryRay::new(ParryVector::new(eye.x, eye.y), ParryVector::new(d.x, d.y));
    shape.cast_local_ray(&ray, MAX_RANGE, true).unwrap_or(f64::INFINITY)
}

/// Panics unless nearly all ranges agree; a beam that only just hits or misses an edge may differ.
fn check(what: &str, pairs: impl Iterator<Item = (f64, f64)>) {
    let (mut all, mut apart) = (0, 0);
    for (a, b) in pairs {
        all += 1;
        apart += usize::from(!(a == b || (a - b).abs() < 1e-9));
    }
    assert!(all > 0 && apart * 10_000 <= all, "{what}: {apart} of {all} ranges differ");
}

fn scans(c: &mut Criterion) {
    let world = building(1);
    let poses = free_poses(&world, 256, 0.1, 2);
    let space = Space::new(&world.walls);
    let mut scanner = Scanner::new(0.0, TAU / 360.0, 360, Z, 0.0, MAX_RANGE);
    let mut ranges = vec![0.0; 360];
    let beam = |pose: &Pose, i: usize| direction(pose.heading + TAU / 360.0 * i as f64);
    let (boxes, outlines) = (parry_boxes(&world), parry_outlines(&world));
    let peers: [(&str, &dyn RayCast); 2] = [("parry boxes", &boxes), ("parry outlines", &outlines)];
    for pose in &poses {
        space.scan(&mut scanner, pose, None, &mut ranges);
        let eye = pose.position();
        let all = || ranges.iter().enumerate();
        check("rays", all().map(|(i, &r)| (r, space.cast_ray(eye, beam(pose, i), Z, MAX_RANGE, None))));
        for (name, shape) in peers {
            check(name, all().map(|(i, &r)| (r, parry_cast(shape, eye, beam(pose, i)))));
        }
    }

    let mut group = c.benchmark_group("scan of 360 beams, 600 walls");
    group.throughput(Throughput::Elements(360));
    let mut next = poses.iter().cycle();
    group.bench_function("scan", |b| {
        b.iter(|| space.scan(&mut scanner, black_box(next.next().expect("endless")), None, &mut ranges));
    });
    group.bench_function("rays", |b| {
        b.iter(|| {
            let pose = next.next().expect("endless");
            (0..360)
                .map(|i| space.cast_ray(pose.position(), beam(pose, i), Z, MAX_RANGE, None))
                .fold(0.0, f64::max)
        });
    });
    for (name, shape) in peers {
        group.bench_function(name, |b| {
            b.iter(|| {
                let pose = next.next().expect("endless");
                (0..360).map(|i| parry_cast(shape, pose.position(), beam(pose, i))).fold(0.0, f64::max)
            });
        });
    }
    let mut tilted = Scanner::new(0.0, TAU / 360.0, 360, Z, -0.02, MAX_RANGE);
    group.bench_function("tilted scan", |b| {
        b.iter(|| space.scan(&mut tilted, black_box(next.next().expect("endless")), None, &mut ranges));
    });
    group.finish();
}

fn rays(c: &mut Criterion) {
    let world = building(1);
    let space = Space::new(&world.walls);
    let poses = free_poses(&world, 1024, 0.1, 3);
    let rays: Vec<(Point, Vector)> = poses.iter().map(|p| (p.position(), p.forward())).collect();
    let (boxes, outlines) = (parry_boxes(&world), parry_outlines(&world));
    let peers: [(&str, &dyn RayCast); 2] = [("parry boxes", &boxes), ("parry outlines", &outlines)];
    for (name, shape) in peers {
        let ours = |&(eye, d): &(Point, Vector)| space.cast_ray(eye, d, Z, MAX_RANGE, None);
        check(name, rays.iter().map(|ray| (ours(ray), parry_cast(shape, ray.0, ray.1))));
    }
    let mut group = c.benchmark_group("one ray, 600 walls");
    group.throughput(Throughput::Elements(1));
    let mut next = rays.iter().cycle();
    group.bench_function("cast_ray", |b| {
        b.iter(|| {
            let &(eye, d) = next.next().expect("endless");
            space.cast_ray(eye, d, Z, MAX_RANGE, None)
        });
    });
    for (name, shape) in peers {
        group.bench_function(name, |b| {
            b.iter(|| {
                let &(eye, d) = next.next().expect("endless");
                parry_cast(shape, eye, d)
            });
        });
    }
    group.finish();
}

fn discs(c: &mut Criterion) {
    let world = World::walled(4.0, 4.0);
    let mut space = Space::new(&world.walls);
    for pose in free_poses(&world, 20, 0.2, 4) {
        space.add(Solid::new(Footprint::Disc { radius: 0.1 }, pose, 0.0, 0.2));
    }
    let alone = |pose: &Pose| space.clearance(&ROBOT, pose, ROBOT_SPAN, 1.0, None) > 0.0;
    let poses: Vec<Pose> = free_poses(&world, 256, 0.1, 5).into_iter().filter(alone).collect();
    let increment = TAU / 360.0;
    let mut scanner = Scanner::new(-0.25 * TAU, increment, 180, Z, 0.0, MAX_RANGE);
    let mut ranges = vec![0.0; 180];
    for pose in &poses {
        space.scan(&mut scanner, pose, None, &mut ranges);
        let ray = |i: usize| {
            let d = direction(pose.heading - 0.25 * TAU + increment * i as f64);
            space.cast_ray(pose.position(), d, Z, MAX_RANGE, None)
        };
        check("rays", ranges.iter().enumerate().map(|(i, &range)| (range, ray(i))));
    }
    let mut group = c.benchmark_group("scan of 180 beams, 20 discs, 4 walls");
    group.throughput(Throughput::Elements(180));
    let mut next = poses.iter().cycle();
    group.bench_function("scan", |b| {
        b.iter(|| space.scan(&mut scanner, black_box(next.next().expect("endless")), None, &mut ranges));
    });
    group.finish();
}

/// A crowd of robots among the walls of a world.
fn crowd(world: &World, robots: usize) -> (Space, Vec<(SolidId, Pose)>) {
    let mut space = Space::new(&world.walls);
    let poses = free_poses(world, robots, 0.07, 6);
    let add = |pose: Pose| (space.add(Solid::new(ROBOT, pose, 0.0, 0.09)), pose);
    let robots = poses.into_iter().map(add).collect();
    (space, robots)
}

fn contacts(c: &mut Criterion) {
    let world = building(1);
    let boxes = parry_boxes(&world);
    let parry_distance = |pose: &Pose| {
        let (at, robot) = (ParryPose::new(ParryVector::new(pose.x, pose.y), 0.0), Ball::new(0.06));
        let distance = query::distance(&at, &robot, &ParryPose::IDENTITY, &boxes);
        distance.expect("parry knows these shapes").distance
    };
    let mut group = c.benchmark_group("600 walls, robots");
    for robots in [10, 1_000, 10_000] {
        let (mut space, placed) = crowd(&world, robots);
        let mut out = Vec::new();
        let mut poses = free_poses(&world, 4096, 0.2, 7);
        poses.retain(|pose| space.clearance(&ROBOT, pose, ROBOT_SPAN, 0.05, None) >= 0.05);
        for pose in &poses {
            space.contacts(&ROBOT, pose, ROBOT_SPAN, None, &mut out);
            assert!(out.is_empty());
            let clearance = space.walls_clearance(&ROBOT, pose, ROBOT_SPAN, 0.5);
            assert!((clearance - parry_distance(pose).min(0.5)).abs() < 1e-9);
        }
        group.throughput(Throughput::Elements(1));
        let mut next = poses.iter().cycle();
        group.bench_function(BenchmarkId::new("contacts of a disc, nothing near", robots), |b| {
            b.iter(|| {
                let pose = next.next().expect("endless");
                space.contacts(&ROBOT, pose, ROBOT_SPAN, None, &mut out);
                out.len()
            });
        });
        group.bench_function(BenchmarkId::new("clearance of a disc up to 0.05 m", robots), |b| {
            b.iter(|| space.clearance(&ROBOT, next.next().expect("endless"), ROBOT_SPAN, 0.05, None));
        });
        group.bench_function(BenchmarkId::new("walls_clearance up to 0.5 m", robots), |b| {
            b.iter(|| space.walls_clearance(&ROBOT, next.next().expect("endless"), ROBOT_SPAN, 0.5));
        });
        group.bench_function(BenchmarkId::new("parry distance to walls", robots), |b| {
            b.iter(|| parry_distance(next.next().expect("endless")));
        });
        set_pose(&mut group, &mut space, &placed);
        crowded_scan(&mut group, &space, &placed);
    }
    group.finish();
}

fn set_pose(group: &mut BenchmarkGroup<'_, WallTime>, space: &mut Space, placed: &[(SolidId, Pose)]) {
    let mut step = 0.0001;
    for &(id, pose) in placed {
        space.set_pose(id, Pose::new(pose.x + step, pose.y, pose.heading));
        let there = space.cast_ray(Point::new(pose.x + step, pose.y + 0.05), Vector::x(), 0.05, 1.0, None);
        assert_eq!(there, 0.0, "a robot is where it was put");
    }
    let mut next = placed.iter().cycle();
    group.bench_function(BenchmarkId::new("set_pose by 0.1 mm", placed.len()), |b| {
        b.iter(|| {
            let &(id, pose) = next.next().expect("endless");
            step = -step;
            space.set_pose(id, Pose::new(pose.x + step, pose.y, pose.heading));
        });
    });
}

fn crowded_scan(group: &mut BenchmarkGroup<'_, WallTime>, space: &Space, placed: &[(SolidId, Pose)]) {
    let z = 0.05;
    let mut scanner = Scanner::new(0.0, TAU / 360.0, 360, z, 0.0, MAX_RANGE);
    let mut ranges = vec![0.0; 360];
    for &(id, pose) in placed.iter().take(100) {
        space.scan(&mut scanner, &pose, Some(id), &mut ranges);
        let ray = |i: usize| {
            let d = direction(pose.heading + TAU / 360.0 * i as f64);
            space.cast_ray(pose.position(), d, z, MAX_RANGE, Some(id))
        };
        check("rays", ranges.iter().enumerate().map(|(i, &range)| (range, ray(i))));
    }
    group.throughput(Throughput::Elements(360));
    let mut next = placed.iter().cycle();
    group.bench_function(BenchmarkId::new("scan of 360 beams", placed.len()), |b| {
        b.iter(|| {
            let (id, pose) = next.next().expect("endless");
            space.scan(&mut scanner, pose, Some(*id), &mut ranges);
        });
    });
}

fn building_time(c: &mut Criterion) {
    let mut group = c.benchmark_group("making a space");
    let mut stream = Stream::new(8);
    for walls in [600, 20_000] {
        let world = building(1);
        let many: Vec<_> = (0..walls)
            .map(|i| {
                let mut wall = world.walls[i % world.walls.len()];
                let away = Vector::new(stream.between(0.0, 150.0), stream.between(0.0, 150.0));
                wall.line.a += away;
                wall.line.b += away;
                wall
            })
            .collect();
        let space = Space::new(&many);
        for wall in &many {
            let middle = wall.line.a + (wall.line.b - wall.line.a) * 0.5;
            assert_eq!(
                space.cast_ray(middle, Vector::x(), Z, 1.0, None),
                0.0,
                "every wall is where it was put"
            );
        }
        group.throughput(Throughput::Elements(walls as u64));
        group.bench_with_input(BenchmarkId::new("walls", walls), &walls, |b, _| b.iter(|| Space::new(&many)));
    }
    group.finish();
}

criterion_group!(
    benches,
    scans,
    rays,
    discs,
    contacts,
    building_time,
    robots::one_robot,
    robots::racing,
    craft::one_craft,
    craft::craft_fleet,
    robots::fleet
);
criterion_main!(benches);
