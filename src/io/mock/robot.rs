use std::collections::{BTreeMap, VecDeque};

use image::RgbImage;

use super::call::{Call, difference};
use super::ideal::IdealDrive;
use super::script::Script;
use crate::geometry::{Pose, Twist, Vector3};
use crate::io::{
    Attitude, Error, ErrorKind, Key, Lcd, LidarScan, Pixel, Psd, RadioMessage, Resolution, Result,
};
use crate::kinematics::Displacement;

/// A robot for unit tests of programs: its sensors read what a script says, and it writes down every command.
///
/// It is strict: a reading that no script covers is an error that names the sensor, unless the robot was made
/// [`lenient`](MockRobot::lenient). Its clock moves only when the program waits (and, if asked for, a little with
/// every call). It drives only if given an [ideal drive](MockRobot::with_ideal_drive). Its display works.
///
/// ```
/// use roverlab::geometry::Twist;
/// use roverlab::io::{Call, Clock, DistanceSensors, Drive, Odometry, MockRobot, Psd, Result, Script};
///
/// /// Drives until something is nearer than 20 cm; gives the distance that is left.
/// fn approach(robot: &mut (impl Clock + Drive + DistanceSensors)) -> Result<f64> {
///     robot.set_speed(Twist::new(0.1, 0.0))?;
///     loop {
///         let ahead = robot.distance(Psd::FRONT)?;
///         if ahead < 0.2 {
///             robot.set_speed(Twist::STOP)?;
///             return Ok(ahead);
///         }
///         robot.wait(0.5)?;
///     }
/// }
///
/// # fn main() -> Result<()> {
/// // With scripted distances, only the commands matter ...
/// let mut robot = MockRobot::new().with_distance(Psd::FRONT, [0.25, 0.15]);
/// assert_eq!(approach(&mut robot)?, 0.15);
/// robot.assert_calls(&[Call::SetSpeed(Twist::new(0.1, 0.0)), Call::Wait(0.5), Call::SetSpeed(Twist::STOP)]);
///
/// // ... with an ideal drive, where the robot gets to.
/// let mut robot = MockRobot::new()
///     .with_distance(Psd::FRONT, Script::function(|time| Ok(0.98 - 0.1 * time)))
///     .with_ideal_drive();
/// approach(&mut robot)?;
/// assert!((robot.pose()?.x - 0.8).abs() < 1e-9);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Default)]
pub struct MockRobot {
    pub(super) time: f64,
    pub(super) charge: f64,
    pub(super) lenient: bool,
    calls: Vec<Call>,
    pub(super) distances: BTreeMap<Psd, Script<f64>>,
    pub(super) scan: Option<Script<LidarScan>>,
    pub(super) image: Option<Script<RgbImage>>,
    pub(super) resolution: Resolution,
    pub(super) pose: Option<Script<Pose>>,
    pub(super) speed: Option<Script<Twist>>,
    pub(super) remaining: Option<Script<f64>>,
    pub(super) stalled: Option<Script<bool>>,
    pub(super) encoders: BTreeMap<u8, Script<i64>>,
    pub(super) depth: Option<Script<f64>>,
    pub(super) attitude: Option<Script<Attitude>>,
    pub(super) turn_rates: Option<Script<Vector3>>,
    pub(super) acceleration: Option<Script<Vector3>>,
    pub(super) keys: Option<Events<Key>>,
    pub(super) touches: Option<Events<Pixel>>,
    pub(super) radio: Option<(u32, Vec<u32>)>,
    pub(super) messages: Events<RadioMessage>,
    pub(super) drive: Option<IdealDrive>,
    pub(super) display: Lcd,
}

/// Things that happen at set times, in the order of those times.
pub(super) type Events<T> = VecDeque<(f64, T)>;

fn in_order<T>(events: impl IntoIterator<Item = (f64, T)>) -> Events<T> {
    let mut events: Vec<_> = events.into_iter().collect();
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    events.into()
}

/// The oldest event, if its time has come.
pub(super) fn take_due<T>(events: &mut Events<T>, time: f64) -> Option<T> {
    let is_due = events.front().is_some_and(|&(at, _)| at <= time);
    if is_due { events.pop_front().map(|(_, event)| event) } else { None }
}

/// Scripting the robot.
impl MockRobot {
    /// A robot of which nothing is scripted.
    pub fn new() -> Self {
        Self::default()
    }

    /// Readings without a script are quiet instead of errors: nothing in range, an empty scan, a black image, standing still at the
    /// origin, level, no key, touch or message, robot 1 alone on the radio.
    #[must_use]
    pub fn lenient(self) -> Self {
        Self { lenient: true, ..self }
    }

    /// Every call takes this many seconds, before it does what it does.
    #[must_use]
    pub fn with_call_charge(self, seconds: f64) -> Self {
        Self { charge: seconds, ..self }
    }

    /// What a distance sensor reads, in metres.
    #[must_use]
    pub fn with_distance(mut self, sensor: Psd, script: impl Into<Script<f64>>) -> Self {
        self.distances.insert(sensor, script.into());
        self
    }

    /// What the laser scanner reads.
    #[must_use]
    pub fn with_scan(self, script: impl Into<Script<LidarScan>>) -> Self {
        Self { scan: Some(script.into()), ..self }
    }

    /// What the camera sees. Images are given as they are, whatever the resolution.
    #[must_use]
    pub fn with_image(self, script: impl Into<Script<RgbImage>>) -> Self {
        Self { image: Some(script.into()), ..self }
    }

    /// What odometry says of the pose. A script goes before an ideal drive.
    #[must_use]
    pub fn with_pose(self, script: impl Into<Script<Pose>>) -> Self {
        Self { pose: Some(script.into()), ..self }
    }

    /// What odometry says of the speed. A script goes before an ideal drive.
    #[must_use]
    pub fn with_speed(self, script: impl Into<Script<Twist>>) -> Self {
        Self { speed: Some(script.into()), ..self }
    }

    /// What manoeuvres have left, in metres or radians; `is_done` reads it too. A script goes before an ideal drive.
    #[must_use]
    pub fn with_remaining(self, script: impl Into<Script<f64>>) -> Self {
        Self { remaining: Some(script.into()), ..self }
    }

    /// Whether the drive is stalled. A script goes before an ideal drive, which never stalls.
    #[must_use]
    pub fn with_stalled(self, script: impl Into<Script<bool>>) -> Self {
        Self { stalled: Some(script.into()), ..self }
    }

    /// What an encoder reads, in ticks.
    #[must_use]
    pub fn with_encoder(mut self, motor: u8, script: impl Into<Script<i64>>) -> Self {
        self.encoders.insert(motor, script.into());
        self
    }

    /// How deep the pressure sensor says that the robot is, in metres.
    #[must_use]
    pub fn with_depth(self, script: impl Into<Script<f64>>) -> Self {
        Self { depth: Some(script.into()), ..self }
    }

    /// How the inertial unit says that the robot is turned.
    #[must_use]
    pub fn with_attitude(self, script: impl Into<Script<Attitude>>) -> Self {
        Self { attitude: Some(script.into()), ..self }
    }

    /// How the inertial unit says that the robot turns, in radians per second.
    #[must_use]
    pub fn with_turn_rates(self, script: impl Into<Script<Vector3>>) -> Self {
        Self { turn_rates: Some(script.into()), ..self }
    }

    /// What the inertial unit says of the acceleration, in metres per second squared.
    #[must_use]
    pub fn with_acceleration(self, script: impl Into<Script<Vector3>>) -> Self {
        Self { acceleration: Some(script.into()), ..self }
    }

    /// Which keys are pressed, and when in seconds; none at all if empty. Waiting for a key lets time pass until the
    /// next one.
    #[must_use]
    pub fn with_keys(self, presses: impl IntoIterator<Item = (f64, Key)>) -> Self {
        Self { keys: Some(in_order(presses)), ..self }
    }

    /// Where the display is touched, and when in seconds; nowhere if empty.
    #[must_use]
    pub fn with_touches(self, touches: impl IntoIterator<Item = (f64, Pixel)>) -> Self {
        Self { touches: Some(in_order(touches)), ..self }
    }

    /// Gives the robot a radio: its own number, the numbers of all robots, and the messages that arrive, each with
    /// its time in seconds.
    #[must_use]
    pub fn with_radio(
        self,
        id: u32,
        peers: impl Into<Vec<u32>>,
        messages: impl IntoIterator<Item = (f64, RadioMessage)>,
    ) -> Self {
        Self { radio: Some((id, peers.into())), messages: in_order(messages), ..self }
    }

    /// Gives the robot a drive that does exactly what it is told, at once, without limits, and odometry that
    /// measures it exactly.
    #[must_use]
    pub fn with_ideal_drive(self) -> Self {
        Self { drive: Some(IdealDrive::default()), ..self }
    }
}

/// Looking at what the program did.
impl MockRobot {
    /// All commands so far, in order.
    pub fn calls(&self) -> &[Call] {
        &self.calls
    }

    /// All commands since the last time they were taken.
    pub fn take_calls(&mut self) -> Vec<Call> {
        std::mem::take(&mut self.calls)
    }

    /// The robot's time in seconds, without the charge for a call.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Where the ideal drive has taken the robot, whatever odometry is scripted to say; `None` without that drive.
    pub fn ideal_pose(&self) -> Option<Pose> {
        self.drive.as_ref().map(IdealDrive::pose)
    }

    /// The display, to see what it shows.
    pub fn display(&self) -> &Lcd {
        &self.display
    }

    /// Checks that exactly these commands were given, in this order.
    ///
    /// # Panics
    /// If not; the message lists the expected and the actual calls and marks the first that differs.
    #[track_caller]
    pub fn assert_calls(&self, expected: &[Call]) {
        if let Some(text) = difference(expected, &self.calls) {
            panic!("{text}");
        }
    }
}

impl MockRobot {
    pub(super) fn pass(&mut self, seconds: f64) {
        if seconds > 0.0 {
            self.time += seconds;
            if let Some(drive) = &mut self.drive {
                drive.pass(seconds);
            }
        }
    }

    /// Writes down a command that begins.
    pub(super) fn command(&mut self, call: Call) {
        self.calls.push(call);
        self.pass(self.charge);
    }

    /// Where a reading comes from: its script, else the ideal drive or the lenient answer, else nowhere.
    pub(super) fn read<T: Clone>(
        &mut self,
        name: &str,
        script: impl FnOnce(&mut Self) -> Option<&mut Script<T>>,
        otherwise: impl FnOnce(&Self) -> Option<T>,
    ) -> Result<T> {
        self.pass(self.charge);
        let time = self.time;
        if let Some(script) = script(self) {
            return script.next(name, time);
        }
        otherwise(self).ok_or_else(|| unscripted(name))
    }

    pub(super) fn or_quiet<T>(&self, value: T) -> Option<T> {
        self.lenient.then_some(value)
    }

    pub(super) fn by_drive<T>(&self, read: impl FnOnce(&IdealDrive) -> T, quiet: T) -> Option<T> {
        self.drive.as_ref().map(read).or_else(|| self.or_quiet(quiet))
    }

    pub(super) fn start(&mut self, call: Call, motion: Displacement, extent: f64, speed: f64) -> Result<()> {
        self.command(call);
        self.drive.as_mut().map_or(Ok(()), |drive| drive.start(motion, extent, speed))
    }
}

pub(super) fn unscripted(name: &str) -> Error {
    Error::new(ErrorKind::Unsupported, format!("no script says what the {name} reads"))
}
