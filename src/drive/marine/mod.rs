//! Craft in water (book, chapter 8): diving, following the sides of a pool, surveying its floor, and boats on
//! a course.
//!
//! - [`Dive`]: goes to a depth and stays there, level and on a heading, by pressure sensor and inertial unit;
//! - [`PoolWall`]: follows the sides of a pool at a depth, by distance sensors;
//! - [`Survey`]: drives lanes over the floor at a depth or an altitude, localised by walls, Doppler log and compass;
//!   [`DepthMap`] maps it;
//! - [`PoolSearch`]: drives the same lanes with the camera pointing down, and finds an object by its colour;
//! - [`Boat`]: follows a course and keeps station at its end;
//! - [`DepthHold`]: the depth controller inside them;
//! - [`Thrust`]: the command of these behaviours to the thrusters.

mod alignment;
mod boat;
mod colour_spotter;
mod depth_hold;
mod depth_map;
mod dive;
mod fix;
mod floor_track;
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
