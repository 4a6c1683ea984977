//! Fast runs: the time-optimal path through a known maze, and its speed profile (book, section 9.8).

mod bound;
mod builder;
mod limits;
mod plan;
mod planner;
mod profile;
mod search;
mod shape;
#[cfg(test)]
mod tests;
mod trajectory;
mod turn;

pub use limits::RunLimits;
pub use plan::{FastPlan, Piece};
pub use planner::FastPlanner;
pub use trajectory::{Trajectory, TrajectoryPoint};
pub use turn::TurnKind;
