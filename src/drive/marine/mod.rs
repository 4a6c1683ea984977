//! Craft in water (book, chapter 8): diving, along the sides of a pool, surveys of its floor, and
//! boats on a course.
//!
//! - [`Dive`]: to a depth, and there level on a heading, by pressure sensor and inertial unit;
//! - [`PoolWall`]: along the sides of a pool at a depth, by distance sensors;
//! - [`Survey`]: lanes over the floor, with its place by walls, Doppler log and compass, and [`DepthMap`];
//! - [`PoolSearch`]: the same lanes with the camera down, to find something by its colour;
//! - [`Boat`]: a boat on a course, and on its station at the end;
//! - [`DepthHold`]: the controller of depth inside them;
//! - [`Thrust`]: what a behaviour tells a craft's thrusters.

mod alignment;
mod boat;
mod colour_spotter;
mod depth_hold;
mod depth_map;
mod dive;
mod fix;
mod helm;
mod legs;
mod observation;
mod pool_search;
mod pool_wall;
mod reckoning;
mod slow_motion;
mod survey;
mod thrust;
mod wall_memory;
mod zero;

pub use boat::{Boat, BoatObservation, BoatOutcome, BoatParameters};
pub use depth_hold::{DepthHold, DepthHoldParameters};
pub use depth_map::{CellDepth, DepthMap, Sounding};
pub use dive::{Dive, DiveOutcome, DiveParameters};
pub use observation::DiveObservation;
pub use pool_search::{PoolSearch, PoolSearchObservation, PoolSearchOutcome, PoolSearchParameters};
pub use pool_wall::{PoolWall, PoolWallObservation, PoolWallOutcome, PoolWallParameters};
pub use survey::{Survey, SurveyObservation, SurveyOutcome, SurveyParameters};
pub use thrust::Thrust;
