//! Navigation (book, chapter 10): sensor-based navigation among unknown obstacles, the truth about which goals
//! can be reached, and planning on maps ([`grid`]).

mod boundary;
mod distbug;
pub mod grid;
mod reachability;
mod scan_filter;
mod scan_matcher;
mod scan_reference;
mod surroundings;

pub use boundary::WallSide;
pub use distbug::{
    DistBug, DistBugEvent, DistBugObservation, DistBugOutcome, DistBugParameters, DistBugPhase,
};
pub use reachability::Reachability;
pub use scan_filter::ScanFilter;
pub use scan_matcher::ScanMatcher;
