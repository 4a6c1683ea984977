//! Navigation (book, chapter 10): sensor-based navigation among unknown obstacles, the ground truth of which
//! goals can be reached, and planning on maps ([`grid`]), on hills
//! ([`elevation`]) and in graphs ([`graph`]).

mod boundary;
mod bug;
pub mod elevation;
pub mod graph;
pub mod grid;
mod navigate;
mod reachability;
mod summit;
mod surroundings;

pub use crate::geometry::WallSide;
pub use bug::{
    Alg1, Alg2, Bug, Bug1, Bug2, BugEvent, BugKind, BugOutcome, BugParameters, BugPhase, Class1, DistBug,
    Guarantee, LeaveBug, OneBug, PathBound, Rev1, Rev2, TangentBug, UnknownBug,
};
pub use navigate::{Navigator, NavigatorEvent, NavigatorOutcome, NavigatorParameters, NavigatorPhase};
pub use reachability::{CellPath, Reachability};
pub use summit::{
    Fence, RampCrossing, RampLeg, RampOutcome, SummitObservation, SummitOutcome, SummitParameters,
    SummitPhase, SummitSearch,
};
