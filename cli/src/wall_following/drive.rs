use std::ops::ControlFlow;

use roverlab::drive::{
    AlongWall, FollowsWalls, LidarWallFollower, LidarWallFollowerParameters, PidWallFollower,
    PidWallFollowerParameters, TwoLevelWallFollower, WallFollower, WallFollowerParameters, WallOutcome,
    WallReading, WallSensors, WallSide,
};
use roverlab::io::control::run;
use roverlab::io::{self, Clock, DistanceSensors, Drive, Lidar, Odometry, StallDetector};

use super::Controller;

/// Driving options.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Options {
    pub(crate) controller: Controller,
    pub(crate) side: Option<WallSide>,
    /// Distance (m) and speed (m/s).
    pub(crate) distance: f64,
    pub(crate) speed: f64,
    /// The robot's radius, and the error of its ranges (m).
    pub(crate) radius: f64,
    pub(crate) range_error: f64,
    pub(crate) sensors: WallSensors,
    /// Time limit (s).
    pub(crate) time_limit: f64,
}

/// The robot's result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Walk {
    pub(crate) outcome: WallOutcome,
    /// Side of the wall.
    pub(crate) side: Option<WallSide>,
}

/// Whether the robot reports being beside a wall, and the side of walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Beside {
    pub(crate) wall: bool,
    pub(crate) side: Option<WallSide>,
}

/// Lets a robot follow a wall. `watch` is called after each step.
pub(crate) fn drive<R: Clock + Drive + Odometry + StallDetector + DistanceSensors + Lidar + ?Sized>(
    robot: &mut R,
    options: &Options,
    watch: &mut dyn FnMut(Beside) -> ControlFlow<()>,
) -> io::Result<Walk> {
    let Options { side, distance, speed, sensors, time_limit, .. } = *options;
    let one_side = side.unwrap_or(WallSide::Left);
    match options.controller {
        Controller::Psd => {
            let mut follower = WallFollower::new(WallFollowerParameters {
                side,
                distance,
                speed,
                radius: options.radius,
                range_error: options.range_error,
                sensors,
                ..WallFollowerParameters::default()
            })?;
            let outcome = walk(robot, &mut follower, time_limit, watch)?;
            Ok(Walk { outcome, side: follower.side() })
        }
        Controller::Pid => {
            let parameters = PidWallFollowerParameters {
                side: one_side,
                distance,
                speed,
                sensors,
                ..PidWallFollowerParameters::default()
            };
            let mut follower = PidWallFollower::new(parameters)?;
            let outcome = walk(robot, &mut follower, time_limit, watch)?;
            Ok(Walk { outcome, side: Some(one_side) })
        }
        Controller::Lidar => {
            let parameters = LidarWallFollowerParameters {
                side: one_side,
                distance,
                speed,
                ..LidarWallFollowerParameters::default()
            };
            let mut follower = LidarWallFollower::new(parameters)?;
            let outcome = walk(robot, &mut follower, time_limit, watch)?;
            Ok(Walk { outcome, side: Some(one_side) })
        }
        Controller::Book => {
            let safe = distance - sensors.left.y.abs();
            let mut follower = TwoLevelWallFollower::new(safe, speed)?;
            let outcome = walk(robot, &mut follower, time_limit, watch)?;
            Ok(Walk { outcome, side: Some(WallSide::Left) })
        }
    }
}

fn walk<R: Clock + Drive + StallDetector + ?Sized, C: FollowsWalls<Observation: WallReading<R>>>(
    robot: &mut R,
    controller: &mut C,
    time_limit: f64,
    watch: &mut dyn FnMut(Beside) -> ControlFlow<()>,
) -> io::Result<WallOutcome> {
    run(robot, &mut AlongWall::new(controller), time_limit, |_, along, _| {
        watch(Beside { wall: along.controller.is_beside_wall(), side: along.controller.wall_side() })
    })
}
