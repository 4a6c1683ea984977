use ambassador::Delegate;
use image::RgbImage;

use crate::geometry::{Pose, Twist, Vector3, math, normalize_angle, units};
use crate::io::delegate::ambassador_impl_StallDetector;
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Error, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres, Motors,
    Odometry, Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::world::{Colour, PsdSpec};

/// A robot with RoBIOS's numbers: whole millimetres, degrees, milliseconds and percent, and a maximum
/// distance of 9.999 m.
///
/// Values and timing match the same robot behind RoBIOS's C library: setting a font takes two calls,
/// receiving a message two, reading the clock one, and an image a thirtieth of a second.
///
/// ```
/// use roverlab::io::wrappers::Quantised;
/// use roverlab::io::{DistanceSensors, MockRobot, Psd};
///
/// # fn main() -> roverlab::io::Result<()> {
/// let mut robot = Quantised::new(MockRobot::new().with_distance(Psd::FRONT, 0.123_7));
/// assert_eq!(robot.distance(Psd::FRONT)?, 0.124);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Delegate)]
#[delegate(StallDetector, target = "inner")]
pub struct Quantised<R> {
    inner: R,
    motor_scale: f64,
    resolution: Resolution,
    camera_is_on: bool,
    radio_is_on: bool,
    turns: bool,
}

/// Minimum distance (m): 0 would mean a missing sensor.
const NEAREST: f64 = 0.001;
/// Duration of an image through RoBIOS (s).
const FRAME: f64 = 0.033;

impl<R> Quantised<R> {
    /// Rounds a robot's numbers.
    pub fn new(inner: R) -> Self {
        Self {
            inner,
            motor_scale: 1.0,
            resolution: Resolution::default(),
            camera_is_on: false,
            radio_is_on: false,
            turns: false,
        }
    }

    /// Sets the fraction of a motor's full speed that corresponds to RoBIOS's 100 percent.
    #[must_use]
    pub fn with_motor_scale(self, motor_scale: f64) -> Self {
        Self { motor_scale, ..self }
    }

    /// The wrapped robot.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The wrapped robot, without rounding.
    pub fn into_inner(self) -> R {
        self.inner
    }
}

impl<R: Clock> Quantised<R> {
    /// Starting RoBIOS's radio takes a call.
    fn start_radio(&mut self) -> Result<()> {
        if !std::mem::replace(&mut self.radio_is_on, true) {
            self.inner.wait(0.0)?;
        }
        Ok(())
    }
}

/// The nearest integer in a unit, without negative zero.
fn whole(value: f64, unit: fn(f64) -> f64) -> f64 {
    unit(value.round() + 0.0)
}

/// The nearest whole millimetre.
fn length(metres: f64) -> f64 {
    whole(units::to_mm(metres), units::from_mm)
}

/// The nearest whole degree.
fn angle(radians: f64) -> f64 {
    whole(units::to_deg(radians), units::from_deg)
}

/// The nearest tenth of a degree.
fn tenths(radians: f64) -> f64 {
    units::from_deg((10.0 * units::to_deg(radians)).round() / 10.0 + 0.0)
}

fn pose(pose: Pose) -> Pose {
    let degrees = units::to_deg(normalize_angle(pose.heading)).round() + 0.0;
    let degrees = if degrees == -180.0 { 180.0 } else { degrees };
    Pose::new(length(pose.x), length(pose.y), units::from_deg(degrees))
}

fn range(metres: f64) -> f64 {
    let millimetres = units::to_mm(metres).round();
    if millimetres < units::to_mm(PsdSpec::DEFAULT_MAX_RANGE) {
        units::from_mm(millimetres.max(0.0))
    } else {
        f64::INFINITY
    }
}

impl<R: Clock> Clock for Quantised<R> {
    fn now(&mut self) -> Result<f64> {
        let milliseconds = (1000.0 * self.inner.now()? + 1e-6).floor();
        Ok(milliseconds / 1000.0)
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.inner.wait((1000.0 * seconds).round() / 1000.0)
    }

    // RoBIOS has no clock without cost.
    fn peek_time(&mut self) -> Result<f64> {
        self.now()
    }
}

impl<R: Drive> Drive for Quantised<R> {
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        self.inner.set_speed(Twist::new(length(twist.linear), angle(twist.angular)))
    }
}

impl<R: Odometry> Odometry for Quantised<R> {
    fn speed(&mut self) -> Result<Twist> {
        let twist = self.inner.speed()?;
        Ok(Twist::new(length(twist.linear), angle(twist.angular)))
    }

    fn pose(&mut self) -> Result<Pose> {
        self.inner.pose().map(pose)
    }

    fn set_pose(&mut self, wanted: Pose) -> Result<()> {
        self.inner.set_pose(pose(wanted))
    }
}

impl<R: Manoeuvres> Manoeuvres for Quantised<R> {
    fn straight(&mut self, distance: f64, speed: f64) -> Result<()> {
        self.turns = false;
        self.inner.straight(length(distance), length(speed).abs())
    }

    fn turn(&mut self, turn: f64, speed: f64) -> Result<()> {
        self.turns = true;
        self.inner.turn(angle(turn), angle(speed).abs())
    }

    fn curve(&mut self, distance: f64, turn: f64, speed: f64) -> Result<()> {
        let distance = length(distance);
        self.turns = distance == 0.0;
        let speed = if self.turns { angle(speed) } else { length(speed) };
        self.inner.curve(distance, angle(turn), speed.abs())
    }

    fn drive_to(&mut self, forward: f64, left: f64, speed: f64) -> Result<()> {
        let (x, y) = (units::to_mm(forward).round(), units::to_mm(left).round());
        if y == 0.0 {
            return self.straight(forward, speed);
        }
        let half = math::atan2(y, x);
        // RoBIOS truncates to whole millimetres and degrees here.
        let distance = (math::hypot(x, y) * half / math::sin(half)).trunc();
        let turn = (2.0 * units::to_deg(half)).trunc();
        self.curve(units::from_mm(distance), units::from_deg(turn), speed)
    }

    fn remaining(&mut self) -> Result<f64> {
        let rest = self.inner.remaining()?;
        Ok(if self.turns { angle(rest) } else { length(rest) })
    }

    fn is_done(&mut self) -> Result<bool> {
        self.inner.is_done()
    }

    fn wait_done(&mut self) -> Result<()> {
        self.inner.wait_done()
    }
}

impl<R: DistanceSensors> DistanceSensors for Quantised<R> {
    /// In RoBIOS a distance of 0 means a missing sensor.
    fn distance(&mut self, sensor: Psd) -> Result<f64> {
        Ok(range(self.inner.distance(sensor)?).max(NEAREST))
    }
}

impl<R: Lidar> Lidar for Quantised<R> {
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
        self.inner.scan_into(scan)?;
        scan.range_max = scan.range_max.min(PsdSpec::DEFAULT_MAX_RANGE);
        scan.ranges.iter_mut().for_each(|distance| *distance = range(*distance));
        Ok(())
    }

    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()> {
        let degrees = units::to_deg(settings.field_of_view).round();
        let field_of_view = if degrees == 360.0 { std::f64::consts::TAU } else { units::from_deg(degrees) };
        let tilt = angle(settings.tilt);
        self.inner.configure_lidar(LidarSettings { field_of_view, tilt, ..settings })
    }
}

impl<R: Camera + Clock> Camera for Quantised<R> {
    fn set_resolution(&mut self, resolution: Resolution) -> Result<()> {
        self.inner.set_resolution(resolution)?;
        self.resolution = resolution;
        self.camera_is_on = true;
        Ok(())
    }

    /// The last value set: RoBIOS cannot read it.
    fn resolution(&mut self) -> Result<Resolution> {
        Ok(self.resolution)
    }

    fn image_into(&mut self, image: &mut RgbImage) -> Result<()> {
        if !self.camera_is_on {
            self.set_resolution(self.resolution)?;
        }
        self.inner.image_into(image)?;
        self.inner.wait(FRAME)
    }
}

impl<R: Display + Clock> Display for Quantised<R> {
    fn print(&mut self, text: &str) -> Result<()> {
        self.inner.print(text)
    }

    fn set_cursor(&mut self, row: i32, column: i32) -> Result<()> {
        self.inner.set_cursor(row, column)
    }

    fn cursor(&mut self) -> Result<(i32, i32)> {
        self.inner.cursor()
    }

    fn set_text_colours(&mut self, foreground: Colour, background: Colour) -> Result<()> {
        self.inner.set_text_colours(foreground, background)
    }

    fn set_font(&mut self, font: Font) -> Result<()> {
        self.inner.set_font(font)?;
        self.inner.wait(0.0)
    }

    fn clear_display(&mut self) -> Result<()> {
        self.inner.clear_display()
    }

    fn display_size(&mut self) -> Result<(i32, i32)> {
        self.inner.display_size()
    }

    fn set_pixel(&mut self, at: Pixel, colour: Colour) -> Result<()> {
        self.inner.set_pixel(at, colour)
    }

    /// RoBIOS returns black for pixels outside the display.
    fn pixel(&mut self, at: Pixel) -> Result<Option<Colour>> {
        Ok(Some(self.inner.pixel(at)?.unwrap_or(Colour::BLACK)))
    }

    fn draw_line(&mut self, from: Pixel, to: Pixel, colour: Colour) -> Result<()> {
        self.inner.draw_line(from, to, colour)
    }

    fn draw_rectangle(&mut self, corner: Pixel, opposite: Pixel, colour: Colour, fill: Fill) -> Result<()> {
        self.inner.draw_rectangle(corner, opposite, colour, fill)
    }

    fn draw_circle(&mut self, centre: Pixel, diameter: i32, colour: Colour, fill: Fill) -> Result<()> {
        self.inner.draw_circle(centre, diameter, colour, fill)
    }

    /// Fails for images of a size that RoBIOS lacks. Takes three calls.
    fn draw_image(&mut self, picture: DisplayImage<'_>, viewport: Viewport) -> Result<()> {
        Resolution::of(picture.dimensions())?;
        self.inner.wait(0.0)?;
        self.inner.wait(0.0)?;
        self.inner.draw_image(picture, viewport)
    }

    fn set_menu_label(
        &mut self,
        key: Key,
        label: &str,
        foreground: Colour,
        background: Colour,
    ) -> Result<()> {
        self.inner.set_menu_label(key, label, foreground, background)
    }

    fn set_menu(&mut self, labels: [&str; 4]) -> Result<()> {
        self.inner.set_menu(labels)
    }

    fn set_display_option(&mut self, option: DisplayOption, on: bool) -> Result<()> {
        self.inner.set_display_option(option, on)
    }

    fn refresh(&mut self) -> Result<()> {
        self.inner.refresh()
    }

    /// RoBIOS cannot read the whole display.
    fn screenshot(&mut self) -> Result<RgbImage> {
        Err(Error::unsupported("way to read its display"))
    }
}

impl<R: Keys> Keys for Quantised<R> {
    fn read_key(&mut self) -> Result<Option<Key>> {
        self.inner.read_key()
    }

    fn wait_key(&mut self) -> Result<Key> {
        self.inner.wait_key()
    }

    fn read_touch(&mut self) -> Result<Option<Pixel>> {
        self.inner.read_touch()
    }
}

impl<R: Radio + Clock> Radio for Quantised<R> {
    fn radio_id(&mut self) -> Result<u32> {
        self.start_radio()?;
        self.inner.radio_id()
    }

    fn radio_peers(&mut self) -> Result<Vec<u32>> {
        self.start_radio()?;
        self.inner.radio_peers()
    }

    /// Messages are texts: not empty, without zero bytes.
    fn send(&mut self, to: u32, data: &[u8]) -> Result<()> {
        self.start_radio()?;
        if data.is_empty() || data.contains(&0) {
            return Err(Error::invalid_input("radio message", format!("{data:?}"), "bytes other than 0"));
        }
        self.inner.send(to, data)
    }

    fn receive(&mut self) -> Result<Option<RadioMessage>> {
        self.start_radio()?;
        let message = self.inner.receive()?;
        if message.is_some() {
            self.inner.wait(0.0)?;
        }
        Ok(message)
    }
}

impl<R: Motors> Motors for Quantised<R> {
    fn set_motor(&mut self, motor: u8, fraction: f64) -> Result<()> {
        self.inner.set_motor(motor, (100.0 * fraction).round() / 100.0 * self.motor_scale)
    }
}

impl<R: Servos> Servos for Quantised<R> {
    /// RoBIOS has 256 positions; 128 is the middle.
    fn set_servo(&mut self, servo: u8, position: f64) -> Result<()> {
        if !(-1.0..=1.0).contains(&position) {
            return Err(Error::invalid_input("servo position", position, "-1 to 1"));
        }
        let whole = (128.0 + 128.0 * position).round().min(255.0);
        self.inner.set_servo(servo, (whole - 128.0) / 128.0)
    }
}

impl<R: Encoders> Encoders for Quantised<R> {
    fn encoder(&mut self, motor: u8) -> Result<i64> {
        self.inner.encoder(motor)
    }

    fn reset_encoder(&mut self, motor: u8) -> Result<()> {
        self.inner.reset_encoder(motor)
    }
}

impl<R: DepthSensor> DepthSensor for Quantised<R> {
    fn depth(&mut self) -> Result<f64> {
        Ok(length(self.inner.depth()?))
    }
}

/// Each number is on a channel of its own, and is read at a time of its own.
impl<R: Inertial> Inertial for Quantised<R> {
    fn attitude(&mut self) -> Result<Attitude> {
        let roll = tenths(self.inner.attitude()?.roll);
        let pitch = tenths(self.inner.attitude()?.pitch);
        Ok(Attitude { roll, pitch, yaw: tenths(self.inner.attitude()?.yaw) })
    }

    fn turn_rates(&mut self) -> Result<Vector3> {
        let forward = tenths(self.inner.turn_rates()?.x);
        let left = tenths(self.inner.turn_rates()?.y);
        Ok(Vector3::new(forward, left, tenths(self.inner.turn_rates()?.z)))
    }

    fn acceleration(&mut self) -> Result<Vector3> {
        let forward = length(self.inner.acceleration()?.x);
        let left = length(self.inner.acceleration()?.y);
        Ok(Vector3::new(forward, left, length(self.inner.acceleration()?.z)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::MockRobot;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn numbers_are_whole_and_near(x in -50.0..50.0f64, heading in -10.0..10.0f64) {
            let rounded = pose(Pose::new(x, -x, heading));
            for (value, wanted) in [(rounded.x, x), (rounded.y, -x)] {
                prop_assert!((value - wanted).abs() <= 0.000_500_001);
                prop_assert!((units::to_mm(value) - units::to_mm(value).round()).abs() < 1e-6);
            }
            let off = crate::geometry::angle_difference(rounded.heading, heading);
            prop_assert!(off.abs() <= units::from_deg(0.500_001));
            prop_assert!(rounded.heading > -std::f64::consts::PI);
        }
    }

    #[test]
    fn distances_end_at_9999_and_begin_at_1() {
        let robot = MockRobot::new().with_distance(Psd::FRONT, 9.9986).with_distance(Psd::LEFT, 0.0002);
        let mut robot = Quantised::new(robot);
        assert_eq!(robot.distance(Psd::FRONT).unwrap(), f64::INFINITY);
        assert_eq!(robot.distance(Psd::LEFT).unwrap(), 0.001);
        assert_eq!(range(9.9984), 9.998);
    }
}
