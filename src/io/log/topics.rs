//! The channels of a recording, and the frames that its messages name.

use super::schema::Schema;

/// A channel of a recording: the part of its topic behind the robot's name, and what it carries.
pub(super) type Channel = (&'static str, Schema);

/// The calls that its program made, and the answers.
pub(super) const CALLS: Channel = ("calls", Schema::Call);
/// What was true about it, where somebody asked.
pub(super) const TRUTH: Channel = ("truth", Schema::Call);
/// Its scans.
pub(super) const LIDAR: Channel = ("lidar", Schema::LaserScan);
/// Its images.
pub(super) const CAMERA: Channel = ("camera", Schema::RawImage);
/// What its display showed.
pub(super) const LCD: Channel = ("lcd", Schema::RawImage);
/// Where odometry took it to be.
pub(super) const ODOMETRY: Channel = ("odometry", Schema::PoseInFrame);
/// Where its frames lie in each other.
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

/// The name of the frame in which a robot truly is.
pub(super) fn truth_frame(track: usize) -> String {
    format!("{}/truth", frame(track))
}
