//! Readers and writers of track files: YAML of FSSIM, CSV of EUFS, CSV of the TUM racetrack database; and a
//! reader of logs of drives between cones.
//!
//! All are in metres and radians.

mod csv;
mod eufs;
mod fssim;
mod lists;
mod log;
mod tum;

pub use eufs::{parse_eufs, write_eufs};
pub use fssim::{parse_fssim, write_fssim};
pub use log::{ConeFrame, parse_cone_log};
pub use tum::{parse_line, parse_tum, write_tum};

use super::{ConeTrack, Corridor};
use crate::geometry::Point;
use crate::world::formats::{FormatError, Location, shown};

/// Maximum length of a file (bytes).
const LONGEST: usize = 16 << 20;
/// Maximum number of cones or stations in a file.
const MOST: usize = 20_000;

/// Content of a track file.
#[derive(Debug, Clone, PartialEq)]
pub enum TrackFile {
    /// Cones (FSSIM, EUFS).
    Cones(ConeTrack),
    /// Centre line with widths (TUM).
    Corridor(Corridor),
    /// Line without widths, such as the race lines of TUM.
    Line(Vec<Point>),
    /// Log of a car's knowledge (JSON).
    Log(Vec<ConeFrame>),
}

/// Reads a track file of any format, recognised by its beginning. Messages use `file` as its name.
///
/// ```
/// use roverlab::race::{TrackFile, parse_track};
/// let text = "tag,x,y,direction,x_variance,y_variance,xy_covariance\nblue,1.0,1.5,0,0,0,0\nyellow,1.0,-1.5,0,0,0,0\n";
/// let Ok(TrackFile::Cones(track)) = parse_track(text, "two.csv") else { panic!() };
/// assert_eq!(track.cones.len(), 2);
/// let error = parse_track("tag,x,y\nblue,1.0,here\n", "bad.csv").unwrap_err();
/// assert_eq!(error.to_string(), "bad.csv:2:10: found `here`; expected a number of metres");
/// ```
///
/// # Errors
///
/// If the text is not a track in one of the formats, or longer than 16 MiB.
pub fn parse_track(text: &str, file: &str) -> Result<TrackFile, FormatError> {
    if text.len() > LONGEST {
        let found = format!("{} bytes", text.len());
        return Err(FormatError::new(file, Location::START, found, "a file of at most 16 MiB"));
    }
    let first = text.lines().find(|line| !line.trim().is_empty()).unwrap_or("");
    let first = first.trim_start_matches('\u{feff}').trim_start();
    if first.starts_with('[') {
        return parse_cone_log(text, file).map(TrackFile::Log);
    }
    if first.starts_with("tag") {
        return parse_eufs(text, file).map(TrackFile::Cones);
    }
    if first.starts_with('#') && first.contains(',') {
        if first.contains("w_tr") {
            return parse_tum(text, file).map(TrackFile::Corridor);
        }
        return parse_line(text, file).map(TrackFile::Line);
    }
    if is_csv(first, file) {
        let found = if first.is_empty() { "an empty file".into() } else { shown(first) };
        return Err(FormatError::new(file, Location::START, found, CSV));
    }
    parse_fssim(text, file).map(TrackFile::Cones)
}

/// Beginnings of the CSV files.
const CSV: &str = "a line that begins with tag,x,y (EUFS), # x_m,y_m,w_tr_right_m,w_tr_left_m (TUM), or # x_m,y_m (a race line of TUM)";

/// Whether a file is meant to be comma-separated: by its name, unless it begins with a key, or because its
/// first line is a row of numbers.
fn is_csv(first: &str, file: &str) -> bool {
    let named = file.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case("csv"));
    (named && !first.contains(':'))
        || (first.contains(',') && first.split(',').all(|field| field.trim().parse::<f64>().is_ok()))
}
