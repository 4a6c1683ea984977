//! Robots that get about, for benchmarks of fleets.

use std::ops::ControlFlow;
use std::sync::Arc;

use roverlab::geometry::{Pose, Twist};
use roverlab::io::sim::{Fleet, FleetRobot, NoiseModel, SimOptions};
use roverlab::io::{DistanceSensors, Drive, Psd};
use roverlab::world::space::{Solid, Space, Span};
use roverlab::world::{Footprint, RobotPlacement, RobotSpec, Scene, World};

use crate::free_poses;

/// Seconds between a robot's decisions.
pub const PERIOD: f64 = 0.1;

/// Ahead where there is room, and away from the nearer side.
pub fn avoid(ahead: f64, left: f64, right: f64) -> Twist {
    let room = (ahead - 0.15).clamp(0.0, 0.3);
    let turn = if room < 0.1 { 2.0 } else { (left.min(0.5) - right.min(0.5)).clamp(-1.0, 1.0) };
    Twist::new(room, turn)
}

/// So many S4s in a world, that read three PSDs and avoid what they see, ten times a second.
///
/// # Panics
///
/// If the floor is too small for them.
pub fn avoiders(world: &World, robots: usize) -> Fleet<'static> {
    let spec = Arc::new(RobotSpec::s4());
    let placed = apart(free_poses(world, 3 * robots, 0.1, 6), robots);
    let robots = placed.into_iter().map(|pose| RobotPlacement::new(Arc::clone(&spec), pose));
    let scene = Scene { robots: robots.collect(), ..Scene::new(world.clone()) };
    let options = SimOptions { noise: NoiseModel::real(), ..SimOptions::default() };
    let mut fleet = Fleet::new(&scene, options).expect("a good scene");
    for robot in 0..fleet.len() {
        fleet
            .control(robot, PERIOD, |robot: &mut FleetRobot<'_>| {
                let ahead = robot.distance(Psd::FRONT)?;
                let (left, right) = (robot.distance(Psd::LEFT)?, robot.distance(Psd::RIGHT)?);
                robot.set_speed(avoid(ahead, left, right))?;
                Ok(ControlFlow::Continue(()))
            })
            .expect("a robot and a period");
    }
    fleet
}

/// The first so many poses at which no two robots overlap.
fn apart(poses: Vec<Pose>, robots: usize) -> Vec<Pose> {
    let (outline, span) = (Footprint::Disc { radius: 0.06 }, Span { bottom: 0.0, top: 0.09 });
    let mut space = Space::new(&[]);
    let mut kept = Vec::with_capacity(robots);
    for pose in poses {
        if kept.len() < robots && space.clearance(&outline, &pose, span, 0.02, None) > 0.01 {
            space.add(Solid::new(outline, pose, span.bottom, span.top));
            kept.push(pose);
        }
    }
    assert_eq!(kept.len(), robots, "the floor is too small");
    kept
}
