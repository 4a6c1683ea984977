use std::fmt;
use std::io::Write;

use image::RgbImage;

use super::call;
use super::schema::Schema;
use super::shadow::Shadow;
use super::values::{Put, Values};
use super::wire::Fields;
use super::writer::{Channel, LogWriter, Nanoseconds, frame, odometry_frame};
use crate::geometry::Pose;
use crate::io::sim::Lcd;
use crate::io::{Error, LidarScan, Result};

/// The channels of a robot.
pub(super) const CALLS: Channel = ("calls", Schema::Call);
pub(super) const TRUTH: Channel = ("truth", Schema::Call);
pub(super) const LIDAR: Channel = ("lidar", Schema::LaserScan);
pub(super) const CAMERA: Channel = ("camera", Schema::RawImage);
pub(super) const LCD: Channel = ("lcd", Schema::RawImage);
pub(super) const ODOMETRY: Channel = ("odometry", Schema::PoseInFrame);
pub(super) const TRANSFORMS: Channel = ("transforms", Schema::FrameTransform);
/// What stands in the world.
pub(super) const SCENE: Channel = ("/scene", Schema::SceneUpdate);

/// A robot's way into a recording: it makes messages of calls and of what they show.
pub(super) struct Port<W: Write> {
    writer: LogWriter<W>,
    track: usize,
    frame: String,
    odometry_frame: String,
    time: Option<Nanoseconds>,
    arguments: Values,
    result: Values,
    message: Vec<u8>,
    shadow: Shadow,
    /// Whether the robot drives no more when this is gone.
    closes: bool,
}

impl<W: Write> fmt::Debug for Port<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Port").field("track", &self.track).field("time", &self.time).finish_non_exhaustive()
    }
}

impl<W: Write> Drop for Port<W> {
    fn drop(&mut self) {
        if self.closes {
            self.show_display();
            self.writer.close(self.track);
        }
    }
}

impl<W: Write> Port<W> {
    pub(super) fn new(writer: LogWriter<W>, track: usize) -> Self {
        Self {
            writer,
            track,
            frame: frame(track),
            odometry_frame: odometry_frame(track),
            time: None,
            arguments: Values::default(),
            result: Values::default(),
            message: Vec::new(),
            shadow: Shadow::default(),
            closes: true,
        }
    }

    /// Another way into the recording of the same robot, which may outlive it.
    pub(super) fn beside(writer: LogWriter<W>, track: usize) -> Self {
        let mut port = Self::new(writer, track);
        port.closes = false;
        port
    }

    /// Begins a call at a time; one that nobody can tell is that of the message before.
    pub(super) fn begin(&mut self, time: Option<Nanoseconds>) {
        self.time = time;
        self.arguments.clear();
        if time.is_some_and(|time| self.shadow.is_due(time)) {
            self.show_display();
        }
    }

    /// Draws what the robot has drawn in the call that has begun.
    pub(super) fn draw(&mut self, drawing: impl FnOnce(&mut Lcd) -> Result<()>) {
        self.shadow.draw(self.time.unwrap_or(0), drawing);
    }

    /// Writes what the display shows, if something has been drawn since the last time.
    fn show_display(&mut self) {
        let mut shadow = std::mem::take(&mut self.shadow);
        if let Some(image) = shadow.take() {
            self.show(LCD, |out, frames| raw_image(out, frames, image));
        }
        self.shadow = shadow;
    }

    pub(super) fn argument(&mut self, argument: &dyn Put) {
        argument.put(&mut self.arguments);
    }

    /// Writes the call that has begun.
    pub(super) fn end<T: Put>(&mut self, channel: Channel, method: &str, result: &Result<T>) {
        self.end_with(channel, method, result.as_ref().map(|value| value as &dyn Put));
    }

    fn end_with(&mut self, channel: Channel, method: &str, result: std::result::Result<&dyn Put, &Error>) {
        self.result.clear();
        let result = match result {
            Ok(value) => {
                value.put(&mut self.result);
                Ok(&self.result)
            }
            Err(error) => Err(error),
        };
        self.message.clear();
        call::write(&mut self.message, method, &self.arguments, result);
        self.writer.push(self.track, self.time, channel, &self.message);
    }

    /// Writes a message on a channel that is there to be seen.
    pub(super) fn show(&mut self, channel: Channel, fill: impl FnOnce(&mut Fields<'_>, &Frames<'_>)) {
        self.message.clear();
        let frames =
            Frames { time: self.time.unwrap_or(0), robot: &self.frame, odometry: &self.odometry_frame };
        fill(&mut Fields(&mut self.message), &frames);
        self.writer.push(self.track, self.time, channel, &self.message);
    }
}

/// What the messages of a robot refer to.
#[derive(Debug)]
pub(super) struct Frames<'a> {
    pub(super) time: Nanoseconds,
    pub(super) robot: &'a str,
    pub(super) odometry: &'a str,
}

/// A `foxglove.LaserScan`.
pub(super) fn laser_scan(out: &mut Fields<'_>, frames: &Frames<'_>, scan: &LidarScan) {
    let gaps = scan.ranges.len().saturating_sub(1) as f64;
    out.time(1, frames.time);
    out.text(2, frames.robot);
    out.message(3, |pose| write_pose(pose, &scan.mount, 0.0));
    out.double(4, scan.angle_min);
    out.double(5, scan.angle_min + scan.angle_increment * gaps);
    out.doubles(6, &scan.ranges);
}

/// A `foxglove.RawImage` of 8 bits a channel.
pub(super) fn raw_image(out: &mut Fields<'_>, frames: &Frames<'_>, image: &RgbImage) {
    let (width, height) = image.dimensions();
    out.time(1, frames.time);
    out.fixed32(2, width);
    out.fixed32(3, height);
    out.text(4, "rgb8");
    out.fixed32(5, 3 * width);
    out.text(7, frames.robot);
    out.bytes(6, image.as_raw());
}

/// A `foxglove.PoseInFrame` of odometry.
pub(super) fn pose_in_frame(out: &mut Fields<'_>, frames: &Frames<'_>, pose: &Pose) {
    out.time(1, frames.time);
    out.text(2, frames.odometry);
    out.message(3, |message| write_pose(message, pose, 0.0));
}

/// A `foxglove.FrameTransform` from odometry's frame to the robot's.
pub(super) fn frame_transform(out: &mut Fields<'_>, frames: &Frames<'_>, pose: &Pose) {
    transform(out, frames.time, frames.odometry, frames.robot, pose);
}

/// A `foxglove.FrameTransform`.
pub(super) fn transform(out: &mut Fields<'_>, time: Nanoseconds, parent: &str, child: &str, pose: &Pose) {
    out.time(1, time);
    out.text(2, parent);
    out.text(3, child);
    out.vector(4, pose.x, pose.y, 0.0);
    out.heading(5, pose.heading);
}

/// A `foxglove.Pose` at a height.
pub(super) fn write_pose(out: &mut Fields<'_>, pose: &Pose, height: f64) {
    out.vector(1, pose.x, pose.y, height);
    out.heading(2, pose.heading);
}
