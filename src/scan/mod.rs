//! Processing of lidar scans (book, chapters 3 and 4): noise filters, features, maps and localisation.
//!
//! - [`ScanFilter`]: removes most of the noise from the scans of a moving robot;
//! - [`extract_features`]: walls, corners and objects; [`plot_scan`]: the scan on the robot's display;
//! - [`ScanMatcher`]: odometry corrected by scan matching;
//! - [`Localiser`]: global localisation in a known world;
//! - [`LandmarkFilter`]: odometry corrected by known landmarks;
//! - [`LogOddsMap`]: an occupancy grid built from scans.

mod filter;
mod landmark;
mod lidar;
mod localisation;
mod log_odds;
mod matcher;
mod reference;

pub use filter::ScanFilter;
pub use landmark::{Landmark, LandmarkFilter};
pub use lidar::{
    Extremum, ExtremumKind, ScanCorner, ScanFeatures, ScanFeaturesParameters, ScanObject, ScanWall,
    extract_features, local_extrema, plot_scan,
};
#[cfg(feature = "nav")]
pub(crate) use localisation::HEIGHT;
pub use localisation::{Hypothesis, Localisation, LocalisationMap, Localiser, LocaliserParameters};
pub use log_odds::{LogOddsMap, LogOddsMapParameters};
pub use matcher::ScanMatcher;
