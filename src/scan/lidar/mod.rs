//! Interpretation of lidar scans (book, chapter 4): walls, corners, objects, and the scan itself on the
//! display.

mod clusters;
mod extrema;
mod features;
mod parameters;
mod plot;
mod split_merge;

pub use extrema::{Extremum, ExtremumKind, local_extrema};
pub use features::{ScanCorner, ScanFeatures, ScanObject, ScanWall, extract_features};
pub use parameters::ScanFeaturesParameters;
pub use plot::plot_scan;
