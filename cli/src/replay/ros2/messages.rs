//! Messages of ROS 2, with the fields of their public definitions. [`definitions`](super::definitions) has
//! these as text.

use std::fmt;

use roverlab::geometry::{Pose as PlanarPose, math};
use serde::de::{Deserializer, Error, Visitor};
use serde::{Deserialize, Serialize, Serializer};

/// A message type.
pub(super) trait Message: Serialize {
    /// Its name.
    const NAME: &'static str;
}

/// Names messages and lists their fields.
macro_rules! messages {
    ($($(#[$doc:meta])* $type:ident $($name:literal)? { $($field:ident: $kind:ty),* $(,)? })*) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
        pub(super) struct $type {
            $(pub(super) $field: $kind,)*
        }

        $(impl Message for $type {
            const NAME: &'static str = $name;
        })?
    )*};
}

messages! {
    Time { sec: i32, nanosec: u32 }
    Header { stamp: Time, frame_id: String }
    Vector { x: f64, y: f64, z: f64 }
    Quaternion { x: f64, y: f64, z: f64, w: f64 }
    Pose { position: Vector, orientation: Quaternion }
    Transform { translation: Vector, rotation: Quaternion }
    TransformStamped { header: Header, child_frame_id: String, transform: Transform }
    /// Transforms between frames.
    TfMessage "tf2_msgs/msg/TFMessage" { transforms: Vec<TransformStamped> }
    /// A velocity.
    Twist "geometry_msgs/msg/Twist" { linear: Vector, angular: Vector }
    /// A velocity with its time.
    TwistStamped "geometry_msgs/msg/TwistStamped" { header: Header, twist: Twist }
    PoseWithCovariance { pose: Pose, covariance: [[f64; 6]; 6] }
    TwistWithCovariance { twist: Twist, covariance: [[f64; 6]; 6] }
    /// Odometry.
    Odometry "nav_msgs/msg/Odometry" {
        header: Header, child_frame_id: String, pose: PoseWithCovariance, twist: TwistWithCovariance,
    }
    /// A scan.
    LaserScan "sensor_msgs/msg/LaserScan" {
        header: Header, angle_min: f32, angle_max: f32, angle_increment: f32, time_increment: f32,
        scan_time: f32, range_min: f32, range_max: f32, ranges: Vec<f32>, intensities: Vec<f32>,
    }
    /// An image.
    Image "sensor_msgs/msg/Image" {
        header: Header, height: u32, width: u32, encoding: String, is_bigendian: u8, step: u32, data: Bytes,
    }
    MapMetaData { map_load_time: Time, resolution: f32, width: u32, height: u32, origin: Pose }
    /// A map.
    OccupancyGrid "nav_msgs/msg/OccupancyGrid" { header: Header, info: MapMetaData, data: Vec<i8> }
    /// The time.
    Clock "rosgraph_msgs/msg/Clock" { clock: Time }
}

/// Nanoseconds in a second.
const SECOND: u64 = 1_000_000_000;

impl Time {
    /// A time in nanoseconds.
    pub(super) fn of(nanoseconds: u64) -> Self {
        let sec = i32::try_from(nanoseconds / SECOND).unwrap_or(i32::MAX);
        Self { sec, nanosec: (nanoseconds % SECOND) as u32 }
    }
}

impl Header {
    pub(super) fn new(nanoseconds: u64, frame: &str) -> Self {
        Self { stamp: Time::of(nanoseconds), frame_id: frame.into() }
    }
}

impl Quaternion {
    /// A turn about the vertical axis.
    fn of_heading(heading: f64) -> Self {
        let (z, w) = math::sin_cos(0.5 * heading);
        Self { x: 0.0, y: 0.0, z, w }
    }

    fn heading(&self) -> f64 {
        let Self { x, y, z, w } = *self;
        math::atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)
    }

    /// Cosine of the angle by which the vertical axis is turned; 1 for turns about it.
    fn uprightness(&self) -> f64 {
        let Self { x, y, z, w } = *self;
        (w * w + z * z - x * x - y * y) / (w * w + x * x + y * y + z * z)
    }
}

impl Vector {
    fn of(pose: &PlanarPose) -> Self {
        Self { x: pose.x, y: pose.y, z: 0.0 }
    }
}

impl Pose {
    pub(super) fn of(pose: &PlanarPose) -> Self {
        Self { position: Vector::of(pose), orientation: Quaternion::of_heading(pose.heading) }
    }

    /// The pose on the floor; `None` for numbers that are none.
    pub(super) fn planar(&self) -> Option<PlanarPose> {
        planar(&self.position, &self.orientation)
    }
}

impl Transform {
    pub(super) fn of(pose: &PlanarPose) -> Self {
        Self { translation: Vector::of(pose), rotation: Quaternion::of_heading(pose.heading) }
    }

    /// The same on the floor; `None` for numbers that are none.
    pub(super) fn planar(&self) -> Option<PlanarPose> {
        planar(&self.translation, &self.rotation)
    }

    /// Whether it turns about the vertical axis alone, within a few degrees.
    pub(super) fn is_level(&self) -> bool {
        self.rotation.uprightness() > 0.99
    }
}

fn planar(place: &Vector, turned: &Quaternion) -> Option<PlanarPose> {
    let pose = PlanarPose::new(place.x, place.y, turned.heading());
    [pose.x, pose.y, pose.heading].iter().all(|value| value.is_finite()).then_some(pose)
}

/// Bytes, which are read and written in one piece.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Bytes(pub(super) Vec<u8>);

impl Serialize for Bytes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bytes(&self.0)
    }
}

impl<'de> Deserialize<'de> for Bytes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        /// Takes what the deserializer has.
        struct Taking;

        impl Visitor<'_> for Taking {
            type Value = Bytes;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("bytes")
            }

            fn visit_byte_buf<E: Error>(self, bytes: Vec<u8>) -> Result<Bytes, E> {
                Ok(Bytes(bytes))
            }
        }

        deserializer.deserialize_byte_buf(Taking)
    }
}
