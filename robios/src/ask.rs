//! Requests of a program's library to the world, and its replies. A [`Seat`](crate::seat::Seat) answers them.

use image::RgbImage;
use roverlab::geometry::{Pose, Twist};
use roverlab::io::{LidarSettings, RadioMessage};

use crate::identity::Identity;

/// A request to the world. Lengths in metres, angles in radians.
#[derive(Debug, Clone, PartialEq)]
pub enum Request {
    /// The robot's properties; see [`Identity`].
    Identity,
    /// Lets a time pass (s).
    Pass(f64),
    /// Drives at a velocity.
    SetSpeed(Twist),
    /// The velocity by odometry.
    Speed,
    /// The pose by odometry.
    Pose,
    /// Sets the pose by odometry.
    SetPose(Pose),
    /// Drives an arc: length, angle, and speed along it.
    Curve(f64, f64, f64),
    /// The remainder of the running manoeuvre.
    Remaining,
    /// Whether no manoeuvre is running.
    IsDone,
    /// Waits until the running manoeuvre ends or stalls.
    WaitDone,
    /// Whether the robot is stalled.
    IsStalled,
    /// The reading of a distance sensor.
    Distance(u8),
    /// A scan of the lidar.
    Scan,
    /// Sets the lidar for later scans.
    ConfigureLidar(LidarSettings),
    /// Sets the size of later images, as an index into [`Resolution::ALL`](roverlab::io::Resolution::ALL).
    SetResolution(u8),
    /// An image of the camera.
    Image,
    /// Sends a message to a robot.
    Send(u32, Vec<u8>),
    /// Numbers of all robots.
    Numbers,
    /// The oldest unread message; waits for it at most this long (s).
    Receive(f64),
    /// Drives a motor at a fraction of its full speed.
    Motor(u8, f64),
    /// Moves a servo to a position, -1 to 1.
    Servo(u8, f64),
    /// Ticks of an encoder.
    Encoder(u8),
    /// Resets an encoder to zero.
    ResetEncoder(u8),
    /// The depth by the pressure sensor.
    Depth,
    /// The attitude by the inertial unit: roll, pitch and yaw.
    Attitude,
    /// Its turn rates about the forward, left and upright axes.
    TurnRates,
    /// Its accelerations along these axes.
    Acceleration,
    /// True pose of a robot, by its number; 0 is the requesting robot.
    RobotAt(u32),
    /// Moves a robot; on hills it drops from a height above the floor (m).
    PlaceRobot(u32, Pose, f64),
    /// True pose of an object, by its number.
    ObjectAt(u32),
    /// Moves an object.
    PlaceObject(u32, Pose),
}

impl Request {
    /// Whether it is a short reading without side effects that can only change with a tick.
    pub fn is_brief(&self) -> bool {
        matches!(
            self,
            Self::Speed
                | Self::Pose
                | Self::Remaining
                | Self::IsDone
                | Self::IsStalled
                | Self::Distance(_)
                | Self::Encoder(_)
        )
    }
}

/// Reply of the world.
#[derive(Debug, Clone, PartialEq)]
pub enum Reply {
    /// Success without a value.
    Done,
    /// Success, though the thing that was moved cannot stand there: what, where, and why not.
    Misplaced(String),
    /// Yes or no.
    Flag(bool),
    /// A number.
    Number(f64),
    /// An integer.
    Count(i64),
    /// A velocity.
    Twist(Twist),
    /// Three numbers.
    Three([f64; 3]),
    /// A pose, and height above the floor (m).
    Pose(Pose, f64),
    /// Ranges counter-clockwise; infinite without a return.
    Ranges(Vec<f64>),
    /// An image.
    Image(RgbImage),
    /// A message, if any.
    Message(Option<RadioMessage>),
    /// Numbers of robots.
    Numbers(Vec<u32>),
    /// Properties of the robot.
    Identity(Identity),
}

/// Maximum number of additional readings per reply.
pub const MOST_READINGS: usize = 16;
