//! Planning on hills (book, section 7.3): ways that are short, cheap or quick, dearer uphill, and closed where a robot
//! would tip or slip.
//!
//! An [`ElevationMap`] says where a robot can stand. [`ElevationPlanner`] plans on it from sample to sample by Dijkstra's
//! algorithm or A\*, and in any direction; [`ElevationReplanner`] keeps its plan while the map changes. All of them are the
//! planners of [`grid`](super::grid) with other costs.

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
