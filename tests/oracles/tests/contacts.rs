//! Robots that drive about are never inside of anything, as parry2d judges it.

use std::f64::consts::FRAC_PI_2;
use std::ops::ControlFlow;
use std::sync::Arc;

use parry2d_f64::math::{Pose as ParryPose, Vector as ParryVector};
use parry2d_f64::query::intersection_test;
use parry2d_f64::shape::{Ball, Cuboid, Shape as ParryShape};
use proptest::prelude::*;
use roverlab::geometry::{Aabb, Point, Pose, Twist, direction, math};
use roverlab::io::Drive;
use roverlab::io::sim::{Fleet, NoiseModel, SimOptions};
use roverlab::random::Stream;
use roverlab::world::{Footprint, RobotPlacement, RobotSpec, Scene, Shape};

#[path = "../../simulator/scenes.rs"]
mod scenes;

use scenes::{brick, cluttered, with_robots};

/// What a robot must not be in: walls, objects, other robots.
fn things(scene: &Scene, poses: &[Pose], except: usize) -> Vec<(ParryPose, Box<dyn ParryShape>)> {
    let walls = scene.world.walls.iter().map(|wall| {
        let along = wall.line.b - wall.line.a;
        let half = 0.5 * along.norm();
        let outline =
            Aabb::new(Point::new(-half, -0.5 * wall.thickness), Point::new(half, 0.5 * wall.thickness));
        let middle = wall.line.a + along * 0.5;
        placed(
            &Footprint::Rectangle(outline),
            &Pose::new(middle.x, middle.y, math::atan2(along.y, along.x)),
            0.0,
        )
    });
    let objects = scene.world.objects.iter().map(|object| {
        let outline = match object.kind.shape {
            Shape::Cylinder { radius, .. } | Shape::Sphere { radius } => Footprint::Disc { radius },
            Shape::Box { length, width, .. } => {
                let corner = Point::new(0.5 * length, 0.5 * width);
                Footprint::Rectangle(Aabb::new(-corner, corner))
            }
            _ => unreachable!("no other shape is placed here"),
        };
        placed(&outline, &object.pose, 0.0)
    });
    let others = poses.iter().enumerate().filter(|&(other, _)| other != except);
    let others = others.map(|(other, pose)| placed(&scene.robots[other].spec.footprint, pose, 0.0));
    walls.chain(objects).chain(others).collect()
}

/// An outline without a margin all around it.
fn placed(outline: &Footprint, pose: &Pose, margin: f64) -> (ParryPose, Box<dyn ParryShape>) {
    match outline {
        Footprint::Disc { radius } => {
            (ParryPose::new(ParryVector::new(pose.x, pose.y), 0.0), Box::new(Ball::new(radius - margin)))
        }
        Footprint::Rectangle(r) => {
            let middle = pose.to_world(r.min + r.size() * 0.5);
            let half = r.size() * 0.5;
            let half = ParryVector::new((half.x - margin).max(0.0), (half.y - margin).max(0.0));
            (ParryPose::new(ParryVector::new(middle.x, middle.y), pose.heading), Box::new(Cuboid::new(half)))
        }
        _ => unreachable!("no other outline is placed here"),
    }
}

/// Robots that drive about at random, with a new command every 0.1 s; checks after each that nobody is in
/// anything.
fn drive_about(scene: &Scene, seed: u64, noise: f64, seconds: f64) -> Result<u32, TestCaseError> {
    let options = SimOptions { seed, noise: NoiseModel::real().scaled(noise), ..SimOptions::default() };
    let mut fleet = Fleet::new(scene, options).unwrap();
    let robots = fleet.len();
    for robot in 0..robots {
        let mut stream = Stream::new(seed).child("driver", robot as u64);
        fleet
            .control(robot, 0.1, move |robot| {
                if stream.chance(0.2) {
                    robot.set_speed(Twist::new(stream.between(-0.8, 1.2), stream.between(-4.0, 4.0)))?;
                }
                Ok(ControlFlow::Continue(()))
            })
            .unwrap();
    }
    for _ in 0..(seconds / 0.03) as u32 {
        fleet.run_for(0.03).unwrap();
        let poses: Vec<Pose> = (0..robots).map(|robot| fleet.pose(robot).unwrap()).collect();
        for (robot, pose) in poses.iter().enumerate() {
            let (at, outline) = placed(&scene.robots[robot].spec.footprint, pose, 1e-5);
            for (number, (place, thing)) in things(scene, &poses, robot).iter().enumerate() {
                let inside = intersection_test(&at, &*outline, place, &**thing).unwrap().intersecting;
                prop_assert!(!inside, "robot {robot} at {pose:?} is in thing {number} at {} s", fleet.time());
            }
        }
    }
    Ok((0..robots).map(|robot| fleet.truth(robot).unwrap().contacts).sum())
}

/// Robots of both footprints in the free middle of a cluttered world.
fn crowd(world: u64) -> Scene {
    let mut scene = with_robots(cluttered(world), &RobotSpec::s4(), &[]);
    for number in 0..4 {
        let place = Point::new(1.2, 1.2) + direction(FRAC_PI_2 * f64::from(number)) * 0.17;
        let spec = if number % 2 == 0 { RobotSpec::s4() } else { brick() };
        scene
            .robots
            .push(RobotPlacement::new(Arc::new(spec), Pose::new(place.x, place.y, f64::from(number))));
    }
    scene
}

proptest! {
    #![proptest_config(roverlab::testing::cases(24))]

    #[test]
    fn nobody_is_ever_inside_anything(world in 0..1_000_000u64, seed: u64, noise in prop_oneof![Just(0.0), Just(1.0), 0.0..20.0f64]) {
        drive_about(&crowd(world), seed, noise, 12.0)?;
    }
}

#[test]
fn random_drives_do_touch_things() {
    let contacts = drive_about(&crowd(1), 1, 1.0, 20.0).unwrap();
    assert!(contacts > 10, "{contacts}");
}
