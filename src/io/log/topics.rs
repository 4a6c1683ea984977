//! The channels of a recording, and the frames that its messages name.

use super::schema::Schema;

/// A channel of a recording: the part of its topic behind the robot's name, and what it carries.
pub(super) type Channel = (&'static str, Schema);

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

/// The frame of everything that stands.
pub(super) const WORLD: &str = "world";

/// The name of a robot's own frame.
pub(super) fn frame(track: usize) -> String {
    format!("robot{}", track + 1)
}

/// The name of the frame in which a robot's odometry is.
pub(super) fn odometry_frame(track: usize) -> String {
    format!("{}/odometry", frame(track))
}
