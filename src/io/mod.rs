//! Capabilities of any robot, simulated or real.
//!
//! Each capability is one small trait. An algorithm requires only what it uses, `fn run(robot: &mut (impl
//! Clock + Drive + Lidar))`, and so runs on simulated, recorded and real robots. [`RobotIo`] combines all
//! traits. Every trait works behind `&mut R`, `Box<R>` and `dyn`.
//!
//! # Your own robot
//!
//! Implement the traits of the devices that the robot has, and no others. A behaviour that needs more does
//! not compile. [`wrappers::Manoeuvring`] adds [`Manoeuvres`] and a [`StallDetector`] to a drive with
//! odometry. No method makes up a value: where a program requires a full [`RobotIo`], missing devices return
//! [`Error::unsupported`].
//!
//! # Which traits a behaviour needs
//!
//! All need [`Clock`]. With [`control::SensedBy`] a behaviour takes its observations from other sensors, and
//! needs the traits of these instead.
//!
//! | behaviour | traits |
//! |---|---|
//! | [`Tour`](crate::drive::Tour) | [`Drive`], [`Odometry`] |
//! | [`Chase::after`](crate::drive::Chase::after) | [`Drive`], [`Odometry`], [`StallDetector`] |
//! | [`AToB`](crate::drive::AToB), [`AToB::by`](crate::drive::AToB::by) | [`Drive`], [`Odometry`], [`Manoeuvres`], [`StallDetector`] |
//! | [`RandomDrive::by_distance_sensors`](crate::drive::RandomDrive::by_distance_sensors) | [`Drive`], [`Odometry`], [`DistanceSensors`] |
//! | [`RandomDrive`](crate::drive::RandomDrive) | [`Drive`], [`Odometry`], [`DistanceSensors`], [`Lidar`] |
//! | [`AlongWall<WallFollower>`](crate::drive::WallFollower), [`AlongWall<PidWallFollower>`](crate::drive::PidWallFollower), [`AlongWall<TwoLevelWallFollower>`](crate::drive::TwoLevelWallFollower), [`MazeRunner`](crate::maze::MazeRunner) | [`Drive`], [`Odometry`], [`DistanceSensors`], [`StallDetector`] |
//! | [`LeftHand`](crate::maze::LeftHand) | [`Drive`], [`Odometry`], [`DistanceSensors`], [`Manoeuvres`], [`StallDetector`] |
//! | [`AlongWall<LidarWallFollower>`](crate::drive::LidarWallFollower) | [`Drive`], [`Lidar`], [`StallDetector`] |
//! | [`FirstSteps`](crate::drive::FirstSteps), [`LidarLeft`](crate::maze::LidarLeft), every [`Bug`](crate::nav::Bug), [`Navigator`](crate::nav::Navigator), [`Racer`](crate::race::Racer), [`EventRacer`](crate::race::EventRacer) | [`Drive`], [`Odometry`], [`Lidar`] |
//! | [`SummitSearch`](crate::nav::SummitSearch) | [`Drive`], [`Odometry`], [`Lidar`], [`Inertial`] |
//! | [`Ascent::by_lidar`](crate::drive::terrain::Ascent::by_lidar) | [`Drive`], [`Odometry`], [`Lidar`], [`Inertial`] |
//! | [`Ascent::by_distance_sensors`](crate::drive::terrain::Ascent::by_distance_sensors) | [`Drive`], [`Odometry`], [`DistanceSensors`], [`Inertial`] |
//! | [`RampCrossing`](crate::nav::RampCrossing) | [`Drive`], [`Odometry`], [`Lidar`], [`Inertial`] |
//! | [`Ascent`](crate::drive::terrain::Ascent) | [`Drive`], [`Odometry`], [`Lidar`], [`DistanceSensors`], [`Inertial`] |
//! | [`LaneKeeper`](crate::drive::lane_keeping::LaneKeeper), [`TrafficDriver`](crate::drive::traffic::TrafficDriver), [`BookLaneKeeper`](crate::drive::lane_keeping::BookLaneKeeper), [`NetworkDriver`](crate::drive::end_to_end::NetworkDriver), [`SteeringTeacher`](crate::drive::end_to_end::SteeringTeacher), [`MotionWatch`](crate::drive::motion_watch::MotionWatch), [`MotionApproach`](crate::drive::motion_watch::MotionApproach) | [`Drive`], [`Odometry`], [`Camera`] |
//! | [`ParkingDriver`](crate::drive::parking::ParkingDriver) | [`Drive`], [`Odometry`], [`Camera`], [`DistanceSensors`] |
//! | [`ColourTracker`](crate::drive::colour::ColourTracker), [`PushHome`](crate::drive::colour::PushHome) | [`Drive`], [`Odometry`], [`Camera`], [`Lidar`], [`StallDetector`] |
//! | [`CarToB`](crate::drive::CarToB) | [`Motors`], [`Servos`], [`Odometry`], [`StallDetector`] |
//! | [`GapDriver`](crate::race::GapDriver) | [`Motors`], [`Servos`], [`Lidar`] |
//! | [`OmniPilot`](crate::drive::OmniPilot) | [`Motors`], [`Odometry`] |
//! | [`Boat`](crate::drive::marine::Boat) | [`Motors`], [`Odometry`], [`Inertial`] |
//! | [`Dive`](crate::drive::marine::Dive) | [`Motors`], [`DepthSensor`], [`Inertial`] |
//! | [`PoolWall`](crate::drive::marine::PoolWall) | [`Motors`], [`Odometry`], [`DepthSensor`], [`DistanceSensors`], [`Inertial`] |
//! | [`Survey`](crate::drive::marine::Survey) | [`Motors`], [`Odometry`], [`DepthSensor`], [`DistanceSensors`], [`Inertial`] |
//! | [`GaitWalk`](crate::evolve::GaitWalk) | [`Servos`] |
//! | [`RadioRing`](crate::drive::RadioRing) | [`Radio`] |
//! | [`RadioCar`](crate::drive::traffic::RadioCar) | [`Drive`], [`Odometry`], [`Camera`], [`Radio`] |
//! | [`RoadStation`](crate::drive::traffic::RoadStation) | [`Display`], [`Keys`], [`Radio`] |

mod actuators;
mod camera;
mod clock;
pub mod control;
pub mod delegate;
mod depth;
mod display;
mod drive;
pub(crate) mod error;
mod inertial;
mod keys;
mod lcd;
mod lidar;
mod mock;
mod psd;
mod radio;
pub(crate) mod reading;
#[macro_use]
pub mod wrappers;
mod fleet;
#[cfg(feature = "log")]
pub mod log;
#[cfg(feature = "robios")]
pub mod robios;
pub mod sim;
mod truth;

pub use actuators::{Encoders, Motors, Servos};
pub use camera::{Camera, Resolution};
pub use clock::Clock;
pub use depth::DepthSensor;
pub use display::{Display, DisplayImage, DisplayOption, Fill, Font, FontFamily, FontStyle, Pixel, Viewport};
pub use drive::{Drive, Manoeuvres, Odometry, StallDetector};
pub use error::{Error, ErrorKind, Result};
pub use fleet::{FleetIo, FleetStep};
pub use inertial::{Attitude, Inertial};
pub use keys::{Key, Keys};
pub use lcd::Lcd;
pub use lidar::{Lidar, LidarScan, LidarSettings};
pub use mock::{Call, MockRobot, Script};
pub use psd::{DistanceSensors, Psd};
pub use radio::{Radio, RadioMessage};
pub use truth::{GroundTruth, Mishap, RobotTruth, TrailPoint, TruthInSpace};

/// A full robot with every capability.
///
/// # For implementers
///
/// Implement the single traits; this one follows.
pub trait RobotIo:
    Clock
    + Drive
    + Odometry
    + Manoeuvres
    + StallDetector
    + DistanceSensors
    + Lidar
    + Camera
    + Display
    + Keys
    + Radio
    + Motors
    + Servos
    + Encoders
    + Inertial
    + DepthSensor
{
}

impl<R> RobotIo for R where
    R: Clock
        + Drive
        + Odometry
        + Manoeuvres
        + StallDetector
        + DistanceSensors
        + Lidar
        + Camera
        + Display
        + Keys
        + Radio
        + Motors
        + Servos
        + Encoders
        + Inertial
        + DepthSensor
        + ?Sized
{
}
