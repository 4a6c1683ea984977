//! The worlds of a batch, and the rows of its arrays.

use std::sync::{Arc, Mutex, PoisonError};

use roverlab::geometry::{Point, Twist};
use roverlab::io::sim::{FleetRobot, SimOptions, Stepped, TICK};
use roverlab::io::{
    Attitude, DepthSensor, DistanceSensors, Drive, ErrorKind, Inertial, Lidar, Mishap, Motors, Odometry, Psd,
    Result, StallDetector,
};
use roverlab::world::{self, Wall};

use crate::errors::Outcome;
use crate::simulation::{Shared, State};
use crate::way::Way;

/// A world of a batch.
#[derive(Debug)]
pub(crate) struct Cell {
    pub(crate) shared: Arc<Shared>,
    sensors: Vec<Psd>,
    way: Option<Way>,
    /// Whether commands are those of thrusters.
    thrusters: bool,
}

/// Numbers of robots, and of columns for beams, distance sensors, the nearest wall, the lane, the state in
/// space and the commands of each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shape {
    pub(crate) robots: usize,
    pub(crate) beams: usize,
    pub(crate) sensors: usize,
    pub(crate) walls: usize,
    pub(crate) lane: usize,
    pub(crate) space: usize,
    pub(crate) commands: usize,
}

impl Shape {
    /// Numbers of a robot in the arrays: the columns, and those that every robot has.
    pub(crate) fn columns(&self) -> usize {
        let always = 3 + 2 + 1 + 3 + 1;
        let parts = [self.beams, self.sensors, self.walls, self.lane, self.space, self.commands];
        parts.into_iter().fold(always, usize::saturating_add)
    }
}

/// Columns of robots in space.
pub(crate) const SPACE: usize = 9;

/// The rows of some robots.
pub(crate) struct Rows<'a> {
    pub(crate) ranges: &'a mut [f64],
    pub(crate) distances: &'a mut [f64],
    pub(crate) poses: &'a mut [f64],
    pub(crate) speeds: &'a mut [f64],
    pub(crate) stalled: &'a mut [bool],
    pub(crate) true_poses: &'a mut [f64],
    pub(crate) contacts: &'a mut [u32],
    pub(crate) walls: &'a mut [f64],
    pub(crate) lanes: &'a mut [f64],
    pub(crate) space: &'a mut [f64],
}

impl Rows<'_> {
    /// The rows of the first robots, and the others.
    pub(crate) fn split(self, robots: usize, shape: Shape) -> (Self, Self) {
        let (ranges, more_ranges) = self.ranges.split_at_mut(robots * shape.beams);
        let (distances, more_distances) = self.distances.split_at_mut(robots * shape.sensors);
        let (poses, more_poses) = self.poses.split_at_mut(3 * robots);
        let (speeds, more_speeds) = self.speeds.split_at_mut(2 * robots);
        let (stalled, more_stalled) = self.stalled.split_at_mut(robots);
        let (true_poses, more_true_poses) = self.true_poses.split_at_mut(3 * robots);
        let (contacts, more_contacts) = self.contacts.split_at_mut(robots);
        let (walls, more_walls) = self.walls.split_at_mut(robots * shape.walls);
        let (lanes, more_lanes) = self.lanes.split_at_mut(robots * shape.lane);
        let (space, more_space) = self.space.split_at_mut(robots * shape.space);
        let first =
            Rows { ranges, distances, poses, speeds, stalled, true_poses, contacts, walls, lanes, space };
        let others = Rows {
            ranges: more_ranges,
            distances: more_distances,
            poses: more_poses,
            speeds: more_speeds,
            stalled: more_stalled,
            true_poses: more_true_poses,
            contacts: more_contacts,
            walls: more_walls,
            lanes: more_lanes,
            space: more_space,
        };
        (first, others)
    }
}

impl Cell {
    pub(crate) fn new(
        scene: Arc<world::Scene>,
        goal: Option<Point>,
        way: Option<Way>,
        thrusters: bool,
        options: SimOptions,
    ) -> Outcome<Self> {
        let sensors = scene.robots.first().map_or(Vec::new(), |robot| sensors(&robot.spec));
        Ok(Self { shared: Arc::new(Shared::new(scene, goal, options)?), sensors, way, thrusters })
    }

    /// Number of robots.
    pub(crate) fn robots(&self) -> usize {
        self.shared.scene.robots.len()
    }

    /// Commands all robots at the beginning of a step, lets time pass, and reads all sensors at its end. For
    /// a thread that runs no Python.
    fn step(&mut self, commands: &[f64], part: Part, rows: &mut Rows<'_>, shape: Shape) -> Result<()> {
        let shared = Arc::clone(&self.shared);
        let mut state = shared.free_lock();
        if part.begins {
            for (robot, command) in commands.chunks_exact(shape.commands).enumerate() {
                self.command(&mut state.world.robot(robot)?, command)?;
            }
        }
        state.world.run_for(part.ticks as f64 * TICK)?;
        if part.ends { self.read(&mut state, rows, shape) } else { Ok(()) }
    }

    /// Commands a robot.
    fn command(&self, robot: &mut FleetRobot<'_>, command: &[f64]) -> Result<()> {
        if self.thrusters {
            return (1..).zip(command).try_for_each(|(motor, &part)| robot.set_motor(motor, part));
        }
        robot.set_speed(Twist::new(command[0], command[1]))
    }

    /// Reads all sensors of the world's robots, and the truth about them.
    pub(crate) fn read(&mut self, state: &mut State, rows: &mut Rows<'_>, shape: Shape) -> Result<()> {
        let State { world, scan, .. } = state;
        for index in 0..self.robots() {
            let mut robot = world.robot(index)?;
            if shape.beams > 0 {
                robot.scan_into(scan)?;
                rows.ranges[index * shape.beams..][..shape.beams].copy_from_slice(&scan.ranges);
            }
            for (range, sensor) in rows.distances[index * shape.sensors..].iter_mut().zip(&self.sensors) {
                *range = robot.distance(*sensor)?;
            }
            let (pose, speed) = (robot.pose()?, robot.speed()?);
            rows.poses[3 * index..][..3].copy_from_slice(&[pose.x, pose.y, pose.heading]);
            rows.speeds[2 * index..][..2].copy_from_slice(&[speed.linear, speed.angular]);
            rows.stalled[index] = robot.is_stalled()?;
            let truth = world.pose(index)?;
            rows.true_poses[3 * index..][..3].copy_from_slice(&[truth.x, truth.y, truth.heading]);
            rows.contacts[index] = world.contacts(index)?;
            if shape.walls > 0 {
                let nearest = nearest_wall(&self.shared.scene.world.walls, truth.position());
                rows.walls[3 * index..][..3].copy_from_slice(&nearest);
            }
            if shape.space > 0 {
                let seen = in_space(world, index)?;
                rows.space[SPACE * index..][..SPACE].copy_from_slice(&seen);
            }
            if let Some(way) = &mut self.way {
                way.look(index, truth, &mut rows.lanes[index * shape.lane..][..shape.lane]);
            }
        }
        Ok(())
    }
}

/// A robot in space: attitude, turn rates and depth by its sensors; true height, and whether it is lost.
fn in_space(world: &mut Stepped, index: usize) -> Result<[f64; SPACE]> {
    let mut robot = world.robot(index)?;
    let (attitude, rates) = (robot.attitude()?, robot.turn_rates()?);
    let depth = match robot.depth() {
        Err(error) if error.kind() == ErrorKind::Unsupported => 0.0,
        depth => depth?,
    };
    let truth = world.in_space(index)?;
    let lost = truth.mishap.is_some_and(Mishap::is_final);
    let Attitude { roll, pitch, yaw } = attitude;
    let height = truth.pose.position.z;
    Ok([roll, pitch, yaw, rates.x, rates.y, rates.z, depth, height, f64::from(u8::from(lost))])
}

/// Distance from the surface of the nearest wall, and the unit vector towards it; `inf` and no direction
/// without walls, and no direction within a wall.
fn nearest_wall(walls: &[Wall], place: Point) -> [f64; 3] {
    let mut nearest = [f64::INFINITY, 0.0, 0.0];
    for wall in walls {
        let (start, along) = (wall.line.a - place, wall.line.b - wall.line.a);
        let length = along.norm_squared();
        let part = if length > 0.0 { (-start.dot(&along) / length).clamp(0.0, 1.0) } else { 0.0 };
        let away = start + along * part;
        let from_line = away.norm();
        let distance = (from_line - 0.5 * wall.thickness).max(0.0);
        if distance < nearest[0] {
            let direction = if from_line > 0.0 { away / from_line } else { away };
            nearest = [distance, direction.x, direction.y];
        }
    }
    nearest
}

/// The distance sensors of a robot.
pub(crate) fn sensors(spec: &world::RobotSpec) -> Vec<Psd> {
    spec.psds.iter().map(|psd| Psd(psd.id)).collect()
}

/// A part of a step in time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    pub(crate) ticks: u64,
    pub(crate) begins: bool,
    pub(crate) ends: bool,
}

/// Some worlds, the commands to their robots, and their rows.
struct Share<'a> {
    worlds: &'a mut [Cell],
    commands: &'a [f64],
    rows: Rows<'a>,
}

/// Shares per thread: so many that no thread waits long for the slowest one.
const SHARES: usize = 8;

impl<'a> Share<'a> {
    /// Splits off the first worlds.
    fn split(self, worlds: usize, shape: Shape) -> (Self, Self) {
        let (first, others) = self.worlds.split_at_mut(worlds);
        let robots = first.iter().map(Cell::robots).sum::<usize>();
        let (rows, other_rows) = self.rows.split(robots, shape);
        let (commands, other_commands) = self.commands.split_at(shape.commands * robots);
        let rest = Share { worlds: others, commands: other_commands, rows: other_rows };
        (Share { worlds: first, commands, rows }, rest)
    }

    /// Shares of at most so many worlds.
    fn divide(self, worlds: usize, shape: Shape) -> Vec<Share<'a>> {
        let (mut rest, mut shares) = (self, Vec::new());
        while rest.worlds.len() > worlds {
            let (share, others) = rest.split(worlds, shape);
            shares.push(share);
            rest = others;
        }
        shares.push(rest);
        shares
    }

    fn step(self, part: Part, shape: Shape) -> Result<()> {
        let mut rest = self;
        while !rest.worlds.is_empty() {
            let (mut one, others) = rest.split(1, shape);
            one.worlds[0].step(one.commands, part, &mut one.rows, shape)?;
            rest = others;
        }
        Ok(())
    }
}

/// Steps worlds, in some threads, of which the caller's is one.
pub(crate) fn step_all(
    worlds: &mut [Cell],
    commands: &[f64],
    rows: Rows<'_>,
    part: Part,
    (shape, threads): (Shape, usize),
) -> Result<()> {
    let threads = threads.min(worlds.len());
    let all = Share { worlds, commands, rows };
    if threads == 1 {
        return all.step(part, shape);
    }
    let most = all.worlds.len().div_ceil(SHARES * threads);
    let shares = Mutex::new(all.divide(most, shape).into_iter());
    let next = || shares.lock().unwrap_or_else(PoisonError::into_inner).next();
    let work = || std::iter::from_fn(next).try_for_each(|share| share.step(part, shape));
    std::thread::scope(|scope| {
        // Where no more threads can be started, those that run do all the work.
        let spawn = |_| std::thread::Builder::new().spawn_scoped(scope, work).ok();
        let others: Vec<_> = (1..threads).map_while(spawn).collect();
        let own = work();
        let ended = others.into_iter().map(|thread| match thread.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        });
        ended.collect::<Vec<_>>().into_iter().chain([own]).collect()
    })
}
