//! Messages for viewers of a run that is not recorded.

use image::RgbImage;

use super::messages::{self, Frames};
use super::schema::Schema;
use super::stamp::nanoseconds;
use super::topics::{self, WORLD, full_topic};
use super::wire::Fields;
use crate::geometry::Pose;
use crate::io::LidarScan;
use crate::world::Scene;

/// A topic of messages, with their schema in Protocol Buffers.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Topic {
    /// Name, such as `/robot1/lidar`.
    pub name: String,
    /// Name of the schema, such as `foxglove.LaserScan`.
    pub schema: String,
    /// The schema's `google.protobuf.FileDescriptorSet`.
    pub descriptor: Vec<u8>,
}

impl Topic {
    fn new(name: String, schema: Schema) -> Self {
        Self { name, schema: schema.name().into(), descriptor: schema.descriptor() }
    }

    /// The topic `/scene`, of walls, objects and marks.
    pub fn scene() -> Self {
        let (topic, schema) = topics::SCENE;
        Self::new(topic.into(), schema)
    }
}

/// The message of a scene on the topic `/scene`.
///
/// ```
/// use roverlab::io::log::{Topic, scene_message};
/// use roverlab::world::{Scene, World};
///
/// let message = scene_message(&Scene::new(World::walled(2.0, 1.0)));
/// assert_eq!(Topic::scene().name, "/scene");
/// assert!(message.len() > 4 * 3 * 8, "the coordinates of four walls");
/// ```
pub fn scene_message(scene: &Scene) -> Vec<u8> {
    let mut message = Vec::new();
    super::scene::scene_update(&mut Fields(&mut message), scene);
    message
}

/// A robot's topics for viewers; see the table of the [module](super).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RobotTopic {
    /// Scans.
    Lidar,
    /// Camera images.
    Camera,
    /// The display.
    Lcd,
    /// Pose by odometry.
    Odometry,
    /// Transforms between the world, odometry and the robot.
    Transforms,
}

impl RobotTopic {
    /// All topics.
    pub const ALL: [Self; 5] = [Self::Lidar, Self::Camera, Self::Lcd, Self::Odometry, Self::Transforms];

    /// The topic of a robot, by its index.
    pub fn of(self, robot: usize) -> Topic {
        let (topic, schema) = match self {
            Self::Lidar => topics::LIDAR,
            Self::Camera => topics::CAMERA,
            Self::Lcd => topics::LCD,
            Self::Odometry => topics::ODOMETRY,
            Self::Transforms => topics::TRANSFORMS,
        };
        Topic::new(full_topic(robot, topic), schema)
    }
}

/// Writes the messages of a robot for viewers, as a recording has them; times are in seconds.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::io::log::{RobotMessages, RobotTopic};
///
/// let messages = RobotMessages::new(0);
/// assert_eq!(RobotTopic::Odometry.of(0).schema, "foxglove.PoseInFrame");
/// assert!(!messages.odometry(1.5, &Pose::new(0.3, 0.0, 0.0)).is_empty());
/// ```
#[derive(Debug, Clone)]
pub struct RobotMessages {
    robot: String,
    odometry: String,
}

impl RobotMessages {
    /// The messages of a robot, by its index.
    pub fn new(robot: usize) -> Self {
        Self { robot: topics::frame(robot), odometry: topics::odometry_frame(robot) }
    }

    /// A scan, for [`RobotTopic::Lidar`].
    pub fn scan(&self, time: f64, scan: &LidarScan) -> Vec<u8> {
        self.message(time, |out, frames| messages::laser_scan(out, frames, scan))
    }

    /// An image, for [`RobotTopic::Camera`] or [`RobotTopic::Lcd`].
    pub fn image(&self, time: f64, image: &RgbImage) -> Vec<u8> {
        self.message(time, |out, frames| messages::raw_image(out, frames, image))
    }

    /// A pose by odometry, for [`RobotTopic::Odometry`].
    pub fn odometry(&self, time: f64, pose: &Pose) -> Vec<u8> {
        self.message(time, |out, frames| messages::pose_in_frame(out, frames, pose))
    }

    /// The same pose as a transform, for [`RobotTopic::Transforms`].
    pub fn transform(&self, time: f64, pose: &Pose) -> Vec<u8> {
        self.message(time, |out, frames| messages::frame_transform(out, frames, pose))
    }

    /// The robot's start pose in the world, for [`RobotTopic::Transforms`].
    pub fn start(&self, pose: &Pose) -> Vec<u8> {
        self.message(0.0, |out, _| messages::transform(out, 0, WORLD, &self.odometry, pose))
    }

    fn message(&self, time: f64, fill: impl FnOnce(&mut Fields<'_>, &Frames<'_>)) -> Vec<u8> {
        let mut message = Vec::new();
        let frames = Frames { time: nanoseconds(time), robot: &self.robot, odometry: &self.odometry };
        fill(&mut Fields(&mut message), &frames);
        message
    }
}
