//! The object that answers the requests of a program's library.

use std::fmt;

use roverlab::geometry::{Aabb, Pose, units};
use roverlab::io::sim::{SimOptions, Simulation, TICK, Truth};
use roverlab::io::{Attitude, Error, ErrorKind, LidarScan, Psd, RadioMessage, Resolution, Result, RobotIo};
use roverlab::world::{InertialSpec, Misplacement, Scene};

use crate::ask::{MOST_READINGS, Reply, Request};
use crate::identity::{Identity, speeds, turns};
use crate::report::Stance;
use crate::walker::Walker;

/// Interval at which a walker's body follows it (s).
const STRIDE: f64 = 0.05;

/// Conditions of a program's run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terms {
    /// Duration of a call (s).
    pub call_duration: f64,
    /// Time after which every call fails (s).
    pub time_limit: Option<f64>,
    /// Whether readings may be cached until something can change them.
    pub exact: bool,
}

impl Terms {
    /// Terms of a simulation. Noisy readings are drawn anew each time.
    pub fn of(options: &SimOptions) -> Self {
        let exact = options.noise.range == 0.0;
        Self { call_duration: options.call_duration, time_limit: options.time_limit, exact }
    }
}

/// How a walker has walked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walked {
    /// Pose by odometry.
    pub odometry: Pose,
    /// Distance walked (m).
    pub path_length: f64,
    /// Height of its body's centre; it is always level.
    pub stance: Stance,
}

/// Drives one robot of a simulation on behalf of a program.
pub struct Seat {
    robot: Box<dyn RobotIo + Send>,
    truth: Truth,
    identity: Identity,
    index: usize,
    /// Numbers of the robots and of the objects.
    numbers: (Vec<u32>, Vec<u32>),
    scan: LidarScan,
    walker: Option<Walker>,
    /// What the world is like, with things where they were at the start.
    scene: Scene,
    /// Duration of readings made in advance (s).
    ahead: f64,
}

impl fmt::Debug for Seat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Seat")
            .field("index", &self.index)
            .field("identity", &self.identity)
            .finish_non_exhaustive()
    }
}

impl Seat {
    /// Takes a robot of a simulated scene.
    pub fn take(simulation: &Simulation, scene: &Scene, index: usize, terms: Terms) -> Result<Self> {
        Ok(Self::of(Box::new(simulation.robot(index)?), simulation, scene, index, terms))
    }

    /// Takes a robot that was already taken, and may have been wrapped.
    ///
    /// # Panics
    ///
    /// If the scene has no robot of this index.
    pub fn of(
        robot: Box<dyn RobotIo + Send>,
        simulation: &Simulation,
        scene: &Scene,
        index: usize,
        terms: Terms,
    ) -> Self {
        let spec = &scene.robots[index].spec;
        let walker = Walker::of(spec, scene.robots[index].pose);
        let on_wheels = walker.is_none();
        let (top_speed, full_speed, tick_length) = speeds(spec);
        let (reach, tightest_turn) = if on_wheels { turns(&spec.drive) } else { (0.0, f64::INFINITY) };
        let numbers = (scene.robot_numbers(), scene.object_numbers());
        let identity = Identity {
            id: numbers.0[index],
            robots: scene.robots.len() as u32,
            objects: scene.world.objects.len() as u32,
            top_speed,
            reach,
            tightest_turn,
            full_speed,
            tick_length,
            lidar_points: spec.lidar.filter(|_| on_wheels).map_or(0, |lidar| lidar.points as u32),
            full_turn: spec.lidar.is_none_or(|lidar| lidar.field_of_view > std::f64::consts::TAU - 1e-9),
            call_duration: terms.call_duration,
            time_limit: terms.time_limit.unwrap_or(f64::INFINITY),
            exact: terms.exact,
            camera: spec.camera.is_some() && on_wheels,
            depth_channel: spec.depth_sensor.map_or(0, |sensor| sensor.channel),
            inertial: if on_wheels { spec.inertial } else { InertialSpec::default() },
        };
        let (truth, scan) = (simulation.truth(), LidarScan::default());
        let scene = scene.clone();
        Self { robot, truth, identity, index, numbers, scan, walker, scene, ahead: 0.0 }
    }

    /// Properties of the robot.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Ground truth of the world.
    pub fn truth(&self) -> &Truth {
        &self.truth
    }

    /// Index of the robot in the scene.
    pub fn index(&self) -> usize {
        self.index
    }

    /// What a walker knows better than the world, which knows all of robots on wheels; `None` for those.
    pub fn walked(&self) -> Option<Walked> {
        let walked = |walker: &Walker| Walked {
            odometry: walker.odometry(),
            path_length: walker.walked(),
            stance: Stance { elevation: walker.height(), ..Stance::default() },
        };
        self.walker.as_ref().map(walked)
    }

    /// Time by the robot's clock (s).
    pub fn now(&mut self) -> f64 {
        self.robot.peek_time().unwrap_or_default()
    }

    /// Lets `debt` seconds pass, which local calls have taken, and answers the request.
    pub fn ask(&mut self, debt: f64, request: &Request) -> Result<Reply> {
        let debt = debt - std::mem::take(&mut self.ahead);
        if debt > 0.0 {
            self.wait((debt - self.identity.call_duration).max(0.0))?;
        }
        if self.walker.is_some()
            && let Some(reply) = self.walk(request)?
        {
            return Ok(reply);
        }
        let robot = &mut self.robot;
        Ok(match *request {
            Request::Identity => Reply::Identity(self.identity),
            Request::Pass(seconds) => done(robot.wait(seconds)?),
            Request::SetSpeed(twist) => done(robot.set_speed(twist)?),
            Request::Speed => Reply::Twist(robot.speed()?),
            Request::Pose => Reply::Pose(robot.pose()?, 0.0),
            Request::SetPose(pose) => done(robot.set_pose(pose)?),
            Request::Curve(length, angle, speed) => done(robot.curve(length, angle, speed)?),
            Request::Remaining => Reply::Number(robot.remaining()?),
            Request::IsDone => Reply::Flag(robot.is_done()?),
            Request::WaitDone => done(robot.wait_done()?),
            Request::IsStalled => Reply::Flag(robot.is_stalled()?),
            Request::Distance(sensor) => Reply::Number(robot.distance(Psd(sensor))?),
            Request::Scan => {
                robot.scan_into(&mut self.scan)?;
                Reply::Ranges(self.scan.ranges.clone())
            }
            Request::ConfigureLidar(settings) => done(robot.configure_lidar(settings)?),
            Request::SetResolution(number) => done(robot.set_resolution(resolution(number)?)?),
            Request::Image => Reply::Image(robot.image()?),
            Request::Send(to, ref data) => {
                let to = if to == 0 { 0 } else { self.robot_index(to)? as u32 + 1 };
                done(self.robot.send(to, data)?)
            }
            Request::Numbers => Reply::Numbers(self.numbers.0.clone()),
            Request::Receive(seconds) => Reply::Message(self.receive(seconds)?),
            Request::Motor(motor, fraction) => done(robot.set_motor(motor, fraction)?),
            Request::Servo(servo, position) => done(robot.set_servo(servo, position)?),
            Request::Encoder(motor) => Reply::Count(robot.encoder(motor)?),
            Request::ResetEncoder(motor) => done(robot.reset_encoder(motor)?),
            Request::Depth => Reply::Number(robot.depth()?),
            Request::Attitude => {
                let Attitude { roll, pitch, yaw } = robot.attitude()?;
                Reply::Three([roll, pitch, yaw])
            }
            Request::TurnRates => Reply::Three(robot.turn_rates()?.into()),
            Request::Acceleration => Reply::Three(robot.acceleration()?.into()),
            Request::RobotAt(id) => {
                let index = self.robot_index(id)?;
                // The poses of others depend on their programs, which may be behind; its own does not.
                if index != self.index {
                    self.robot.wait(0.0)?;
                }
                Reply::Pose(self.truth.pose(index)?, self.truth.pose_in_space(index)?.position.z)
            }
            Request::PlaceRobot(id, pose, z) => {
                let index = self.robot_index(id)?;
                self.moves(|truth, by| truth.drop_robot(by, index, pose, z))?;
                self.check_place(pose, &format!("robot {}", index + 1), |scene| {
                    scene.robots[index].pose = pose;
                    scene.robot_misplacement(index)
                })?
            }
            Request::ObjectAt(id) => {
                let index = self.object_index(id)?;
                self.robot.wait(0.0)?;
                Reply::Pose(self.truth.object(index)?, self.truth.object_elevation(index)?)
            }
            Request::PlaceObject(id, pose) => {
                let index = self.object_index(id)?;
                self.moves(|truth, by| truth.move_object(by, index, pose))?;
                self.check_place(pose, &format!("object {}", index + 1), |scene| {
                    scene.world.objects[index].pose = pose;
                    scene.object_misplacement(index).or_else(|| outside(scene, pose))
                })?
            }
        })
    }

    /// Readings at the end of the last request, which take no program time; stops at the first failure.
    pub fn readings(&mut self, wanted: &[Request]) -> Vec<Reply> {
        let begin = self.now();
        let brief = wanted.iter().take(MOST_READINGS).take_while(|request| request.is_brief());
        let readings = brief.map_while(|request| self.ask(0.0, request).ok()).collect();
        self.ahead = self.now() - begin;
        readings
    }

    /// Lets a time and the duration of a call pass.
    fn wait(&mut self, seconds: f64) -> Result<()> {
        if self.walker.is_none() {
            return self.robot.wait(seconds);
        }
        let mut rest = seconds;
        while rest > STRIDE {
            self.robot.wait(STRIDE - self.identity.call_duration)?;
            rest -= STRIDE;
            self.follow()?;
        }
        self.robot.wait(rest)?;
        self.follow()
    }

    /// Advances a walker to the current time, and its body in the world.
    fn follow(&mut self) -> Result<()> {
        let now = self.now();
        let Some(walker) = &mut self.walker else { return Ok(()) };
        let before = walker.pose();
        walker.live_until(now)?;
        if walker.pose() != before {
            self.truth.move_robot(self.index, self.index, walker.pose())?;
        }
        Ok(())
    }

    /// Executes a walker's own requests; leaves all others to the world.
    fn walk(&mut self, request: &Request) -> Result<Option<Reply>> {
        let no = |device: &str| Err(Error::unsupported(device));
        match *request {
            Request::Pass(seconds) => return self.wait(seconds).map(done).map(Some),
            Request::SetSpeed(_) | Request::Speed | Request::Curve(..) | Request::Motor(..) => {
                return no("wheels");
            }
            Request::Encoder(_) | Request::ResetEncoder(_) => return no("encoder"),
            Request::Distance(sensor) => return no(&Psd(sensor).to_string()),
            _ => {}
        }
        let own = |id| id == 0 || self.robot_index(id).is_ok_and(|index| index == self.index);
        let mine = match *request {
            Request::RobotAt(id) | Request::PlaceRobot(id, ..) => own(id),
            Request::Pose
            | Request::SetPose(_)
            | Request::Remaining
            | Request::IsDone
            | Request::WaitDone
            | Request::IsStalled
            | Request::Servo(..) => true,
            _ => false,
        };
        if !mine {
            return Ok(None);
        }
        self.wait(0.0)?;
        if let Request::PlaceRobot(_, pose, _) = *request {
            self.truth.move_robot(self.index, self.index, pose)?;
        }
        let Some(walker) = &mut self.walker else { return Ok(None) };
        Ok(Some(match *request {
            Request::Pose => Reply::Pose(walker.odometry(), 0.0),
            Request::RobotAt(_) => Reply::Pose(walker.pose(), walker.height()),
            Request::SetPose(pose) => {
                walker.set_odometry(pose);
                Reply::Done
            }
            Request::PlaceRobot(_, pose, _) => done(walker.place(pose)?),
            Request::Servo(servo, position) => done(walker.set_servo(servo, position)?),
            Request::Remaining => Reply::Number(0.0),
            Request::IsDone => Reply::Flag(true),
            Request::IsStalled => Reply::Flag(false),
            _ => Reply::Done,
        }))
    }

    /// Moves something at the next tick, when all robots see it, and waits for that.
    fn moves(&mut self, place: impl FnOnce(&Truth, usize) -> Result<()>) -> Result<()> {
        self.robot.wait(0.0)?;
        place(&self.truth, self.index)?;
        self.robot.wait(TICK)
    }

    /// Says of a thing that was placed at a pose whether it can stand there, among the others where they are.
    fn check_place(
        &mut self,
        pose: Pose,
        what: &str,
        find: impl FnOnce(&mut Scene) -> Option<Misplacement>,
    ) -> Result<Reply> {
        for (index, robot) in self.scene.robots.iter_mut().enumerate() {
            robot.pose = self.truth.pose(index)?;
        }
        for (index, object) in self.scene.world.objects.iter_mut().enumerate() {
            object.pose = self.truth.object(index)?;
        }
        let (x, y) = (units::to_mm(pose.x), units::to_mm(pose.y));
        Ok(find(&mut self.scene).map_or(Reply::Done, |place| {
            Reply::Misplaced(format!("{what} is put to {x:.0}, {y:.0} mm, {place}; expected free floor"))
        }))
    }

    fn robot_index(&self, id: u32) -> Result<usize> {
        if id == 0 { Ok(self.index) } else { index_of("robot", id, &self.numbers.0) }
    }

    fn object_index(&self, id: u32) -> Result<usize> {
        index_of("object", id, &self.numbers.1)
    }

    /// A message with the sender's number.
    fn numbered(&self, message: RadioMessage) -> RadioMessage {
        let index = (message.from as usize).wrapping_sub(1);
        RadioMessage { from: self.numbers.0.get(index).copied().unwrap_or(message.from), ..message }
    }

    fn receive(&mut self, seconds: f64) -> Result<Option<RadioMessage>> {
        let end = self.now() + seconds;
        loop {
            let message = self.robot.receive()?.map(|message| self.numbered(message));
            if message.is_some() || seconds <= 0.0 {
                return Ok(message);
            }
            if self.now() >= end {
                return Ok(None);
            }
            self.robot.wait(TICK)?;
        }
    }
}

/// Whether a pose is beyond floor and walls.
fn outside(scene: &Scene, pose: Pose) -> Option<Misplacement> {
    let walls = scene.world.walls.iter().flat_map(|wall| [wall.line.a, wall.line.b]);
    let ground = Aabb::around(walls).map_or(scene.world.floor, |bounds| bounds.union(&scene.world.floor));
    (!ground.contains(pose.position())).then_some(Misplacement::Outside)
}

fn done((): ()) -> Reply {
    Reply::Done
}

/// Index of the thing with a number. A number used by no thing of its kind counts within the kind, from 1.
fn index_of(what: &str, id: u32, numbers: &[u32]) -> Result<usize> {
    let placed = numbers.iter().position(|&number| number == id);
    let counted = || (id as usize).checked_sub(1).filter(|&index| index < numbers.len());
    placed.or_else(counted).ok_or_else(|| {
        let expected = if numbers.is_empty() {
            format!("none, as the world has no {what}")
        } else {
            format!("one of {numbers:?}, or at most {}", numbers.len())
        };
        Error::invalid_input(what, id, &expected)
    })
}

fn resolution(number: u8) -> Result<Resolution> {
    let found = Resolution::ALL.get(usize::from(number)).copied();
    found.ok_or_else(|| Error::new(ErrorKind::InvalidInput, format!("resolution {number}; expected 0 to 5")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_things_none_is_expected() {
        let error = index_of("object", 2, &[]).unwrap_err().to_string();
        assert!(error.contains("expected none, as the world has no object"), "{error}");
        assert_eq!(index_of("object", 5, &[5]).unwrap(), 0);
    }
}
