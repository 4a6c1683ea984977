//! Navigation (book, chapter 10): sensor-based navigation among unknown obstacles.

mod boundary;
mod distbug;
mod scan_filter;
mod scan_matcher;
mod surroundings;

pub use boundary::WallSide;
pub use distbug::{
    DistBug, DistBugEvent, DistBugObservation, DistBugOutcome, DistBugParameters, DistBugPhase,
};
pub use scan_filter::ScanFilter;
pub use scan_matcher::ScanMatcher;
