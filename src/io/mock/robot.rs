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

/// A robot for unit tests of programs: its sensors follow scripts, and it records every command.
///
/// It is strict: a reading without a script is an error that names the sensor, unless the robot is
/// [`lenient`](MockRobot::lenient). Its clock advances only when the program waits and, on request, slightly
/// with every call. It drives only with an [ideal drive](MockRobot::with_ideal_drive). Its display works.
///
/// ```
/// use roverlab::geometry::Twist;
/// use roverlab::io::{Call, Clock, DistanceSensors, Drive, Odometry, MockRobot, Psd, Result, Script};
///
/// /// Drives until something is nearer than 20 cm; returns the remaining distance.
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
/// // With scripted distances the commands are checked ...
/// let mut robot = MockRobot::new().with_distance(Psd::FRONT, [0.25, 0.15]);
/// assert_eq!(approach(&mut robot)?, 0.15);
/// robot.assert_calls(&[Call::SetSpeed(Twist::new(0.1, 0.0)), Call::Wait(0.5), Call::SetSpeed(Twist::STOP)]);
///
/// // ... with an ideal drive, the robot's position.
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

/// Timed events, in order.
pub(super) type Events<T> = VecDeque<(f64, T)>;

fn in_order<T>(events: impl IntoIterator<Item = (f64, T)>) -> Events<T> {
    let mut events: Vec<_> = events.into_iter().collect();
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    events.into()
}

/// The oldest event, if it is due.
pub(super) fn take_due<T>(events: &mut Events<T>, time: f64) -> Option<T> {
    let is_due = events.front().is_some_and(|&(at, _)| at <= time);
    if is_due { events.pop_front().map(|(_, event)| event) } else { None }
}

/// Scripts of the robot.
impl MockRobot {
    /// Creates a robot without scripts.
    pub fn new() -> Self {
        Self::default()
    }

    /// Answers readings without a script quietly instead of with an error: nothing in range, an empty scan, a
    /// black image, standing still at the origin, level, no key, touch or message,
    /// robot 1 alone on the radio.
    #[must_use]
    pub fn lenient(self) -> Self {
        Self { lenient: true, ..self }
    }

    /// Makes every call take this long (s) before it acts.
    #[must_use]
    pub fn with_call_charge(self, seconds: f64) -> Self {
        Self { charge: seconds, ..self }
    }

    /// Scripts a distance sensor (m).
    #[must_use]
    pub fn with_distance(mut self, sensor: Psd, script: impl Into<Script<f64>>) -> Self {
        self.distances.insert(sensor, script.into());
        self
    }

    /// Scripts the laser scanner.
    #[must_use]
    pub fn with_scan(self, script: impl Into<Script<LidarScan>>) -> Self {
        Self { scan: Some(script.into()), ..self }
    }

    /// Scripts the camera. Images are returned as they are, whatever the resolution.
    #[must_use]
    pub fn with_image(self, script: impl Into<Script<RgbImage>>) -> Self {
        Self { image: Some(script.into()), ..self }
    }

    /// Scripts the pose by odometry. Takes precedence over an ideal drive.
    #[must_use]
    pub fn with_pose(self, script: impl Into<Script<Pose>>) -> Self {
        Self { pose: Some(script.into()), ..self }
    }

    /// Scripts the velocity by odometry. Takes precedence over an ideal drive.
    #[must_use]
    pub fn with_speed(self, script: impl Into<Script<Twist>>) -> Self {
        Self { speed: Some(script.into()), ..self }
    }

    /// Scripts the remainder of manoeuvres (m or rad), which `is_done` uses too. Takes precedence over an
    /// ideal drive.
    #[must_use]
    pub fn with_remaining(self, script: impl Into<Script<f64>>) -> Self {
        Self { remaining: Some(script.into()), ..self }
    }

    /// Scripts the stall detector. Takes precedence over an ideal drive, which never stalls.
    #[must_use]
    pub fn with_stalled(self, script: impl Into<Script<bool>>) -> Self {
        Self { stalled: Some(script.into()), ..self }
    }

    /// Scripts an encoder (ticks).
    #[must_use]
    pub fn with_encoder(mut self, motor: u8, script: impl Into<Script<i64>>) -> Self {
        self.encoders.insert(motor, script.into());
        self
    }

    /// Scripts the depth sensor (m).
    #[must_use]
    pub fn with_depth(self, script: impl Into<Script<f64>>) -> Self {
        Self { depth: Some(script.into()), ..self }
    }

    /// Scripts the attitude of the inertial unit.
    #[must_use]
    pub fn with_attitude(self, script: impl Into<Script<Attitude>>) -> Self {
        Self { attitude: Some(script.into()), ..self }
    }

    /// Scripts the turn rates of the inertial unit (rad/s).
    #[must_use]
    pub fn with_turn_rates(self, script: impl Into<Script<Vector3>>) -> Self {
        Self { turn_rates: Some(script.into()), ..self }
    }

    /// Scripts the acceleration of the inertial unit (m/s²).
    #[must_use]
    pub fn with_acceleration(self, script: impl Into<Script<Vector3>>) -> Self {
        Self { acceleration: Some(script.into()), ..self }
    }

    /// Scripts key presses with their times (s); an empty list means none. Waiting for a key advances time to
    /// the next one.
    #[must_use]
    pub fn with_keys(self, presses: impl IntoIterator<Item = (f64, Key)>) -> Self {
        Self { keys: Some(in_order(presses)), ..self }
    }

    /// Scripts touches of the display with their times (s); an empty list means none.
    #[must_use]
    pub fn with_touches(self, touches: impl IntoIterator<Item = (f64, Pixel)>) -> Self {
        Self { touches: Some(in_order(touches)), ..self }
    }

    /// Adds a radio: the robot's own number, the numbers of all robots, and the incoming messages with their
    /// times (s).
    #[must_use]
    pub fn with_radio(
        self,
        id: u32,
        peers: impl Into<Vec<u32>>,
        messages: impl IntoIterator<Item = (f64, RadioMessage)>,
    ) -> Self {
        Self { radio: Some((id, peers.into())), messages: in_order(messages), ..self }
    }

    /// Adds a drive that executes commands exactly, at once and without limits, with exact odometry.
    #[must_use]
    pub fn with_ideal_drive(self) -> Self {
        Self { drive: Some(IdealDrive::default()), ..self }
    }
}

/// Inspection of what the program did.
impl MockRobot {
    /// All commands so far, in order.
    pub fn calls(&self) -> &[Call] {
        &self.calls
    }

    /// All commands since the last call of this method.
    pub fn take_calls(&mut self) -> Vec<Call> {
        std::mem::take(&mut self.calls)
    }

    /// Time of the robot (s), without the charge for a call.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Pose of the ideal drive, whatever odometry is scripted to return; `None` without that drive.
    pub fn ideal_pose(&self) -> Option<Pose> {
        self.drive.as_ref().map(IdealDrive::pose)
    }

    /// The display, for inspection.
    pub fn display(&self) -> &Lcd {
        &self.display
    }

    /// Checks that exactly these commands were given, in this order.
    ///
    /// # Panics
    /// If not; the message lists expected and actual calls and marks the first difference.
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

    /// Records a command.
    pub(super) fn command(&mut self, call: Call) {
        self.calls.push(call);
        self.pass(self.charge);
    }

    /// A reading: from its script, else the ideal drive or the lenient answer, else an error.
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
