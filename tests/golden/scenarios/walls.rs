//! Following walls.

use roverlab::drive::{
    AlongWall, FollowsWalls, LidarWallFollower, LidarWallFollowerParameters, PidWallFollower,
    PidWallFollowerParameters, TwoLevelWallFollower, WallFollower, WallFollowerParameters, WallReading,
    WallSide,
};
use roverlab::geometry::{Point, Pose};
use roverlab::io::Result;
use roverlab::io::control::run;
use roverlab::world::{RobotSpec, Scene, Wall, World};

use super::{Robot, Scenario, noise, note, ride};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("wall-psd", psd),
    Scenario::new("wall-pid", pid),
    Scenario::new("wall-lidar", lidar),
    Scenario::new("wall-two-levels", two_levels),
];

/// A room with a nook and the end of a wall, seen from a robot that has yet to find one.
fn nook() -> Scene {
    let mut world = World::walled(2.0, 1.6);
    let corners = [(0.0, 1.1), (0.5, 1.1), (0.5, 1.6)].map(|(x, y): (f64, f64)| Point::new(x, y));
    world.walls.extend(corners.windows(2).map(|ends| Wall::new(ends[0], ends[1])));
    world.walls.push(Wall::new(Point::new(1.2, 0.0), Point::new(1.3, 0.6)));
    Scene::with_robot(world, RobotSpec::s4(), Pose::new(0.7, 0.8, 0.4))
}

/// A follower's run, with its opinion about the wall at every step.
fn follow<F: FollowsWalls<Observation: WallReading<Robot>>>(seed: u64, follower: F) -> Result<String> {
    let mut verdict = String::new();
    let mut along = AlongWall::new(follower);
    let log = ride(&nook(), noise(1.0, seed), |robot| {
        let outcome = run(robot, &mut along, 40.0, |_, along, step| {
            let wall = &along.controller;
            note(&mut verdict, "at", &(step.time, wall.is_beside_wall(), wall.wall_side()));
        })?;
        note(&mut verdict, "outcome", &outcome);
        Ok(())
    })?;
    Ok(log + &verdict)
}

fn psd() -> Result<String> {
    let right = WallFollowerParameters { side: Some(WallSide::Right), ..WallFollowerParameters::default() };
    let either = WallFollower::new(WallFollowerParameters::default())?;
    Ok(follow(31, either)? + &follow(32, WallFollower::new(right)?)?)
}

fn pid() -> Result<String> {
    follow(33, PidWallFollower::new(PidWallFollowerParameters::default())?)
}

fn lidar() -> Result<String> {
    follow(34, LidarWallFollower::new(LidarWallFollowerParameters::default())?)
}

fn two_levels() -> Result<String> {
    follow(35, TwoLevelWallFollower::new(0.12, 0.15)?)
}
