use std::fmt::Write as _;
use std::io;

use image::RgbImage;

use super::trace_text::{Digest, Token, put_scan};
use crate::geometry::{Pose, Twist, Vector3};
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres, Motors, Odometry,
    Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::world::Colour;

/// Source of the time stamps of a trace.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stamp {
    /// Reads the robot's clock before each call. Where reading takes time, as in the simulator, a traced run
    /// differs from an untraced one.
    #[default]
    EachCall,
    /// The last time that the program itself read. The trace does not affect the robot.
    LastKnown,
}

/// A robot that writes every call as one line: time, call, arguments, and result or error.
///
/// ```text
/// 0.5 set_speed((0.2, 0.0)) -> ok
/// 0.5 distance(1) -> 0.4375
/// 0.5 scan_into() -> 360 beams 8c0b2f6a53a1d7e4
/// 0.6 distance(9) -> error Unsupported "the robot has no PSD 9"
/// ```
///
/// Floats have the fewest digits that parse back to the same number, and text is quoted and escaped. So equal
/// runs write equal bytes, and [`digest`](Traced::digest) compares them as one number. A time that the robot
/// cannot read appears as a question mark. Scans and images appear as digests; scans in full with
/// [`whole_scans`](Traced::whole_scans).
///
/// A failing writer does not disturb the run: the rest of the trace is not written, and
/// [`finish`](Traced::finish) returns the first error.
///
/// ```
/// use roverlab::geometry::Twist;
/// use roverlab::io::wrappers::Traced;
/// use roverlab::io::{Clock, Drive, Odometry, Manoeuvres, StallDetector, MockRobot};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut robot = Traced::new(MockRobot::new(), Vec::new());
/// robot.set_speed(Twist::new(0.1, -0.25))?;
/// robot.wait(0.5)?;
/// robot.now()?;
/// let (_robot, written) = robot.finish();
/// let text = String::from_utf8(written?)?;
/// assert_eq!(text, "0.0 set_speed((0.1, -0.25)) -> ok\n0.0 wait(0.5) -> ok\n0.5 now() -> 0.5\n");
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Traced<R, W> {
    inner: R,
    writer: W,
    failure: Option<io::Error>,
    digest: Digest,
    stamp: Stamp,
    last_time: Option<f64>,
    whole_scans: bool,
    line: String,
}

impl<R, W: io::Write> Traced<R, W> {
    /// Traces a robot's calls to a writer. A file should be buffered: each line is one write.
    pub fn new(inner: R, writer: W) -> Self {
        Self {
            inner,
            writer,
            failure: None,
            digest: Digest::EMPTY,
            stamp: Stamp::default(),
            last_time: None,
            whole_scans: false,
            line: String::new(),
        }
    }

    /// Sets the source of the time stamps.
    #[must_use]
    pub fn with_stamp(self, stamp: Stamp) -> Self {
        Self { stamp, ..self }
    }

    /// Writes scans in full after their digests.
    #[must_use]
    pub fn whole_scans(self) -> Self {
        Self { whole_scans: true, ..self }
    }

    /// The 64-bit FNV-1a digest of all bytes of the trace so far, including those not written.
    pub fn digest(&self) -> u64 {
        self.digest.0
    }

    /// The wrapped robot.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The wrapped robot. Flushes and drops the writer and its errors; [`finish`](Traced::finish) returns
    /// them.
    pub fn into_inner(self) -> R {
        self.finish().0
    }

    /// The wrapped robot, and the flushed writer or its first error.
    pub fn finish(mut self) -> (R, io::Result<W>) {
        let written = match self.failure.take() {
            Some(error) => Err(error),
            None => self.writer.flush().map(|()| self.writer),
        };
        (self.inner, written)
    }

    /// Starts a line with the call's name.
    fn open(&mut self, time: Option<f64>, name: &str) {
        self.line.clear();
        // Writing to a string cannot fail.
        let _ = match time {
            Some(time) => write!(self.line, "{time:?} {name}("),
            None => write!(self.line, "? {name}("),
        };
    }

    fn arguments(&mut self, arguments: &[&dyn Token]) {
        for (i, argument) in arguments.iter().enumerate() {
            self.line.push_str(if i == 0 { "" } else { ", " });
            argument.put(&mut self.line);
        }
    }

    /// Ends the line with the result and writes it.
    fn close<T>(&mut self, result: &Result<T>, put: impl FnOnce(&mut String, &T)) {
        self.line.push_str(") -> ");
        match result {
            Ok(value) => put(&mut self.line, value),
            Err(error) => {
                let _ = write!(self.line, "error {:?} {:?}", error.kind(), error.to_string());
            }
        }
        self.line.push('\n');
        self.digest.update(self.line.bytes());
        if self.failure.is_none() {
            self.failure = self.writer.write_all(self.line.as_bytes()).err();
        }
    }
}

impl<R: Clock, W: io::Write> Traced<R, W> {
    /// Time stamp of a line; `None` if the robot cannot tell it.
    fn time(&mut self) -> Option<f64> {
        if self.stamp == Stamp::EachCall {
            return self.inner.now().ok();
        }
        self.last_time
    }
}

impl<R: Clock, W: io::Write> Clock for Traced<R, W> {
    fn now(&mut self) -> Result<f64> {
        let result = self.inner.now();
        self.last_time = result.as_ref().ok().copied().or(self.last_time);
        self.open(result.as_ref().ok().copied(), "now");
        self.close(&result, |line, time| time.put(line));
        result
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        let time = self.time();
        self.open(time, "wait");
        self.arguments(&[&seconds]);
        let result = self.inner.wait(seconds);
        self.close(&result, |line, done| done.put(line));
        result
    }

    fn peek_time(&mut self) -> Result<f64> {
        self.inner.peek_time()
    }
}

impl<R: Lidar + Clock, W: io::Write> Lidar for Traced<R, W> {
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
        let time = self.time();
        self.open(time, "scan_into");
        let result = self.inner.scan_into(scan);
        let whole = self.whole_scans;
        self.close(&result, |line, ()| put_scan(line, scan, whole));
        result
    }

    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()> {
        let time = self.time();
        self.open(time, "configure_lidar");
        self.arguments(&[&settings]);
        let result = self.inner.configure_lidar(settings);
        self.close(&result, |line, done| done.put(line));
        result
    }
}

impl<R: Camera + Clock, W: io::Write> Camera for Traced<R, W> {
    fn set_resolution(&mut self, resolution: Resolution) -> Result<()> {
        let time = self.time();
        self.open(time, "set_resolution");
        self.arguments(&[&resolution]);
        let result = self.inner.set_resolution(resolution);
        self.close(&result, |line, done| done.put(line));
        result
    }

    fn resolution(&mut self) -> Result<Resolution> {
        let time = self.time();
        self.open(time, "resolution");
        let result = self.inner.resolution();
        self.close(&result, |line, resolution| resolution.put(line));
        result
    }

    fn image_into(&mut self, image: &mut RgbImage) -> Result<()> {
        let time = self.time();
        self.open(time, "image_into");
        let result = self.inner.image_into(image);
        self.close(&result, |line, ()| image.put(line));
        result
    }
}

macro_rules! traced_impl {
    ($capability:ident { $( fn $name:ident($($arg:ident: $type:ty),*) -> $result:ty; )* }) => {
        impl<R: $capability + Clock, W: io::Write> $capability for Traced<R, W> {
            $( fn $name(&mut self $(, $arg: $type)*) -> Result<$result> {
                let time = self.time();
                self.open(time, stringify!($name));
                self.arguments(&[$(&$arg),*]);
                let result = self.inner.$name($($arg),*);
                self.close(&result, |line, value| value.put(line));
                result
            } )*
        }
    };
}

signatures! { Drive => traced_impl!() }
signatures! { Odometry => traced_impl!() }
signatures! { Manoeuvres => traced_impl!() }
signatures! { StallDetector => traced_impl!() }
signatures! { DistanceSensors => traced_impl!() }
signatures! { Display => traced_impl!() }
signatures! { Keys => traced_impl!() }
signatures! { Radio => traced_impl!() }
signatures! { Motors => traced_impl!() }
signatures! { Servos => traced_impl!() }
signatures! { Encoders => traced_impl!() }
signatures! { Inertial => traced_impl!() }
signatures! { DepthSensor => traced_impl!() }
