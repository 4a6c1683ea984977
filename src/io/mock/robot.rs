use std::collections::{BTreeMap, VecDeque};

use image::RgbImage;

use super::call::{Call, difference};
use super::ideal::IdealDrive;
use super::script::Script;
use crate::geometry::{Pose, Twist};
use crate::io::error::require_finite;
use crate::io::sim::Lcd;
use crate::io::{
    Clock, Display, DisplayOption, DistanceSensors, Drive, Encoders, Error, ErrorKind, Fill, Font, Key, Keys,
    Lidar, LidarScan, LidarSettings, Motors, Picture, Pixel, Psd, Radio, RadioMessage, Result, Servos,
    Viewport,
};
use crate::kinematics::Displacement;
use crate::world::Colour;

/// A robot for unit tests of programs: its sensors read what a script says, and it writes down every command.
///
/// It is strict: a reading that no script covers is an error that names the sensor, unless the robot was made
/// [`lenient`](MockRobot::lenient). Its clock moves only when the program waits (and, if asked for, a little with
/// every call). It drives only if given an [ideal drive](MockRobot::with_ideal_drive). Its display works.
///
/// ```
/// use roverlab::geometry::Twist;
/// use roverlab::io::{Call, Clock, DistanceSensors, Drive, MockRobot, Psd, Result, Script};
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
    time: f64,
    charge: f64,
    lenient: bool,
    calls: Vec<Call>,
    distances: BTreeMap<Psd, Script<f64>>,
    scan: Option<Script<LidarScan>>,
    pose: Option<Script<Pose>>,
    speed: Option<Script<Twist>>,
    remaining: Option<Script<f64>>,
    stalled: Option<Script<bool>>,
    encoders: BTreeMap<u8, Script<i64>>,
    keys: Option<Events<Key>>,
    touches: Option<Events<Pixel>>,
    radio: Option<(u32, Vec<u32>)>,
    messages: Events<RadioMessage>,
    drive: Option<IdealDrive>,
    display: Lcd,
}

/// Things that happen at set times, in the order of those times.
type Events<T> = VecDeque<(f64, T)>;

fn in_order<T>(events: impl IntoIterator<Item = (f64, T)>) -> Events<T> {
    let mut events: Vec<_> = events.into_iter().collect();
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    events.into()
}

/// The oldest event, if its time has come.
fn take_due<T>(events: &mut Events<T>, time: f64) -> Option<T> {
    let is_due = events.front().is_some_and(|&(at, _)| at <= time);
    if is_due { events.pop_front().map(|(_, event)| event) } else { None }
}

/// Scripting the robot.
impl MockRobot {
    /// A robot of which nothing is scripted.
    pub fn new() -> Self {
        Self::default()
    }

    /// Readings without a script are quiet instead of errors: nothing in range, an empty scan, standing still at the
    /// origin, no key, touch or message, robot 1 alone on the radio.
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
    fn pass(&mut self, seconds: f64) {
        if seconds > 0.0 {
            self.time += seconds;
            if let Some(drive) = &mut self.drive {
                drive.pass(seconds);
            }
        }
    }

    /// Writes down a command that begins.
    fn command(&mut self, call: Call) {
        self.calls.push(call);
        self.pass(self.charge);
    }

    /// Where a reading comes from: its script, else the ideal drive or the lenient answer, else nowhere.
    fn read<T: Clone>(
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

    fn or_quiet<T>(&self, value: T) -> Option<T> {
        self.lenient.then_some(value)
    }

    fn by_drive<T>(&self, read: impl FnOnce(&IdealDrive) -> T, quiet: T) -> Option<T> {
        self.drive.as_ref().map(read).or_else(|| self.or_quiet(quiet))
    }

    fn start(&mut self, call: Call, motion: Displacement, extent: f64, speed: f64) -> Result<()> {
        self.command(call);
        self.drive.as_mut().map_or(Ok(()), |drive| drive.start(motion, extent, speed))
    }
}

fn unscripted(name: &str) -> Error {
    Error::new(ErrorKind::Unsupported, format!("no script says what the {name} reads"))
}

impl Clock for MockRobot {
    fn now(&mut self) -> Result<f64> {
        self.pass(self.charge);
        Ok(self.time)
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.command(Call::Wait(seconds));
        require_finite("waiting time", seconds)?;
        self.pass(seconds);
        Ok(())
    }
}

impl DistanceSensors for MockRobot {
    fn distance(&mut self, sensor: Psd) -> Result<f64> {
        let name = sensor.to_string();
        self.read(&name, |robot| robot.distances.get_mut(&sensor), |robot| robot.or_quiet(f64::INFINITY))
    }
}

impl Lidar for MockRobot {
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
        let reading =
            self.read("lidar", |robot| robot.scan.as_mut(), |robot| robot.or_quiet(LidarScan::default()))?;
        *scan = reading;
        Ok(())
    }

    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()> {
        self.command(Call::ConfigureLidar(settings));
        settings.validate()
    }
}

impl Drive for MockRobot {
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        self.command(Call::SetSpeed(twist));
        self.drive.as_mut().map_or(Ok(()), |drive| drive.set_speed(twist))
    }

    fn speed(&mut self) -> Result<Twist> {
        self.read(
            "speed",
            |robot| robot.speed.as_mut(),
            |robot| robot.by_drive(IdealDrive::speed, Twist::STOP),
        )
    }

    fn pose(&mut self) -> Result<Pose> {
        self.read(
            "pose",
            |robot| robot.pose.as_mut(),
            |robot| robot.by_drive(IdealDrive::pose, Pose::default()),
        )
    }

    fn set_pose(&mut self, pose: Pose) -> Result<()> {
        self.command(Call::SetPose(pose));
        if let Some(drive) = &mut self.drive {
            drive.set_pose(pose);
        }
        Ok(())
    }

    fn straight(&mut self, distance: f64, speed: f64) -> Result<()> {
        let motion = Displacement { length: distance, angle: 0.0 };
        self.start(Call::Straight(distance, speed), motion, distance, speed)
    }

    fn turn(&mut self, angle: f64, speed: f64) -> Result<()> {
        self.start(Call::Turn(angle, speed), Displacement { length: 0.0, angle }, angle, speed)
    }

    fn curve(&mut self, length: f64, angle: f64, speed: f64) -> Result<()> {
        self.start(Call::Curve(length, angle, speed), Displacement { length, angle }, length, speed)
    }

    fn remaining(&mut self) -> Result<f64> {
        self.read(
            "rest of the manoeuvre",
            |robot| robot.remaining.as_mut(),
            |robot| robot.by_drive(IdealDrive::remaining, 0.0),
        )
    }

    fn is_done(&mut self) -> Result<bool> {
        Ok(self.remaining()? == 0.0)
    }

    fn wait_done(&mut self) -> Result<()> {
        self.command(Call::WaitDone);
        let seconds = self.drive.as_ref().map_or(0.0, IdealDrive::seconds_left);
        self.pass(seconds);
        Ok(())
    }

    fn is_stalled(&mut self) -> Result<bool> {
        self.read("stall detector", |robot| robot.stalled.as_mut(), |robot| robot.by_drive(|_| false, false))
    }
}

impl Encoders for MockRobot {
    fn encoder(&mut self, motor: u8) -> Result<i64> {
        let name = format!("encoder {motor}");
        self.read(&name, |robot| robot.encoders.get_mut(&motor), |robot| robot.or_quiet(0))
    }

    fn reset_encoder(&mut self, motor: u8) -> Result<()> {
        self.command(Call::ResetEncoder(motor));
        Ok(())
    }
}

impl Motors for MockRobot {
    fn set_motor(&mut self, motor: u8, fraction: f64) -> Result<()> {
        self.command(Call::SetMotor(motor, fraction));
        Ok(())
    }
}

impl Servos for MockRobot {
    fn set_servo(&mut self, servo: u8, position: f64) -> Result<()> {
        self.command(Call::SetServo(servo, position));
        Ok(())
    }
}

impl Keys for MockRobot {
    fn read_key(&mut self) -> Result<Option<Key>> {
        self.pass(self.charge);
        match &mut self.keys {
            Some(keys) => Ok(take_due(keys, self.time)),
            None => self.or_quiet(None).ok_or_else(|| unscripted("keypad")),
        }
    }

    fn wait_key(&mut self) -> Result<Key> {
        self.command(Call::WaitKey);
        let keys = self.keys.as_mut().ok_or_else(|| unscripted("keypad"))?;
        let (at, key) = keys.pop_front().ok_or_else(|| {
            Error::new(ErrorKind::EndOfLog, "the script of the keypad has no more keys to wait for")
        })?;
        self.pass(at - self.time);
        Ok(key)
    }

    fn read_touch(&mut self) -> Result<Option<Pixel>> {
        self.pass(self.charge);
        match &mut self.touches {
            Some(touches) => Ok(take_due(touches, self.time)),
            None => self.or_quiet(None).ok_or_else(|| unscripted("touch screen")),
        }
    }
}

impl Radio for MockRobot {
    fn radio_id(&mut self) -> Result<u32> {
        self.pass(self.charge);
        self.radio.as_ref().map(|r| r.0).or_else(|| self.or_quiet(1)).ok_or_else(|| unscripted("radio"))
    }

    fn radio_peers(&mut self) -> Result<Vec<u32>> {
        self.pass(self.charge);
        let peers = self.radio.as_ref().map(|r| r.1.clone());
        peers.or_else(|| self.or_quiet(vec![1])).ok_or_else(|| unscripted("radio"))
    }

    fn send(&mut self, to: u32, data: &[u8]) -> Result<()> {
        self.command(Call::Send(to, data.to_vec()));
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<RadioMessage>> {
        self.pass(self.charge);
        if self.radio.is_none() && !self.lenient {
            return Err(unscripted("radio"));
        }
        Ok(take_due(&mut self.messages, self.time))
    }
}

impl Display for MockRobot {
    fn print(&mut self, text: &str) -> Result<()> {
        self.command(Call::Print(text.to_owned()));
        self.display.print(text)
    }

    fn set_cursor(&mut self, row: i32, column: i32) -> Result<()> {
        self.command(Call::SetCursor(row, column));
        self.display.set_cursor(row, column)
    }

    fn cursor(&mut self) -> Result<(i32, i32)> {
        self.pass(self.charge);
        self.display.cursor()
    }

    fn set_text_colours(&mut self, foreground: Colour, background: Colour) -> Result<()> {
        self.command(Call::SetTextColours(foreground, background));
        self.display.set_text_colours(foreground, background)
    }

    fn set_font(&mut self, font: Font) -> Result<()> {
        self.command(Call::SetFont(font));
        self.display.set_font(font)
    }

    fn clear_display(&mut self) -> Result<()> {
        self.command(Call::ClearDisplay);
        self.display.clear_display()
    }

    fn display_size(&mut self) -> Result<(i32, i32)> {
        self.pass(self.charge);
        self.display.display_size()
    }

    fn set_pixel(&mut self, at: Pixel, colour: Colour) -> Result<()> {
        self.command(Call::SetPixel(at, colour));
        self.display.set_pixel(at, colour)
    }

    fn pixel(&mut self, at: Pixel) -> Result<Option<Colour>> {
        self.pass(self.charge);
        self.display.pixel(at)
    }

    fn draw_line(&mut self, from: Pixel, to: Pixel, colour: Colour) -> Result<()> {
        self.command(Call::DrawLine(from, to, colour));
        self.display.draw_line(from, to, colour)
    }

    fn draw_rectangle(&mut self, corner: Pixel, opposite: Pixel, colour: Colour, fill: Fill) -> Result<()> {
        self.command(Call::DrawRectangle(corner, opposite, colour, fill));
        self.display.draw_rectangle(corner, opposite, colour, fill)
    }

    fn draw_circle(&mut self, centre: Pixel, diameter: i32, colour: Colour, fill: Fill) -> Result<()> {
        self.command(Call::DrawCircle(centre, diameter, colour, fill));
        self.display.draw_circle(centre, diameter, colour, fill)
    }

    fn draw_image(&mut self, picture: Picture<'_>, viewport: Viewport) -> Result<()> {
        self.command(Call::DrawImage(picture.dimensions(), viewport));
        self.display.draw_image(picture, viewport)
    }

    fn set_menu_label(
        &mut self,
        key: Key,
        label: &str,
        foreground: Colour,
        background: Colour,
    ) -> Result<()> {
        self.command(Call::SetMenuLabel(key, label.to_owned(), foreground, background));
        self.display.set_menu_label(key, label, foreground, background)
    }

    fn set_menu(&mut self, labels: [&str; 4]) -> Result<()> {
        self.command(Call::SetMenu(labels.map(str::to_owned)));
        self.display.set_menu(labels)
    }

    fn set_display_option(&mut self, option: DisplayOption, on: bool) -> Result<()> {
        self.command(Call::SetDisplayOption(option, on));
        self.display.set_display_option(option, on)
    }

    fn refresh(&mut self) -> Result<()> {
        self.command(Call::Refresh);
        self.display.refresh()
    }

    fn screenshot(&mut self) -> Result<RgbImage> {
        self.pass(self.charge);
        self.display.screenshot()
    }
}
