//! Planning on hills (book, section 7.3): paths of minimum length, energy or time that cost more uphill and
//! avoid slopes on which the robot would tip or slip.
//!
//! An [`ElevationMap`] holds where a robot can stand. [`ElevationPlanner`] plans on it, from sample to sample
//! by Dijkstra's algorithm or A\*, or at any angle; [`ElevationReplanner`] repairs its plan when the map
//! changes. Both use the planners of [`grid`](super::grid) with other costs.

mod climber;
mod costs;
mod map;
mod planner;
mod replanner;
mod straight;
#[cfg(test)]
mod tests;

pub use climber::Climber;
pub use costs::{GroundCosts, Objective};
pub use map::ElevationMap;
pub use planner::{ElevationPath, ElevationPlanner};
pub use replanner::ElevationReplanner;
