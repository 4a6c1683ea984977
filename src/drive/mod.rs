//! Driving (book, chapters 3 and 7): controllers, paths and path followers, and the methods from A to B.
//!
//! A behaviour takes an observation and returns a command; [`run`](crate::io::control::run) loops it on any
//! robot with the necessary capabilities.
//!
//! - [`Path`]: lines, arcs, Hermite splines, Catmull-Rom chains and Dubins paths, by their length;
//! - [`PathFollower`]: drives along any of them with feedback, by pure pursuit or by heading and cross-track error;
//! - [`AToB`]: to a goal by turning and driving straight, along an arc, a dog curve or a spline (chapter 3);
//! - [`Chase`]: the same four towards a goal that moves;
//! - [`CarToB`]: the same for a car, within its turning circle (chapter 7);
//! - [`OmniTracker`]: along any path with any heading on wheels with rollers (chapter 7);
//! - [`RandomDrive`]: straight on, and a random turn where something is ahead (chapter 3);
//! - [`CoveragePlan`], [`Tour`] and [`CoverageMap`]: over the whole floor in lanes (chapters 3 and 6);
//! - [`Follower`], [`Formation`] and [`Cruise`]: robots behind a robot, by what they see or by radio, and the one that leads
//!   (chapter 5);
//! - [`WallFollower`]: along walls of any shape by three distance sensors (chapter 6); [`PidWallFollower`],
//!   [`LidarWallFollower`] and the book's [`TwoLevelWallFollower`] beside it;
//! - [`colour`]: to what has a taught colour, and home with it (chapter 11);
//! - [`lane_keeping`]: along the lane of a road, by what a camera sees, and [`traffic`]: who judges that (chapter 13);
//! - [`motion_watch`]: turning to what moves (chapter 11);
//! - [`Pid`] and [`RelayTuner`]: a PID controller and how to find its gains.

mod a_to_b;
mod a_to_b_run;
mod car;
mod chase;
pub mod colour;
mod coverage;
mod cruise;
mod dubins;
mod follow_me;
mod follower;
mod formation;
pub mod lane_keeping;
pub mod motion_watch;
mod omni;
mod path;
mod pid;
mod random_drive;
mod relay;
mod spline;
pub mod traffic;
mod wall_following;
mod way;

pub use a_to_b::{AToB, AToBObservation, AToBOutcome, AToBParameters, Goal, Method};
pub use car::{CarCommand, CarDriver, CarObservation, CarOutcome, CarToB, CarToBParameters};
pub use chase::{Chase, ChaseObservation, ChaseOutcome, ChaseParameters};
pub use coverage::{CoverageMap, CoverageMapParameters, CoveragePlan, Tour, TourOutcome, TourParameters};
pub use cruise::{Cruise, CruiseParameters};
pub use follow_me::{Follower, FollowerObservation, FollowerParameters, robots_in};
pub use follower::{PathFollower, PathFollowerParameters, Steering};
pub use formation::Formation;
pub use omni::{
    OmniDriver, OmniOutcome, OmniParameters, OmniPilot, OmniReference, OmniTracker, WheelCommand,
};
pub use path::{Path, PathPoint, Waypoint};
pub use pid::{Pid, PidParameters};
pub use random_drive::{RandomDrive, RandomDriveObservation, RandomDriveParameters};
pub use relay::{RelayTuner, UltimateGain};
pub use spline::Hermite;
pub use wall_following::{
    AlongWall, AlongWallObservation, FollowsWalls, LidarWallFollower, LidarWallFollowerParameters,
    PidWallFollower, PidWallFollowerParameters, TwoLevelWallFollower, WallFollower, WallFollowerParameters,
    WallObservation, WallOutcome, WallPhase, WallReading, WallSensors, WallSide,
};
