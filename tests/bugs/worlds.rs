//! Worlds of 3 m by 3 m, each with a start and a goal.

use std::f64::consts::{PI, TAU};

use roverlab::geometry::{Point, Pose, direction};
use roverlab::world::{Wall, World};

type Setting = (World, Pose, Point);

const START: Pose = Pose::new(0.4, 1.5, 0.7);
const GOAL: Point = Point::new(2.6, 1.4);

fn add_line(world: &mut World, points: &[(f64, f64)]) {
    let at = |(x, y): (f64, f64)| Point::new(x, y);
    world.walls.extend(points.windows(2).map(|ends| Wall::new(at(ends[0]), at(ends[1]))));
}

pub(crate) fn empty() -> Setting {
    (World::walled(3.0, 3.0), START, GOAL)
}

/// A convex obstacle on the way.
pub(crate) fn block() -> Setting {
    let mut world = World::walled(3.0, 3.0);
    world.add_loop(&[(1.2, 1.0), (1.8, 1.0), (1.8, 2.0), (1.2, 2.0)].map(|(x, y)| Point::new(x, y)));
    (world, START, GOAL)
}

/// A cup that opens towards the start.
pub(crate) fn dead_end() -> Setting {
    let mut world = World::walled(3.0, 3.0);
    add_line(&mut world, &[(1.0, 2.2), (1.8, 2.2), (1.8, 0.9), (0.8, 0.9)]);
    (world, START, GOAL)
}

/// A wall with a goal right behind it: from both sides it looks the same.
pub(crate) fn thin_wall() -> Setting {
    let mut world = World::walled(3.0, 3.0);
    add_line(&mut world, &[(1.5, 0.0), (1.5, 2.5)]);
    (world, START, Point::new(1.65, 1.3))
}

/// A start within one and a half turns of a spiral of walls.
pub(crate) fn spiral() -> Setting {
    let mut world = World::walled(3.0, 3.0);
    let arm: Vec<(f64, f64)> = (0..=36)
        .map(|i| {
            let turn = f64::from(i) / 24.0;
            let d = direction(TAU * turn) * (0.3 + 0.45 * turn);
            (1.4 + d.x, 1.5 + d.y)
        })
        .collect();
    add_line(&mut world, &arm);
    (world, Pose::new(1.4, 1.5, 0.0), Point::new(2.75, 2.6))
}

/// A goal in a closed ring.
pub(crate) fn ring() -> Setting {
    let mut world = World::walled(3.0, 3.0);
    let points: Vec<Point> = (0..24).map(|i| GOAL_IN + direction(PI * f64::from(i) / 12.0) * 0.4).collect();
    world.add_loop(&points);
    (world, START, GOAL_IN)
}

const GOAL_IN: Point = Point::new(1.9, 1.5);

/// A goal in a closed star of five points.
pub(crate) fn star() -> Setting {
    let mut world = World::walled(3.0, 3.0);
    let points: Vec<Point> = (0..10)
        .map(|i| GOAL_IN + direction(TAU * (f64::from(i) + 0.5) / 10.0) * if i % 2 == 0 { 0.8 } else { 0.25 })
        .collect();
    world.add_loop(&points);
    (world, START, GOAL_IN)
}

/// A start in a closed room, with a pillar on the way.
pub(crate) fn locked_in() -> Setting {
    let mut world = World::walled(3.0, 3.0);
    world.add_loop(&[(0.1, 0.6), (1.9, 0.6), (1.9, 2.3), (0.1, 2.3)].map(|(x, y)| Point::new(x, y)));
    world.add_loop(&[(0.8, 1.4), (1.0, 1.4), (1.0, 1.6), (0.8, 1.6)].map(|(x, y)| Point::new(x, y)));
    (world, START, GOAL)
}
