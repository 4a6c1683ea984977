use std::fmt::Write as _;

use super::MOST;
use super::csv::{Field, field, rows};
use crate::geometry::{Point, Pose};
use crate::race::{Cone, ConeColour, ConeTrack};
use crate::world::formats::{FormatError, Location, shown};

/// Header line of the tracks of the EUFS simulator.
const HEADER: &str = "tag,x,y,direction,x_variance,y_variance,xy_covariance";
/// Valid first entries of a row.
const TAGS: &str = "blue, yellow, orange, big_orange, unknown, car_start or midpoint";

/// Reads a cone map of EUFS: a tag, coordinates (m), and for the start a heading (rad); variances are
/// ignored.
///
/// ```
/// use roverlab::race::{ConeColour, parse_eufs, write_eufs};
/// let text = "tag,x,y,direction,x_variance,y_variance,xy_covariance\n\
///             blue,1.0,1.5,0,0,0,0\nyellow,1.0,-1.5,0,0,0,0\ncar_start,0,0,0.1,0,0,0\n";
/// let track = parse_eufs(text, "short.csv")?;
/// assert_eq!((track.of(ConeColour::Blue).count(), track.start.expect("a start").heading), (1, 0.1));
/// assert_eq!(parse_eufs(&write_eufs(&track), "again.csv")?, track);
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
///
/// # Errors
///
/// If the text is not such a map, or contains no cones or too many.
pub fn parse_eufs(text: &str, file: &str) -> Result<ConeTrack, FormatError> {
    let mut rows = rows(text);
    let header = rows.next();
    if !header.as_ref().is_some_and(|row| is_header(row)) {
        let found = header.map_or_else(|| "an empty file".into(), |row| shown(row[0].text));
        return Err(FormatError::new(file, Location::START, found, format!("the line {HEADER}")));
    }
    let mut track = ConeTrack::default();
    for row in rows {
        let tag = row[0];
        let metres =
            |index| field(&row, index, file, "a number of metres")?.number(file, "a number of metres");
        let colour = match tag.text {
            "car_start" => {
                let direction = row.get(3).map(|f| f.number(file, "a direction in radians")).transpose()?;
                if track.start.is_some() {
                    return Err(FormatError::new(file, tag.at, "a second start", "one start"));
                }
                track.start = Some(Pose::new(metres(1)?, metres(2)?, direction.unwrap_or(0.0)));
                continue;
            }
            // Some files consist of two, one after the other.
            "tag" if is_header(&row) => continue,
            // Points of the path to drive, without a cone.
            "midpoint" => continue,
            "blue" => ConeColour::Blue,
            "yellow" => ConeColour::Yellow,
            "orange" => ConeColour::Orange,
            "big_orange" => ConeColour::BigOrange,
            "unknown" => ConeColour::Unknown,
            _ => return Err(tag.error(file, TAGS)),
        };
        if track.cones.len() == MOST {
            return Err(FormatError::new(file, tag.at, "one more cone", format!("at most {MOST} cones")));
        }
        track.cones.push(Cone::new(Point::new(metres(1)?, metres(2)?), colour));
    }
    if track.cones.is_empty() {
        return Err(FormatError::new(file, Location::START, "no cones", "at least one cone"));
    }
    Ok(track)
}

fn is_header(row: &[Field<'_>]) -> bool {
    row.len() >= 3 && row.iter().zip(["tag", "x", "y"]).all(|(field, name)| field.text == name)
}

/// Writes a cone map that [`parse_eufs`] reads. The format has no timing lines.
pub fn write_eufs(track: &ConeTrack) -> String {
    let mut text = format!("{HEADER}\n");
    for cone in &track.cones {
        let tag = match cone.colour {
            ConeColour::Blue => "blue",
            ConeColour::Yellow => "yellow",
            ConeColour::Orange => "orange",
            ConeColour::BigOrange => "big_orange",
            ConeColour::Unknown => "unknown",
        };
        let _ = writeln!(text, "{tag},{},{},0,0,0,0", cone.position.x, cone.position.y);
    }
    if let Some(start) = track.start {
        let _ = writeln!(text, "car_start,{},{},{},0,0,0", start.x, start.y, start.heading);
    }
    text
}
