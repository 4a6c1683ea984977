//! Reactive navigation to a goal: the bug family.

use roverlab::geometry::{Point, Pose};
use roverlab::io::Result;
use roverlab::io::control::run;
use roverlab::io::sim::SimOptions;
use roverlab::nav::{BugKind, BugParameters, DistBug, WallSide};
use roverlab::world::{RobotSpec, Scene, Wall, World};

use super::{Scenario, drive, noise, note, ride};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("distbug-ideal", distbug_ideal),
    Scenario::new("distbug-noise", distbug_noise),
    Scenario::new("bug-family", family),
];

/// A room with a cove that opens towards the start, and a slanted bar behind it.
fn cove() -> Scene {
    let mut world = World::walled(3.0, 2.0);
    let corners = [(1.0, 0.6), (1.6, 0.6), (1.6, 1.4), (1.0, 1.4)].map(|(x, y): (f64, f64)| Point::new(x, y));
    world.walls.extend(corners.windows(2).map(|pair| Wall::new(pair[0], pair[1])));
    world.walls.push(Wall::new(Point::new(2.0, 1.2), Point::new(2.3, 0.6)));
    Scene::with_robot(world, RobotSpec::s4(), Pose::new(0.4, 1.0, 0.0))
}

/// DistBug to a goal relative to the start, and what it comes to.
pub(super) fn distbug(scene: &Scene, options: SimOptions, goal: Point, time_limit: f64) -> Result<String> {
    let mut verdict = String::new();
    let log = drive(scene, options, |robot| {
        let mut behaviour = DistBug::new(goal, BugParameters::default())?;
        let outcome = run(robot, &mut behaviour, time_limit, |_, _, _| {})?;
        note(&mut verdict, "outcome", &outcome);
        note(&mut verdict, "events", &behaviour.take_events());
        note(&mut verdict, "pose as the robot sees it", &behaviour.pose());
        Ok(())
    })?;
    Ok(log + &verdict)
}

fn distbug_ideal() -> Result<String> {
    distbug(&cove(), noise(0.0, 16), Point::new(2.2, 0.1), 40.0)
}

fn distbug_noise() -> Result<String> {
    distbug(&cove(), noise(1.0, 17), Point::new(2.2, 0.1), 40.0)
}

/// Every algorithm of the family on the same way, the last one on the other side of the walls.
fn family() -> Result<String> {
    let mut log = String::new();
    for (kind, side) in
        BugKind::ALL.map(|kind| (kind, None)).into_iter().chain([(BugKind::Bug2, Some(WallSide::Right))])
    {
        let mut bug = kind.with(Point::new(2.2, 0.1), BugParameters { side, ..BugParameters::default() })?;
        let mut verdict = String::new();
        log += &ride(&cove(), noise(1.0, 81), |robot| {
            let outcome = run(robot, bug.as_mut(), 120.0, |_, bug, step| {
                for event in bug.take_events() {
                    note(&mut verdict, "event", &(step.time, bug.pose(), event));
                }
            })?;
            note(&mut verdict, "outcome", &(kind, outcome, bug.guarantee(), bug.goal_distance()));
            Ok(())
        })?;
        log += &verdict;
    }
    Ok(log)
}
