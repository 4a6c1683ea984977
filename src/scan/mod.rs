//! What is made of a lidar's scans (book, chapters 3 and 4): free of noise, as walls and corners, as a map,
//! and as the place where the robot must be.
//!
//! - [`ScanFilter`]: takes most of the noise out of the scans of a moving robot;
//! - [`extract_features`]: walls, corners and objects; [`plot_scan`]: the scan on the robot's display;
//! - [`ScanMatcher`]: odometry corrected by what stays where it is;
//! - [`Localiser`]: where the robot is in a world that it knows;
//! - [`LandmarkFilter`]: odometry corrected by what a lidar sees of known landmarks;
//! - [`LogOddsMap`]: a map made of scans.

mod filter;
mod landmark;
mod lidar;
mod localisation;
mod log_odds;
mod matcher;
mod reference;

pub use filter::ScanFilter;
pub(crate) use filter::check_measured;
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
