use std::cell::Cell;
use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::rc::Rc;

use roverlab::drive::{
    Cruise, CruiseParameters, Follower, FollowerObservation, FollowerParameters, Formation, robots_in,
};
use roverlab::geometry::{Point, Pose, Twist, direction};
use roverlab::io::log::FleetIo;
use roverlab::io::{self, LidarScan, Psd, RobotIo};
use roverlab::world::{Footprint, Scene};

use crate::driving::Trail;

use super::scene::{Mode, Pattern};

/// Result of a swarm.
#[derive(Debug, Clone)]
pub(crate) struct SwarmRun {
    /// Paths of the robots, the leader first.
    pub(crate) paths: Vec<Trail>,
    pub(crate) odometry: Vec<Pose>,
    pub(crate) contacts: u64,
    pub(crate) contact_places: Vec<Point>,
    /// Followers, counted from 1, that have lost the robot ahead or their position, if only for a while: what
    /// they took for it meanwhile was something else.
    pub(crate) lost: Vec<usize>,
    /// Mean distance to the robot ahead, and maximum after the first seconds (m).
    pub(crate) mean_gap: f64,
    pub(crate) largest_gap: f64,
    pub(crate) sim_time: f64,
    pub(crate) leader_path: f64,
}

impl SwarmRun {
    /// Whether it lasted until the swarm had formed, so that there are gaps.
    pub(crate) fn has_formed(&self) -> bool {
        self.largest_gap > 0.0
    }

    /// Whether the leader hardly moved, so that there was little to follow.
    pub(crate) fn is_leader_held(&self) -> bool {
        self.leader_path < CruiseParameters::default().speed * self.sim_time / 3.0
    }
}

/// Time in which a swarm forms (s).
const FORMING: f64 = 10.0;
/// Ratio of true to wished gap from which a follower counts as lost.
const TOO_FAR: f64 = 3.0;
/// Least gap that counts (m): a robot that is [`TOO_FAR`] times this from its place in a formation is away
/// from it. By odometry alone, robots drift apart by up to one such gap in 90 s.
const LEAST_GAP: f64 = 0.3;
/// Control period, and time between path points (s).
const PERIOD: f64 = 0.1;

/// A follower's perception and memory.
struct Eyes {
    scan: LidarScan,
    points: Vec<Point>,
    /// Recent points of single rays in the odometry frame, with their times.
    memory: VecDeque<(f64, Point)>,
}

impl Eyes {
    fn new() -> Self {
        Self { scan: LidarScan::default(), points: Vec::new(), memory: VecDeque::new() }
    }

    /// Reads a lidar that sees everything on the floor.
    fn look_round(&mut self, robot: &mut dyn RobotIo) -> io::Result<()> {
        robot.scan_into(&mut self.scan)?;
        self.scan.validate()?;
        self.points.clear();
        self.points.extend(self.scan.points());
        Ok(())
    }

    /// Reads eight distance sensors and keeps recent points; the lidar looks over the other followers.
    fn look_by_rays(&mut self, robot: &mut dyn RobotIo, rays: &[(u8, Pose)], pose: Pose) -> io::Result<()> {
        /// Maximum number of points, maximum age (s), and maximum distance (m) remembered.
        const REMEMBERED: usize = 48;
        const LATELY: f64 = 4.0;
        const NEAR: f64 = 1.0;
        robot.scan_into(&mut self.scan)?;
        self.scan.validate()?;
        let now = robot.now()?;
        for &(id, mount) in rays {
            let range = robot.distance(Psd(id))?;
            if range < NEAR {
                let seen = pose.to_world(mount.position() + direction(mount.heading) * range);
                self.memory.push_back((now, seen));
            }
        }
        // Other robots have moved on.
        let is_old = |&(seen, _): &(f64, Point)| seen < now - LATELY;
        while self.memory.len() > REMEMBERED || self.memory.front().is_some_and(is_old) {
            self.memory.pop_front();
        }
        self.points.clear();
        self.points.extend(self.memory.iter().map(|&(_, point)| pose.to_local(point)));
        Ok(())
    }
}

/// Rays of a robot's distance sensors.
fn rays_of(scene: &Scene, robot: usize) -> Vec<(u8, Pose)> {
    let mount = |psd: &roverlab::world::PsdSpec| Pose::new(psd.mount.x, psd.mount.y, psd.mount.yaw);
    scene.robots[robot].spec.psds.iter().map(|psd| (psd.id, mount(psd))).collect()
}

fn radius_of(scene: &Scene, robot: usize) -> f64 {
    match scene.robots[robot].spec.footprint {
        Footprint::Disc { radius } => radius,
        _ => scene.robots[robot].spec.footprint.bounding_radius(),
    }
}

/// The robot that a follower follows: in a chain the previous one, otherwise the leader.
pub(crate) fn ahead_of(mode: Mode, follower: usize) -> usize {
    if mode == Mode::Chain { follower - 1 } else { 0 }
}

/// Wished distance of a follower to the robot ahead of it.
pub(crate) fn gap_of(scene: &Scene, mode: Mode, follower: usize) -> f64 {
    let started =
        scene.robots[follower].pose.distance_to(scene.robots[ahead_of(mode, follower)].pose.position());
    match mode {
        Mode::Lidar => 0.45,
        Mode::Chain => 0.36,
        // Side by side and in rows, as at the start.
        Mode::Raised | Mode::Radio => started,
    }
}

/// Lets a leader drive past waypoints and the others follow, for a time (s).
pub(crate) fn run<'a>(
    fleet: &mut (dyn FleetIo<'a> + 'a),
    scene: &Scene,
    waypoints: &[Point],
    (mode, pattern): (Mode, Pattern),
    seconds: f64,
    mut watch: impl FnMut(f64),
) -> io::Result<SwarmRun> {
    let robots = scene.robots.len();
    let last_seen: Vec<Rc<Cell<f64>>> = (0..robots).map(|_| Rc::default()).collect();
    control_leader(fleet, scene, waypoints, (mode, pattern))?;
    for (follower, last_seen) in last_seen.iter().enumerate().skip(1) {
        if mode == Mode::Radio {
            control_by_radio(fleet, scene, follower)?;
        } else {
            control_follower(fleet, scene, mode, follower, Rc::clone(last_seen))?;
        }
    }
    let mut run = SwarmRun {
        paths: scene.robots.iter().map(|robot| vec![(0.0, robot.pose)]).collect(),
        odometry: Vec::new(),
        contacts: 0,
        contact_places: Vec::new(),
        lost: Vec::new(),
        mean_gap: 0.0,
        largest_gap: 0.0,
        sim_time: 0.0,
        leader_path: 0.0,
    };
    let (mut gaps, mut is_lost, mut away) = (0_u64, vec![false; robots], vec![0_u64; robots]);
    while fleet.time()? + 0.5 * PERIOD < seconds {
        fleet.run_for(PERIOD)?;
        let time = fleet.time()?;
        for (path, robot) in run.paths.iter_mut().zip(0..) {
            path.push((time, fleet.pose(robot)?));
        }
        watch(time);
        if time < FORMING {
            continue;
        }
        for (follower, is_lost) in is_lost.iter_mut().enumerate().skip(1) {
            let gap = gap_now(&run.paths, mode, follower);
            run.mean_gap += gap;
            gaps += 1;
            run.largest_gap = run.largest_gap.max(gap);
            *is_lost |= gap > TOO_FAR * gap_of(scene, mode, follower).max(LEAST_GAP);
            away[follower] += u64::from(!is_at_its_place(&run.paths, scene, follower));
        }
    }
    run.mean_gap /= gaps.max(1) as f64;
    for (follower, last_seen) in last_seen.iter().enumerate().skip(1) {
        // By radio, a follower sees nothing ahead: it steers for its place, whatever lies between.
        let is_apart = match mode {
            Mode::Radio => 2 * away[follower] * (robots as u64 - 1) > gaps,
            _ => fleet.time()? - last_seen.get() > 3.0,
        };
        if is_lost[follower] || is_apart {
            run.lost.push(follower);
        }
    }
    for robot in 0..robots {
        let truth = fleet.truth(robot)?;
        run.contacts += u64::from(truth.contacts);
        run.contact_places.extend(truth.contact_places);
        run.odometry.push(scene.robots[robot].pose.compose(&truth.odometry));
        if robot == 0 {
            run.leader_path = truth.path_length;
        }
    }
    run.sim_time = fleet.time()?;
    Ok(run)
}

/// The pose that a robot has now.
fn pose_now(paths: &[Trail], robot: usize) -> Pose {
    paths[robot].last().map_or(Pose::default(), |(_, pose)| *pose)
}

/// Whether a follower is about where it began, seen from the leader.
fn is_at_its_place(paths: &[Trail], scene: &Scene, follower: usize) -> bool {
    let offset = scene.robots[0].pose.to_local(scene.robots[follower].pose.position());
    let place = pose_now(paths, 0).to_world(offset);
    pose_now(paths, follower).distance_to(place) < TOO_FAR * LEAST_GAP
}

fn gap_now(paths: &[Trail], mode: Mode, follower: usize) -> f64 {
    pose_now(paths, follower).distance_to(pose_now(paths, ahead_of(mode, follower)).position())
}

fn control_leader<'a>(
    fleet: &mut (dyn FleetIo<'a> + 'a),
    scene: &Scene,
    waypoints: &[Point],
    (mode, pattern): (Mode, Pattern),
) -> io::Result<()> {
    let start = scene.robots[0].pose;
    let local = waypoints.iter().map(|&point| start.to_local(point)).collect();
    let parameters = CruiseParameters { radius: radius_of(scene, 0), ..CruiseParameters::default() };
    let mut cruise = Cruise::new(local, parameters)?;
    let mut eyes = Eyes::new();
    let step = move |robot: &mut dyn RobotIo| {
        eyes.look_round(robot)?;
        let pose = robot.pose()?;
        // Robots behind follow and are no obstacles.
        let ahead: Vec<Point> = eyes.points.iter().copied().filter(|point| point.x > -0.05).collect();
        let twist = match pattern {
            Pattern::StopAndGo if pattern.stands(robot.now()?) => Twist::STOP,
            _ => cruise.step(pose, &ahead)?,
        };
        robot.set_speed(twist)?;
        if mode == Mode::Radio {
            let message = Formation::message(start.compose(&pose), twist.linear);
            let own = robot.radio_id()?;
            for peer in robot.radio_peers()?.into_iter().filter(|&peer| peer != own) {
                robot.send(peer, &message)?;
            }
        }
        Ok(ControlFlow::Continue(()))
    };
    fleet.control(0, PERIOD, Box::new(step))
}

fn control_follower<'a>(
    fleet: &mut (dyn FleetIo<'a> + 'a),
    scene: &Scene,
    mode: Mode,
    follower: usize,
    last_seen: Rc<Cell<f64>>,
) -> io::Result<()> {
    let leader_radius = radius_of(scene, ahead_of(mode, follower));
    let parameters = FollowerParameters {
        gap: gap_of(scene, mode, follower),
        leader_radius,
        radius: radius_of(scene, follower),
        ..FollowerParameters::default()
    };
    let mut behaviour = Follower::new(parameters)?;
    let rays = rays_of(scene, follower);
    let mut eyes = Eyes::new();
    let step = move |robot: &mut dyn RobotIo| {
        let (time, pose) = (robot.now()?, robot.pose()?);
        if mode == Mode::Raised {
            eyes.look_by_rays(robot, &rays, pose)?;
        } else {
            eyes.look_round(robot)?;
        }
        let candidates = robots_in(&eyes.scan, leader_radius);
        let seen = FollowerObservation { time, pose, candidates: &candidates, obstacles: &eyes.points };
        let twist = behaviour.step(&seen)?;
        robot.set_speed(twist)?;
        last_seen.set(time - behaviour.unseen(time).min(time));
        Ok(ControlFlow::Continue(()))
    };
    fleet.control(follower, PERIOD, Box::new(step))
}

fn control_by_radio<'a>(
    fleet: &mut (dyn FleetIo<'a> + 'a),
    scene: &Scene,
    follower: usize,
) -> io::Result<()> {
    let start = scene.robots[follower].pose;
    let place = scene.robots[0].pose.to_local(start.position());
    let formation = Formation { radius: radius_of(scene, follower), ..Formation::at(place) };
    formation.validate()?;
    let mut eyes = Eyes::new();
    let mut leader = None;
    let step = move |robot: &mut dyn RobotIo| {
        eyes.look_round(robot)?;
        while let Some(message) = robot.receive()? {
            leader = Some(Formation::read(&message.data)?);
        }
        if let Some((place, speed)) = leader {
            let twist = formation.step(start.compose(&robot.pose()?), place, speed, &eyes.points);
            robot.set_speed(twist)?;
        }
        Ok(ControlFlow::Continue(()))
    };
    fleet.control(follower, PERIOD, Box::new(step))
}
