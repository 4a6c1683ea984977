//! Navigation (book, chapter 10): sensor-based navigation among unknown obstacles, and the truth about which goals
//! can be reached.

mod boundary;
mod distbug;
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
