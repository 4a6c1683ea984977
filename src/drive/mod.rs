//! Driving (book, chapters 3 and 7): controllers, paths and path followers, and the methods from A to B.
//!
//! A behaviour takes an observation and returns a command; [`run`](crate::io::control::run) loops it on any
//! robot with the necessary capabilities.
//!
//! - [`Path`]: lines, arcs, Hermite splines, Catmull-Rom chains and Dubins paths, parametrised by length;
//! - [`PathFollower`]: follows any of them with feedback, by pure pursuit or by heading and cross-track
//!   error;
//! - [`AToB`]: to a goal by turn and straight line, arc, dog curve or spline (chapter 3);
//! - [`Chase`]: the same four methods towards a moving goal;
//! - [`CarToB`]: the same methods for a car, within its turning circle (chapter 7);
//! - [`OmniTracker`]: along a route with any heading, on wheels with rollers (chapter 7);
//! - [`FirstSteps`]: to a wall and back, and round a circle; [`RadioRing`]: a count passed on by radio
//!   (chapter 2);
//! - [`RandomDrive`]: straight on, with random turns at obstacles (chapter 3);
//! - [`CoveragePlan`], [`Tour`] and [`CoverageMap`]: the whole floor in lanes (chapters 3 and 6);
//! - [`Follower`], [`Formation`] and [`Cruise`]: following a robot by sight or in a radio formation, and the
//!   leader (chapter 5);
//! - [`WallFollower`]: along walls of any shape by three distance sensors (chapter 6), besides
//!   [`PidWallFollower`], [`LidarWallFollower`] and the book's [`TwoLevelWallFollower`];
//! - [`colour`]: to an object of a taught colour, and home with it (chapter 11);
//! - [`lane_keeping`]: along the lane of a road by camera; [`end_to_end`]: by a trained network;
//!   [`traffic`]: past obstacles, and the referees;
//!   [`parking`]: beside the road (chapter 13);
//! - [`marine`]: craft in water (chapter 8);
//! - [`motion_watch`]: turning towards motion (chapter 11);
//! - [`terrain`]: up the steepest way (chapter 7);
//! - [`Pid`] and [`RelayTuner`]: a PID controller and its automatic tuning.

mod a_to_b;
mod a_to_b_run;
mod car;
mod chase;
pub mod colour;
mod coverage;
mod cruise;
mod dubins;
pub mod end_to_end;
mod first_steps;
mod follow_me;
mod follower;
mod formation;
pub mod lane_keeping;
pub mod marine;
pub mod motion_watch;
mod omni;
mod outline;
pub mod parking;
mod path;
mod pid;
mod radio_ring;
mod random_drive;
mod relay;
mod spline;
pub mod terrain;
pub mod traffic;
mod wall_following;
mod way;

pub use a_to_b::{AToB, AToBObservation, AToBOutcome, AToBParameters, Goal, Method};
pub use car::{CarCommand, CarDriver, CarObservation, CarOutcome, CarToB, CarToBParameters};
pub use chase::{Chase, ChaseObservation, ChaseOutcome, ChaseParameters};
pub use coverage::{CoverageMap, CoverageMapParameters, CoveragePlan, Tour, TourOutcome, TourParameters};
pub use cruise::{Cruise, CruiseParameters};
pub use first_steps::{FirstSteps, FirstStepsOutcome, FirstStepsParameters, FirstTask};
pub use follow_me::{Follower, FollowerObservation, FollowerParameters, robots_in};
pub use follower::{PathFollower, PathFollowerParameters, Steering};
pub use formation::Formation;
pub use omni::{
    OmniDriver, OmniOutcome, OmniParameters, OmniPilot, OmniReference, OmniTracker, WheelCommand,
};
pub use path::{Path, PathPoint, Waypoint};
pub use pid::{Pid, PidParameters};
pub use radio_ring::{RadioRing, RadioRingParameters, RingMessages, RingObservation, RingOutcome};
pub use random_drive::{RandomDrive, RandomDriveObservation, RandomDriveParameters};
pub use relay::{RelayTuner, UltimateGain};
pub use spline::Hermite;
pub use wall_following::{
    AlongWall, AlongWallObservation, FollowsWalls, LidarWallFollower, LidarWallFollowerParameters,
    PidWallFollower, PidWallFollowerParameters, TwoLevelWallFollower, WallFollower, WallFollowerParameters,
    WallObservation, WallOutcome, WallPhase, WallReading, WallSensors, WallSide,
};
