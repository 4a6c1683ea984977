//! The channels of a recording, and the frames named in its messages.

use super::schema::Schema;

/// A channel of a recording: the part of its topic after the robot's name, and its content.
pub(super) type Channel = (&'static str, Schema);

/// Calls of the robot's program, with answers.
pub(super) const CALLS: Channel = ("calls", Schema::Call);
/// Queries of the robot's ground truth.
pub(super) const TRUTH: Channel = ("truth", Schema::Call);
/// Scans.
pub(super) const LIDAR: Channel = ("lidar", Schema::LaserScan);
/// Images.
pub(super) const CAMERA: Channel = ("camera", Schema::RawImage);
/// Display content.
pub(super) const LCD: Channel = ("lcd", Schema::RawImage);
/// Pose by odometry.
pub(super) const ODOMETRY: Channel = ("odometry", Schema::PoseInFrame);
/// Transforms between its frames.
pub(super) const TRANSFORMS: Channel = ("transforms", Schema::FrameTransform);
/// Static content of the world.
pub(super) const SCENE: Channel = ("/scene", Schema::SceneUpdate);

/// The fixed frame.
pub(super) const WORLD: &str = "world";

/// Name of a robot's own frame.
pub(super) fn frame(track: usize) -> String {
    // The last index has a name too.
    format!("robot{}", track as u128 + 1)
}

/// Topic of a robot; one that begins with a slash is shared.
pub(super) fn full_topic(track: usize, topic: &str) -> String {
    if topic.starts_with('/') { topic.to_owned() } else { format!("/{}/{topic}", frame(track)) }
}

/// Name of a robot's odometry frame.
pub(super) fn odometry_frame(track: usize) -> String {
    format!("{}/odometry", frame(track))
}

/// The name of the frame in which a robot truly is.
pub(super) fn truth_frame(track: usize) -> String {
    format!("{}/truth", frame(track))
}
