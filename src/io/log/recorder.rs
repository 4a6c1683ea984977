use std::io::Write;

use image::RgbImage;

use super::messages::{self, Frames};
use super::parts::{ScanHead, Size};
use super::port::Port;
use super::stamp::nanoseconds;
use super::topics::{CALLS, CAMERA, Channel, LIDAR, ODOMETRY, TRANSFORMS};
use super::values::Put;
use super::wire::Fields;
use super::writer::LogWriter;
use crate::geometry::{Pose, Twist, Vector3};
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres, Motors, Odometry,
    Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::world::Colour;

/// A robot that records its calls and their results, made by
/// [`LogWriter::recorder`](super::LogWriter::recorder).
///
/// Every call is a message on the robot's topic `calls`, at the robot's time when it started. Scans, camera
/// images and odometry also have topics of their own in schemas for viewers; their bulk data is not repeated
/// in the calls. The program does not notice: recording takes no robot time.
#[derive(Debug)]
pub struct Recorder<R, W: Write> {
    inner: R,
    port: Port<W>,
}

impl<W: Write> LogWriter<W> {
    /// Records a robot under its index, from 0. If several robots drive concurrently, call this for all of
    /// them before the first one starts.
    pub fn recorder<R>(&self, robot: R, index: usize) -> Recorder<R, W> {
        Recorder::new(robot, self.port(index))
    }
}

impl<R, W: Write> Recorder<R, W> {
    pub(super) fn new(inner: R, port: Port<W>) -> Self {
        Self { inner, port }
    }

    /// The wrapped robot.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The wrapped robot. Nothing more of it is recorded.
    pub fn into_inner(self) -> R {
        self.inner
    }

    /// The access to the recording, for the robot's next recorder.
    pub(super) fn into_port(self) -> Port<W> {
        self.port
    }
}

impl<R: Clock, W: Write> Recorder<R, W> {
    /// Makes a call and records it with its result.
    fn record<T: Put>(
        &mut self,
        method: &str,
        arguments: &[&dyn Put],
        ask: impl FnOnce(&mut R) -> Result<T>,
    ) -> Result<T> {
        self.begin(arguments);
        let result = ask(&mut self.inner);
        self.port.end(CALLS, method, &result);
        result
    }

    /// The same for a result with bulk data, which is written on its own channel before the call.
    fn record_bulk<B, T: Put>(
        &mut self,
        (method, channel): (&str, Channel),
        bulk: &mut B,
        ask: impl FnOnce(&mut R, &mut B) -> Result<()>,
        fill: impl FnOnce(&mut Fields<'_>, &Frames<'_>, &B),
        rest: impl FnOnce(&B) -> T,
    ) -> Result<()> {
        self.begin(&[]);
        let result = ask(&mut self.inner, bulk);
        if result.is_ok() {
            self.port.show(channel, |out, frames| fill(out, frames, bulk));
        }
        let result = result.map(|()| rest(bulk));
        self.port.end(CALLS, method, &result);
        result.map(|_| ())
    }

    fn begin(&mut self, arguments: &[&dyn Put]) {
        let time = self.inner.peek_time().ok();
        self.port.begin(time.map(nanoseconds));
        for argument in arguments {
            self.port.argument(*argument);
        }
    }
}

impl<R: Clock, W: Write> Clock for Recorder<R, W> {
    fn now(&mut self) -> Result<f64> {
        self.record("now", &[], R::now)
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.record("wait", &[&seconds], |inner| inner.wait(seconds))
    }

    fn peek_time(&mut self) -> Result<f64> {
        self.inner.peek_time()
    }
}

macro_rules! recorded {
    ($capability:ident { $( fn $name:ident($($arg:ident: $type:ty),*) -> $result:ty; )* }) => {
        impl<R: $capability + Clock, W: Write> $capability for Recorder<R, W> {
            $( fn $name(&mut self $(, $arg: $type)*) -> Result<$result> {
                recorded!(@$capability self $name($($arg),*))
            } )*
        }
    };
    (@Lidar $self:ident scan_into($scan:ident)) => {{
        let (call, ask) = (("scan_into", LIDAR), |inner: &mut R, scan: &mut LidarScan| inner.scan_into(scan));
        $self.record_bulk(call, $scan, ask, messages::laser_scan, ScanHead::of)
    }};
    (@Camera $self:ident image_into($image:ident)) => {{
        let (call, ask) = (("image_into", CAMERA), |inner: &mut R, image: &mut RgbImage| inner.image_into(image));
        $self.record_bulk(call, $image, ask, messages::raw_image, Size::of)
    }};
    (@Odometry $self:ident pose()) => {{
        let result = recorded!(@ $self pose());
        if let Ok(pose) = &result {
            $self.port.show(ODOMETRY, |out, frames| messages::pose_in_frame(out, frames, pose));
            $self.port.show(TRANSFORMS, |out, frames| messages::frame_transform(out, frames, pose));
        }
        result
    }};
    // Calls that change nothing on the display.
    (@Display $self:ident cursor()) => { recorded!(@ $self cursor()) };
    (@Display $self:ident display_size()) => { recorded!(@ $self display_size()) };
    (@Display $self:ident pixel($at:ident)) => { recorded!(@ $self pixel($at)) };
    (@Display $self:ident screenshot()) => { recorded!(@ $self screenshot()) };
    (@Display $self:ident $name:ident($($arg:ident),*)) => {{
        let result = recorded!(@ $self $name($($arg),*));
        if result.is_ok() {
            $self.port.draw(|lcd| lcd.$name($($arg),*));
        }
        result
    }};
    (@ $self:ident $name:ident($($arg:ident),*)) => {
        $self.record(stringify!($name), &[$(&$arg),*], |inner| inner.$name($($arg),*))
    };
    (@$capability:ident $self:ident $name:ident($($arg:ident),*)) => {
        recorded!(@ $self $name($($arg),*))
    };
}

signatures! { Drive => recorded!() }
signatures! { Odometry => recorded!() }
signatures! { Manoeuvres => recorded!() }
signatures! { StallDetector => recorded!() }
signatures! { DistanceSensors => recorded!() }
signatures! { Lidar => recorded!() }
signatures! { Camera => recorded!() }
signatures! { Display => recorded!() }
signatures! { Keys => recorded!() }
signatures! { Radio => recorded!() }
signatures! { Motors => recorded!() }
signatures! { Servos => recorded!() }
signatures! { Encoders => recorded!() }
signatures! { Inertial => recorded!() }
signatures! { DepthSensor => recorded!() }
