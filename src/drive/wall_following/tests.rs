use std::f64::consts::{FRAC_PI_2, PI};

use super::*;
use crate::geometry::{Point, Pose, Twist};
use crate::io::control::run;
use crate::io::sim::{SimOptions, SimRobot, Simulation};
use crate::random::Stream;
use crate::world::generate::{RoomOptions, room};
use crate::world::{RobotSpec, Scene, Wall, World};

/// Result of a drive: contacts, path length (m), and distance errors after the first metre along the wall
/// (m).
struct Drive {
    contacts: u32,
    length: f64,
    errors: Vec<f64>,
}

impl Drive {
    fn rms(&self) -> f64 {
        (self.errors.iter().map(|e| e * e).sum::<f64>() / self.errors.len().max(1) as f64).sqrt()
    }

    fn worst(&self) -> f64 {
        self.errors.iter().map(|e| e.abs()).fold(0.0, f64::max)
    }
}

fn drive<C>(world: &World, start: Pose, controller: &mut C, seconds: f64, noise: f64, seed: u64) -> Drive
where
    C: FollowsWalls<Observation: WallReading<SimRobot>>,
{
    const DISTANCE: f64 = 0.2;
    let scene = Scene::with_robot(world.clone(), RobotSpec::s4(), start);
    let simulation = Simulation::new(&scene, SimOptions::with_noise(noise, seed)).unwrap();
    let truth = simulation.truth();
    let (mut begin, mut errors) = (None, Vec::new());
    let mut robot = simulation.robot(0).unwrap();
    run(&mut robot, &mut AlongWall::new(controller), seconds, |_, along, _| {
        let robot = truth.robot(0).unwrap();
        if begin.is_none() && along.controller.is_beside_wall() {
            begin = Some(robot.path_length);
        }
        if begin.is_some_and(|begin| robot.path_length > begin + 1.0) {
            let gaps = world.walls.iter().map(|wall| wall.line.distance_to(robot.pose.position()));
            errors.push(gaps.fold(f64::INFINITY, f64::min) - 0.5 * Wall::DEFAULT_THICKNESS - DISTANCE);
        }
    })
    .unwrap();
    let end = truth.robot(0).unwrap();
    Drive { contacts: end.contacts, length: end.path_length, errors }
}

fn follower(side: Option<WallSide>) -> WallFollower {
    WallFollower::new(WallFollowerParameters { side, ..WallFollowerParameters::default() }).unwrap()
}

#[test]
fn a_wall_is_found_from_any_angle_and_followed_on_either_side() {
    let world = World::walled(2.0, 2.0);
    for (k, side) in
        [None, Some(WallSide::Left), Some(WallSide::Right)].into_iter().cycle().take(18).enumerate()
    {
        let heading = -PI + 0.35 * k as f64;
        let mut follower = follower(side);
        let drive = drive(&world, Pose::new(1.1, 0.9, heading), &mut follower, 40.0, 1.0, k as u64);
        assert_eq!(drive.contacts, 0, "{heading}");
        assert!(side.is_none() || follower.side() == side);
        assert!(drive.length > 3.5 && drive.rms() < 0.02, "{heading}: {} {}", drive.length, drive.rms());
        assert!(drive.worst() < 0.07, "{heading}: {}", drive.worst());
    }
}

#[test]
fn in_corners_and_between_two_walls_it_is_not_misled() {
    // Left and right ranges belong to different walls, or are equal.
    let corner = World::walled(2.0, 2.0);
    let corridor = World::walled(3.0, 0.6);
    for (world, start) in [
        (&corner, Pose::new(0.4, 0.4, -2.4)),
        (&corner, Pose::new(0.3, 0.6, -2.0)),
        (&corner, Pose::new(1.7, 1.6, 0.8)),
        (&corridor, Pose::new(1.0, 0.3, 0.0)),
        (&corridor, Pose::new(1.0, 0.3, 0.6)),
        (&corridor, Pose::new(2.0, 0.3, FRAC_PI_2)),
    ] {
        let drive = drive(world, start, &mut follower(None), 40.0, 1.0, 3);
        assert!(drive.contacts == 0 && drive.length > 3.0, "{start:?}: {}", drive.length);
        assert!(drive.rms() < 0.025, "{start:?}: {}", drive.rms());
    }
}

#[test]
fn rooms_with_curves_and_doors_are_followed_without_contact() {
    for seed in 0..10 {
        let room = room(&mut Stream::new(seed), &RoomOptions::default()).unwrap();
        let side = if seed % 2 == 0 { WallSide::Left } else { WallSide::Right };
        let drive = drive(&room.world, room.start, &mut follower(Some(side)), 100.0, 1.0, seed);
        assert_eq!(drive.contacts, 0, "{seed}");
        assert!(drive.length > 12.0 && drive.rms() < 0.025, "{seed}: {} {}", drive.length, drive.rms());
    }
}

#[test]
fn the_lidar_and_the_pid_controller_follow_plain_walls() {
    let world = World::walled(2.5, 2.0);
    for side in [WallSide::Left, WallSide::Right] {
        let start = Pose::new(1.0, 1.0, 0.5);
        let parameters = LidarWallFollowerParameters { side, ..LidarWallFollowerParameters::default() };
        let lidar = drive(&world, start, &mut LidarWallFollower::new(parameters).unwrap(), 60.0, 1.0, 1);
        assert!(lidar.contacts == 0 && lidar.length > 7.0 && lidar.rms() < 0.012, "{}", lidar.rms());
        let parameters = PidWallFollowerParameters { side, ..PidWallFollowerParameters::default() };
        let pid = drive(&world, start, &mut PidWallFollower::new(parameters).unwrap(), 60.0, 1.0, 1);
        assert!(pid.contacts == 0 && pid.length > 7.0 && pid.rms() < 0.04, "{}", pid.rms());
    }
}

#[test]
fn the_end_of_a_free_wall_is_rounded() {
    let mut world = World::walled(3.0, 3.0);
    world.walls.push(Wall::new(Point::new(0.8, 1.5), Point::new(2.2, 1.5)));
    let mut follower = follower(Some(WallSide::Left));
    let drive = drive(&world, Pose::new(1.2, 1.1, 1.4), &mut follower, 60.0, 1.0, 2);
    // Twice round the free wall.
    assert!(drive.contacts == 0 && drive.length > 8.0, "{}", drive.length);
    // Round the free wall it stays within reach of it.
    assert!(drive.rms() < 0.03, "{}", drive.rms());
}

#[test]
fn the_mirrored_robot_does_the_same_mirrored() {
    let mut left = follower(Some(WallSide::Left));
    let mut right = follower(Some(WallSide::Right));
    let mut stream = Stream::new(5);
    for k in 0..400 {
        let pose = Pose::new(0.002 * f64::from(k), 0.0, 0.1 * stream.normal());
        let seen = WallObservation {
            pose,
            front: stream.between(0.1, 1.0),
            left: stream.between(0.1, 0.3),
            right: stream.between(0.5, 2.0),
        };
        let (one, other) = (left.step(&seen).unwrap(), right.step(&seen.mirrored()).unwrap());
        assert_eq!((one.linear, one.angular), (other.linear, -other.angular));
    }
}

#[test]
fn nonsense_is_refused() {
    let good = WallFollowerParameters::default();
    for bad in [
        WallFollowerParameters { distance: 0.05, ..good },
        WallFollowerParameters { speed: f64::NAN, ..good },
        WallFollowerParameters { range_error: 0.5, ..good },
        WallFollowerParameters { reach: 0.0, ..good },
    ] {
        assert!(WallFollower::new(bad).is_err(), "{bad:?}");
    }
    let mut follower = follower(None);
    let seen = WallObservation { pose: Pose::default(), front: f64::NAN, left: 1.0, right: 1.0 };
    assert!(follower.step(&seen).unwrap_err().to_string().contains("front range"));
    let lost = Pose::new(f64::INFINITY, 0.0, 0.0);
    assert!(follower.step(&WallObservation { pose: lost, front: 1.0, ..seen }).is_err());
    // Without returns it drives on.
    let nothing = f64::INFINITY;
    let seen = WallObservation { pose: Pose::default(), front: nothing, left: nothing, right: nothing };
    assert!(follower.step(&seen).unwrap() != Twist::STOP);
    assert!(WallSensors::of(&RobotSpec::car()).is_err());
    assert_eq!(WallSensors::of(&RobotSpec::s4()).unwrap(), WallSensors::default());
}

/// In a box with room only for turning on the spot, the drive ends as blocked before the time limit.
#[test]
fn without_room_a_robot_is_blocked() {
    let world = World::walled(0.3, 0.3);
    let scene = Scene::with_robot(world, RobotSpec::s4(), Pose::new(0.15, 0.15, 0.3));
    let blocked = |outcome: WallOutcome| assert_eq!(outcome, WallOutcome::Blocked);
    let simulation = || Simulation::new(&scene, SimOptions::with_noise(1.0, 1)).unwrap();
    let mut robot = simulation().robot(0).unwrap();
    blocked(run(&mut robot, &mut AlongWall::new(follower(None)), 60.0, |_, _, _| {}).unwrap());
    let mut robot = simulation().robot(0).unwrap();
    let pid = PidWallFollower::new(PidWallFollowerParameters::default()).unwrap();
    blocked(run(&mut robot, &mut AlongWall::new(pid), 60.0, |_, _, _| {}).unwrap());
}

/// Drives in circles of a quarter of a metre, with a wall beside some of the way.
#[derive(Debug)]
struct Circles {
    time: f64,
    /// Share of the time beside a wall.
    beside: f64,
}

impl FollowsWalls for Circles {
    type Observation = WallObservation;

    fn steer(&mut self, _seen: &WallObservation, seconds: f64) -> crate::io::Result<Twist> {
        self.time += seconds;
        Ok(Twist::new(0.2, 0.8))
    }

    fn period(&self) -> f64 {
        0.05
    }

    fn is_beside_wall(&self) -> bool {
        self.time.fract() < self.beside
    }

    fn wall_side(&self) -> Option<WallSide> {
        None
    }
}

/// Where all walls are shorter than 0.3 m, rounds beside them are rounds, and rounds beside none are none.
#[test]
fn rounds_count_beside_walls_only_however_short_these_are() {
    let outcome = |beside: f64| {
        let scene = Scene::with_robot(World::walled(3.0, 3.0), RobotSpec::s4(), Pose::new(1.5, 1.5, 0.0));
        let simulation = Simulation::new(&scene, SimOptions::with_noise(0.0, 1)).unwrap();
        let mut circles = AlongWall::new(Circles { time: 0.0, beside });
        run(&mut simulation.robot(0).unwrap(), &mut circles, 60.0, |_, _, _| {}).unwrap()
    };
    assert_eq!([0.0, 0.5].map(outcome), [WallOutcome::Blocked, WallOutcome::TimedOut]);
}
