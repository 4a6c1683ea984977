//! Messages for viewers, in Foxglove's schemas.

use image::RgbImage;

use super::stamp::Nanoseconds;
use super::wire::Fields;
use crate::geometry::{Pose, Pose3};
use crate::io::LidarScan;

/// Time and frames of a robot's messages.
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

/// A `foxglove.RawImage` with 8 bits per channel.
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

/// A `foxglove.FrameTransform` from the odometry frame to the robot's.
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

/// A `foxglove.FrameTransform` with elevation, roll and pitch.
pub(super) fn transform_in_space(
    out: &mut Fields<'_>,
    time: Nanoseconds,
    parent: &str,
    child: &str,
    pose: &Pose3,
) {
    let (place, turned) = (pose.position, pose.attitude.coords);
    out.time(1, time);
    out.text(2, parent);
    out.text(3, child);
    out.vector(4, place.x, place.y, place.z);
    out.quaternion(5, [turned.x, turned.y, turned.z, turned.w]);
}

/// A `foxglove.Pose` at a height (m).
pub(super) fn write_pose(out: &mut Fields<'_>, pose: &Pose, height: f64) {
    out.vector(1, pose.x, pose.y, height);
    out.heading(2, pose.heading);
}
