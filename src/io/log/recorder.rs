use std::io::Write;

use image::RgbImage;

use super::parts::{ScanHead, Size};
use super::port::{self, CALLS, CAMERA, LIDAR, ODOMETRY, Port, TRANSFORMS};
use super::writer::nanoseconds;
use crate::geometry::{Pose, Twist};
use crate::io::{
    Camera, Clock, Display, DisplayOption, DistanceSensors, Drive, Encoders, Fill, Font, Key, Keys, Lidar,
    LidarScan, LidarSettings, Motors, Picture, Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos,
    Viewport,
};
use crate::world::Colour;

/// A robot that records what it is asked and what it answers, made by
/// [`LogWriter::recorder`](super::LogWriter::recorder).
///
/// Every call is a message of the robot's topic `calls`, at the robot's time when it began. Scans, camera images and
/// odometry are on topics of their own besides, in schemas that viewers show; the calls do not repeat their bulk. The
/// program sees nothing of it: recording takes no time of the robot's.
#[derive(Debug)]
pub struct Recorder<R, W: Write> {
    inner: R,
    port: Port<W>,
}

impl<R, W: Write> Recorder<R, W> {
    pub(super) fn new(inner: R, port: Port<W>) -> Self {
        Self { inner, port }
    }

    /// The robot inside.
    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The robot inside. Nothing more of it is recorded.
    pub fn into_inner(self) -> R {
        self.inner
    }
}

impl<R: Clock, W: Write> Recorder<R, W> {
    fn begin(&mut self) {
        let time = self.inner.peek_time().ok();
        self.port.begin(time.map(nanoseconds));
    }
}

impl<R: Clock, W: Write> Clock for Recorder<R, W> {
    fn now(&mut self) -> Result<f64> {
        self.begin();
        let result = self.inner.now();
        self.port.end(CALLS, "now", &result);
        result
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.begin();
        self.port.argument(&seconds);
        let result = self.inner.wait(seconds);
        self.port.end(CALLS, "wait", &result);
        result
    }

    fn peek_time(&mut self) -> Result<f64> {
        self.inner.peek_time()
    }
}

impl<R: Lidar + Clock, W: Write> Lidar for Recorder<R, W> {
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
        self.begin();
        let result = self.inner.scan_into(scan);
        if result.is_ok() {
            self.port.show(LIDAR, |out, frames| port::laser_scan(out, frames, scan));
        }
        let head = result.map(|()| ScanHead::of(scan));
        self.port.end(CALLS, "scan_into", &head);
        head.map(|_| ())
    }

    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()> {
        self.begin();
        self.port.argument(&settings);
        let result = self.inner.configure_lidar(settings);
        self.port.end(CALLS, "configure_lidar", &result);
        result
    }
}

impl<R: Camera + Clock, W: Write> Camera for Recorder<R, W> {
    fn set_resolution(&mut self, resolution: Resolution) -> Result<()> {
        self.begin();
        self.port.argument(&resolution);
        let result = self.inner.set_resolution(resolution);
        self.port.end(CALLS, "set_resolution", &result);
        result
    }

    fn resolution(&mut self) -> Result<Resolution> {
        self.begin();
        let result = self.inner.resolution();
        self.port.end(CALLS, "resolution", &result);
        result
    }

    fn image_into(&mut self, image: &mut RgbImage) -> Result<()> {
        self.begin();
        let result = self.inner.image_into(image);
        if result.is_ok() {
            self.port
                .show(CAMERA, |out, frames| port::raw_image(out, frames, image.dimensions(), image.as_raw()));
        }
        let size = result.map(|()| Size(image.width(), image.height()));
        self.port.end(CALLS, "image_into", &size);
        size.map(|_| ())
    }
}

macro_rules! recorded {
    ($capability:ident { $( fn $name:ident($($arg:ident: $type:ty),*) -> $result:ty; )* }) => {
        impl<R: $capability + Clock, W: Write> $capability for Recorder<R, W> {
            $( fn $name(&mut self $(, $arg: $type)*) -> Result<$result> {
                self.begin();
                $( self.port.argument(&$arg); )*
                let result = self.inner.$name($($arg),*);
                self.port.end(CALLS, stringify!($name), &result);
                recorded!(@show self $name result);
                result
            } )*
        }
    };
    (@show $self:ident pose $result:ident) => {
        if let Ok(pose) = &$result {
            $self.port.show(ODOMETRY, |out, frames| port::pose_in_frame(out, frames, pose));
            $self.port.show(TRANSFORMS, |out, frames| port::frame_transform(out, frames, pose));
        }
    };
    (@show $self:ident $name:ident $result:ident) => {};
}

signatures! { Drive => recorded!() }
signatures! { DistanceSensors => recorded!() }
signatures! { Display => recorded!() }
signatures! { Keys => recorded!() }
signatures! { Radio => recorded!() }
signatures! { Motors => recorded!() }
signatures! { Servos => recorded!() }
signatures! { Encoders => recorded!() }
