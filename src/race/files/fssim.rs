use std::fmt::Write as _;

use saphyr_parser::Event;

use super::lists::{list_of, number, points};
use crate::geometry::{Point, Pose};
use crate::race::{Cone, ConeColour, ConeTrack};
use crate::world::formats::{FormatError, Location, YamlEvents, shown};

/// Lists in the tracks of FSSIM, with the colours of their cones.
const KEYS: [(&str, ConeColour); 4] = [
    ("cones_left", ConeColour::Blue),
    ("cones_right", ConeColour::Yellow),
    ("cones_orange", ConeColour::Orange),
    ("cones_orange_big", ConeColour::BigOrange),
];

/// Maximum number of keys in a file; most are ignored.
const MOST_KEYS: usize = 100;

/// Distance from the rear axle to the front wing, where these files place the start (m).
const WING: f64 = 2.15;

/// Reads a track of FSSIM: lists of cones by colour, the start pose of the front wing, and the ends of the
/// timing lines. The start of the track is that of the rear axle, 2.15 m behind the wing. Other keys with
/// lists of numbers are ignored.
///
/// ```
/// use roverlab::race::{ConeColour, parse_fssim, write_fssim};
/// let text = "cones_left: [[1.0, 1.5]]\ncones_right: [[1.0, -1.5], [6.0, -1.5]]\n";
/// let track = parse_fssim(text, "short.yaml")?;
/// assert_eq!((track.of(ConeColour::Blue).count(), track.of(ConeColour::Yellow).count()), (1, 2));
/// assert_eq!(parse_fssim(&write_fssim(&track), "again.yaml")?, track);
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
///
/// # Errors
///
/// If the text is not such a track, or contains no cones or too many.
pub fn parse_fssim(text: &str, file: &str) -> Result<ConeTrack, FormatError> {
    let mut events = YamlEvents::new(text, file, "keys with lists");
    let mut track = ConeTrack::default();
    events.enter()?;
    let mut seen: Vec<String> = Vec::new();
    loop {
        let (key, at) = match events.next()? {
            (Event::MappingEnd, _) => break,
            (Event::Scalar(key, ..), at) => (key.into_owned(), at),
            (event, at) => return Err(events.unexpected(&event, at, "a key")),
        };
        if seen.len() == MOST_KEYS {
            return Err(events.error(at, "one more key", format!("at most {MOST_KEYS} keys")));
        }
        if seen.contains(&key) {
            return Err(events.error(at, format!("a second {}", shown(&key)), "each key once"));
        }
        take(&mut track, &mut events, &key, at)?;
        seen.push(key);
    }
    if track.cones.is_empty() {
        return Err(FormatError::new(file, Location::START, "no cones", "at least one cone"));
    }
    Ok(track)
}

/// Reads the list of a key.
fn take(
    track: &mut ConeTrack,
    events: &mut YamlEvents<'_>,
    key: &str,
    at: Location,
) -> Result<(), FormatError> {
    if let Some((_, colour)) = KEYS.iter().find(|(name, _)| *name == key) {
        track.cones.extend(points(events)?.into_iter().map(|position| Cone::new(position, *colour)));
    } else if key == "tk_device" {
        let ends = points(events)?;
        if ends.len() % 2 == 1 {
            return Err(events.error(at, format!("{} points", ends.len()), "two for each line"));
        }
        track.gates = ends.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
    } else {
        let numbers = list_of(events, |events, event, at| number(events, &event, at))?;
        if key == "starting_pose_front_wing" {
            let [x, y, heading] = numbers[..] else {
                let found = format!("{} numbers", numbers.len());
                return Err(events.error(at, found, "x, y and the heading"));
            };
            track.start = Some(Pose::new(x, y, heading).compose(&Pose::new(-WING, 0.0, 0.0)));
        }
    }
    Ok(())
}

/// Writes a track that [`parse_fssim`] reads. The format has no cones without colour.
pub fn write_fssim(track: &ConeTrack) -> String {
    let mut text = String::new();
    for (key, colour) in KEYS {
        list(&mut text, key, track.of(colour));
    }
    list(&mut text, "tk_device", track.gates.iter().flatten().copied());
    if let Some(start) = track.start.map(|start| start.compose(&Pose::new(WING, 0.0, 0.0))) {
        let _ = writeln!(
            text,
            "starting_pose_front_wing:\n- {:?}\n- {:?}\n- {:?}",
            start.x, start.y, start.heading
        );
    }
    text
}

fn list(text: &mut String, key: &str, points: impl Iterator<Item = Point>) {
    let mut points = points.peekable();
    let empty = points.peek().is_none();
    let _ = writeln!(text, "{key}:{}", if empty { " []" } else { "" });
    for point in points {
        let _ = writeln!(text, "- - {:?}\n  - {:?}", point.x, point.y);
    }
}
