//! Mazes (book, chapter 9): models and files, flood fill, shortest routes and fast runs.
//!
//! A [`Maze`] is a robot's knowledge of a maze: walls are present, absent or unknown. [`files`] reads and
//! writes the common formats. [`FloodFill`] counts steps, [`shortest_route`] finds the route with the fewest
//! steps or turns, [`FastPlanner`] the fastest run with smooth turns and diagonals. An [`Explorer`] decides
//! where to look next; a [`MazeRunner`] drives a robot there, explores and races. [`mms`] implements the
//! protocol of a maze simulator.
//!
//! ```
//! use roverlab::maze::{Preference, Unknown, files, shortest_route};
//!
//! let text = "\
//! o---o---o---o
//! |     G |   |
//! o   o---o   o
//! | S         |
//! o---o---o---o
//! ";
//! let file = files::parse(text.as_bytes(), "small.txt")?;
//! assert!(file.defects.is_empty());
//! let route = shortest_route(&file.maze, Unknown::Closed, Preference::Steps).expect("a way to the goal");
//! assert_eq!((route.steps(), route.turns()), (2, 1));
//! # Ok::<(), roverlab::world::formats::FormatError>(())
//! ```

mod bits;
mod compass;
mod defect;
mod explore;
mod fast;
pub mod files;
mod flood;
mod follow;
pub mod generate;
pub mod mms;
mod model;
mod route;
mod run;
mod scale;
#[cfg(feature = "petgraph")]
mod with_petgraph;

pub use compass::{Cell, Direction};
pub use defect::{Defect, defects};
pub use explore::{
    ExplorationOutcome, ExplorationStep, Explorer, Goals, RecursiveExplorer, TwoPhaseExplorer,
};
pub use fast::{FastPlan, FastPlanner, Piece, RunLimits, Trajectory, TrajectoryPoint, TurnKind};
pub use flood::{Distances, FloodFill, IncrementalFlood, Passages, distances_from_start, distances_to_goal};
pub use follow::{
    CellDrive, CellDriveParameters, LeftHand, LeftHandObservation, LeftHandOutcome, LeftHandParameters,
    LidarLeft, LidarLeftObservation, LidarLeftParameters, Straight,
};
pub use model::{Maze, Unknown, WallState};
pub use route::{Preference, Route, shortest_route, shortest_route_between};
pub use run::{
    Calibration, Exploration, MazeLocaliser, MazeRunner, MazeRunnerParameters, Rig, RigSensor,
    TrajectoryTracker, TrajectoryTrackerParameters, mouse,
};
pub use scale::Scale;
#[cfg(feature = "petgraph")]
pub use with_petgraph::petgraph_of_maze;
