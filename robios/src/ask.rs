//! What a program's library asks the world for, and who answers.

use std::fmt;

use image::RgbImage;
use roverlab::geometry::{Pose, Twist};
use roverlab::io::sim::{SimOptions, Simulation, TICK, Truth};
use roverlab::io::{
    Attitude, Error, ErrorKind, LidarScan, LidarSettings, Psd, RadioMessage, Resolution, Result, RobotIo,
};
use roverlab::world::{DriveSpec, InertialSpec, RobotSpec, Scene};

use crate::walker::Walker;

/// One thing that the world is asked for. Lengths are metres, angles radians.
#[derive(Debug, Clone, PartialEq)]
pub enum Request {
    /// Who the robot is; see [`Identity`].
    Identity,
    /// Lets so many seconds pass.
    Pass(f64),
    /// Drives at a speed.
    SetSpeed(Twist),
    /// The speed that odometry measures.
    Speed,
    /// The pose by odometry.
    Pose,
    /// Sets the pose by odometry.
    SetPose(Pose),
    /// Drives an arc: its length, its angle and the speed along it.
    Curve(f64, f64, f64),
    /// What is left of the running manoeuvre.
    Remaining,
    /// Whether no manoeuvre is running.
    IsDone,
    /// Waits until the running manoeuvre has ended or stalled.
    WaitDone,
    /// Whether something holds the robot.
    IsStalled,
    /// The reading of a distance sensor.
    Distance(u8),
    /// A scan of the lidar.
    Scan,
    /// How the lidar scans from now on.
    ConfigureLidar(LidarSettings),
    /// The size of images from now on, by its place in [`Resolution::ALL`].
    SetResolution(u8),
    /// An image of the camera.
    Image,
    /// Sends a message to a robot.
    Send(u32, Vec<u8>),
    /// The numbers of all robots.
    Numbers,
    /// The oldest message that has not been received; waits for so many seconds at most.
    Receive(f64),
    /// Drives a motor with a fraction of its full speed.
    Motor(u8, f64),
    /// Moves a servo to a position, -1 to 1.
    Servo(u8, f64),
    /// An encoder's ticks.
    Encoder(u8),
    /// Sets an encoder's count to zero.
    ResetEncoder(u8),
    /// The depth by the pressure sensor.
    Depth,
    /// The attitude by the inertial unit: roll, pitch and yaw.
    Attitude,
    /// Its turn rates about the forward, left and upright axes.
    TurnRates,
    /// Its accelerations along these axes.
    Acceleration,
    /// Where a robot truly is, by its number; 0 is the robot that asks.
    RobotAt(u32),
    /// Puts a robot somewhere else; on hills it drops from so many metres above the floor.
    PlaceRobot(u32, Pose, f64),
    /// Where an object truly is, by its number.
    ObjectAt(u32),
    /// Puts an object somewhere else.
    PlaceObject(u32, Pose),
}

impl Request {
    /// Whether it is a reading of few bytes, which changes nothing and nothing of which is known but by the
    /// tick.
    pub fn is_brief(&self) -> bool {
        matches!(
            self,
            Self::Speed
                | Self::Pose
                | Self::Remaining
                | Self::IsDone
                | Self::IsStalled
                | Self::Distance(_)
                | Self::Encoder(_)
        )
    }
}

/// What the world answers.
#[derive(Debug, Clone, PartialEq)]
pub enum Reply {
    /// It is done.
    Done,
    /// Yes or no.
    Flag(bool),
    /// A number.
    Number(f64),
    /// A count.
    Count(i64),
    /// A speed.
    Twist(Twist),
    /// Three numbers.
    Three([f64; 3]),
    /// A pose, and metres above the floor.
    Pose(Pose, f64),
    /// Distances counter-clockwise; infinity where there is no return.
    Ranges(Vec<f64>),
    /// An image.
    Image(RgbImage),
    /// A message, if there is one.
    Message(Option<RadioMessage>),
    /// Numbers of robots.
    Numbers(Vec<u32>),
    /// Who the robot is.
    Identity(Identity),
}

/// What a library has to know about its robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identity {
    /// Its number, from 1, in the row of all robots and objects.
    pub id: u32,
    /// How many robots there are.
    pub robots: u32,
    /// How many objects there are.
    pub objects: u32,
    /// The fastest that its wheels' rims move, in metres per second.
    pub top_speed: f64,
    /// The rims' speed, in metres per second, that a motor's 100 percent stand for.
    pub full_speed: f64,
    /// Metres that a wheel rolls in a tick of its encoder.
    pub tick_length: f64,
    /// Beams in a scan.
    pub lidar_points: u32,
    /// Whether scans go all round.
    pub full_turn: bool,
    /// Seconds that a call takes.
    pub call_duration: f64,
    /// Seconds after which every call fails; infinity if there is no such time.
    pub time_limit: f64,
    /// Whether a reading is the same when it is taken again at the same time, and nobody minds if it is not.
    pub exact: bool,
    /// Whether it has a camera.
    pub camera: bool,
    /// The channel of its depth sensor; 0 without one.
    pub depth_channel: u8,
    /// What its inertial unit measures, and on which channels.
    pub inertial: InertialSpec,
}

/// EyeSim drives motors with percentages of this speed, in metres per second, whatever they could do.
const FULL_SPEED: f64 = 0.4;
/// The same for cars.
const FULL_SPEED_OF_CARS: f64 = 0.5;

/// Readings that come along with an answer.
pub const MOST_READINGS: usize = 16;
/// Seconds after which the body of a walker follows it.
const STRIDE: f64 = 0.05;

/// On what terms a program drives its robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terms {
    /// Seconds that a call takes.
    pub call_duration: f64,
    /// Seconds after which every call fails.
    pub time_limit: Option<f64>,
    /// Whether readings may be remembered as long as nothing can have changed them.
    pub exact: bool,
}

impl Terms {
    /// Those of a simulation. Readings with noise are drawn anew each time.
    pub fn of(options: &SimOptions) -> Self {
        let exact = options.noise.range == 0.0;
        Self { call_duration: options.call_duration, time_limit: options.time_limit, exact }
    }
}

/// Someone who drives one robot of a simulation.
pub struct Seat {
    robot: Box<dyn RobotIo + Send>,
    truth: Truth,
    identity: Identity,
    index: usize,
    /// The numbers of the robots and of the objects.
    numbers: (Vec<u32>, Vec<u32>),
    scan: LidarScan,
    walker: Option<Walker>,
    /// Seconds that readings have taken which were not called for.
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
    /// Takes a robot of a simulation of a scene.
    pub fn take(simulation: &Simulation, scene: &Scene, index: usize, terms: Terms) -> Result<Self> {
        Ok(Self::of(Box::new(simulation.robot(index)?), simulation, scene, index, terms))
    }

    /// Takes a robot that has been taken, and may have been wrapped.
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
        let numbers = (scene.robot_numbers(), scene.object_numbers());
        let identity = Identity {
            id: numbers.0[index],
            robots: scene.robots.len() as u32,
            objects: scene.world.objects.len() as u32,
            top_speed,
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
        Self { robot, truth, identity, index, numbers, scan, walker, ahead: 0.0 }
    }

    /// Who the robot is.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// The truth about the world.
    pub fn truth(&self) -> &Truth {
        &self.truth
    }

    /// The robot's index in the scene.
    pub fn index(&self) -> usize {
        self.index
    }

    /// Where a walker believes to be, and how far it has walked; of one on wheels, the world knows.
    pub fn walked(&self) -> Option<(Pose, f64)> {
        self.walker.as_ref().map(|walker| (walker.odometry(), walker.walked()))
    }

    /// The robot's own time in seconds.
    pub fn now(&mut self) -> f64 {
        self.robot.peek_time().unwrap_or_default()
    }

    /// Lets `debt` seconds pass that calls without the world have taken, and answers.
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
                // Where others are depends on their programs, which may be behind; where it is itself does not.
                if index != self.index {
                    self.robot.wait(0.0)?;
                }
                Reply::Pose(self.truth.pose(index)?, self.truth.pose_in_space(index)?.position.z)
            }
            Request::PlaceRobot(id, pose, z) => {
                let index = self.robot_index(id)?;
                self.moves(|truth, by| truth.drop_robot(by, index, pose, z))?
            }
            Request::ObjectAt(id) => {
                let index = self.object_index(id)?;
                self.robot.wait(0.0)?;
                Reply::Pose(self.truth.object(index)?, self.truth.object_elevation(index)?)
            }
            Request::PlaceObject(id, pose) => {
                let index = self.object_index(id)?;
                self.moves(|truth, by| truth.move_object(by, index, pose))?
            }
        })
    }

    /// Readings at the end of the last request, which take no time of the program's; as many as can be taken.
    pub fn readings(&mut self, wanted: &[Request]) -> Vec<Reply> {
        let begin = self.now();
        let brief = wanted.iter().take(MOST_READINGS).take_while(|request| request.is_brief());
        let readings = brief.map_while(|request| self.ask(0.0, request).ok()).collect();
        self.ahead = self.now() - begin;
        readings
    }

    /// Lets seconds pass, and the time of a call.
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

    /// Lets a walker live until now, and its body in the world follow.
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

    /// What a walker does itself; everything else is left to the world.
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

    /// Has something put somewhere else, at the next tick as all others see it too, and waits for it.
    fn moves(&mut self, place: impl FnOnce(&Truth, usize) -> Result<()>) -> Result<Reply> {
        self.robot.wait(0.0)?;
        place(&self.truth, self.index)?;
        Ok(done(self.robot.wait(TICK)?))
    }

    fn robot_index(&self, id: u32) -> Result<usize> {
        if id == 0 { Ok(self.index) } else { index_of("robot", id, &self.numbers.0) }
    }

    fn object_index(&self, id: u32) -> Result<usize> {
        index_of("object", id, &self.numbers.1)
    }

    /// A message with its sender's number.
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

fn done((): ()) -> Reply {
    Reply::Done
}

/// The index of the thing that has a number. Numbers that none of its kind has count its kind alone, from 1.
fn index_of(what: &str, id: u32, numbers: &[u32]) -> Result<usize> {
    let placed = numbers.iter().position(|&number| number == id);
    let counted = || (id as usize).checked_sub(1).filter(|&index| index < numbers.len());
    placed.or_else(counted).ok_or_else(|| {
        Error::invalid_input(what, id, &format!("one of {numbers:?}, or at most {}", numbers.len()))
    })
}

fn resolution(number: u8) -> Result<Resolution> {
    let found = Resolution::ALL.get(usize::from(number)).copied();
    found.ok_or_else(|| Error::new(ErrorKind::InvalidInput, format!("resolution {number}; expected 0 to 5")))
}

/// The top speed of the wheels' rims, the speed that 100 percent stand for, and the length of an encoder's tick.
fn speeds(spec: &RobotSpec) -> (f64, f64, f64) {
    let (diameter, fastest, ticks, full) = match spec.drive {
        DriveSpec::Differential { wheel_diameter, max_wheel_speed, ticks_per_turn, .. }
        | DriveSpec::Tracked { wheel_diameter, max_wheel_speed, ticks_per_turn, .. }
        | DriveSpec::Omni { wheel_diameter, max_wheel_speed, ticks_per_turn, .. } => {
            (wheel_diameter, max_wheel_speed, ticks_per_turn, FULL_SPEED)
        }
        DriveSpec::Ackermann { wheel_diameter, max_wheel_speed, ticks_per_turn, .. } => {
            (wheel_diameter, max_wheel_speed, ticks_per_turn, FULL_SPEED_OF_CARS)
        }
        // Thrusters: as if wheels of 2 m turned so that their rims have its top speed.
        DriveSpec::Craft(_) => (2.0, spec.drive.top_speed(), 1.0, FULL_SPEED),
        _ => (0.0, 0.0, 1.0, FULL_SPEED),
    };
    let top_speed = 0.5 * diameter * fastest;
    (top_speed, full.min(top_speed), std::f64::consts::PI * diameter / ticks)
}
