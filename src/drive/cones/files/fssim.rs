use std::fmt::Write as _;

use saphyr_parser::{Event, Parser, Span, StrInput};

use super::csv::shown;
use super::{FARTHEST, MOST};
use crate::drive::cones::{Cone, ConeColour, ConeTrack};
use crate::geometry::{Point, Pose};
use crate::world::formats::{FormatError, Location};

const KEYS: [(&str, ConeColour); 4] = [
    ("cones_left", ConeColour::Blue),
    ("cones_right", ConeColour::Yellow),
    ("cones_orange", ConeColour::Orange),
    ("cones_orange_big", ConeColour::BigOrange),
];

/// Reads a track of FSSIM: lists of cones by colour, the pose of the front wing at the start, and the ends of the lines
/// where time is taken. Other keys with lists of numbers are left out.
pub fn parse_fssim(text: &str, file: &str) -> Result<ConeTrack, FormatError> {
    let mut reader = Reader { parser: Parser::new_from_str(text), file };
    let mut track = ConeTrack::default();
    loop {
        match reader.next()? {
            (Event::MappingStart(..), _) => break,
            (Event::StreamStart | Event::DocumentStart(_), _) => {}
            (event, at) => return Err(reader.unexpected(&event, at, "keys with lists")),
        }
    }
    let mut seen: Vec<String> = Vec::new();
    loop {
        let (key, at) = match reader.next()? {
            (Event::MappingEnd, _) => break,
            (Event::Scalar(key, ..), at) => (key.into_owned(), at),
            (event, at) => return Err(reader.unexpected(&event, at, "a key")),
        };
        if seen.contains(&key) {
            return Err(FormatError::new(file, at, format!("a second {}", shown(&key)), "each key once"));
        }
        seen.push(key.clone());
        if let Some((_, colour)) = KEYS.iter().find(|(name, _)| *name == key) {
            let points = reader.points()?;
            track.cones.extend(points.into_iter().map(|position| Cone::new(position, *colour)));
        } else if key == "tk_device" {
            let points = reader.points()?;
            track.gates = points.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        } else {
            let numbers = reader.list(|reader, event, at| reader.number(&event, at))?;
            if key == "starting_pose_front_wing" {
                let [x, y, heading] = numbers[..] else {
                    let found = format!("{} numbers", numbers.len());
                    return Err(FormatError::new(file, at, found, "x, y and the heading"));
                };
                track.start = Some(Pose::new(x, y, heading));
            }
        }
    }
    if track.cones.is_empty() {
        return Err(FormatError::new(file, Location::START, "no cones", "at least one cone"));
    }
    Ok(track)
}

/// A track as [`parse_fssim`] reads it. Cones without a colour have no place in it and are left out.
pub fn write_fssim(track: &ConeTrack) -> String {
    let mut text = String::new();
    for (key, colour) in KEYS {
        list(&mut text, key, track.of(colour));
    }
    list(&mut text, "tk_device", track.gates.iter().flatten().copied());
    if let Some(start) = track.start {
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

struct Reader<'a> {
    parser: Parser<'a, StrInput<'a>>,
    file: &'a str,
}

impl<'a> Reader<'a> {
    fn next(&mut self) -> Result<(Event<'a>, Location), FormatError> {
        match self.parser.next_event() {
            Some(Ok((event, span))) => Ok((event, place(span))),
            Some(Err(error)) => {
                let at = Location { line: error.marker().line(), column: error.marker().col() + 1 };
                Err(FormatError::new(self.file, at, format!("broken YAML ({})", error.info()), "YAML"))
            }
            None => {
                Err(FormatError::new(self.file, Location::START, "the end of the file", "keys with lists"))
            }
        }
    }

    /// A list of what `item` makes of its events.
    fn list<T>(
        &mut self,
        mut item: impl FnMut(&mut Self, Event<'a>, Location) -> Result<T, FormatError>,
    ) -> Result<Vec<T>, FormatError> {
        match self.next()? {
            (Event::SequenceStart(..), _) => {}
            (event, at) => return Err(self.unexpected(&event, at, "a list")),
        }
        let mut items = Vec::new();
        loop {
            match self.next()? {
                (Event::SequenceEnd, _) => return Ok(items),
                (_, at) if items.len() == MOST => {
                    let expected = format!("at most {MOST} of them");
                    return Err(FormatError::new(self.file, at, "one more", expected));
                }
                (event, at) => items.push(item(self, event, at)?),
            }
        }
    }

    fn points(&mut self) -> Result<Vec<Point>, FormatError> {
        self.list(|reader, event, at| {
            if !matches!(event, Event::SequenceStart(..)) {
                return Err(reader.unexpected(&event, at, "a list of x and y"));
            }
            let mut coordinates = [0.0; 2];
            for coordinate in &mut coordinates {
                let (event, at) = reader.next()?;
                *coordinate = reader.number(&event, at)?;
            }
            match reader.next()? {
                (Event::SequenceEnd, _) => Ok(Point::new(coordinates[0], coordinates[1])),
                (event, at) => Err(reader.unexpected(&event, at, "the end of the list")),
            }
        })
    }

    fn number(&self, event: &Event<'a>, at: Location) -> Result<f64, FormatError> {
        let value = match event {
            Event::Scalar(text, ..) => text.parse::<f64>().ok().filter(|value| value.abs() <= FARTHEST),
            _ => None,
        };
        value.ok_or_else(|| self.unexpected(event, at, "a number of metres or radians"))
    }

    fn unexpected(&self, event: &Event<'_>, at: Location, expected: &str) -> FormatError {
        let found = match event {
            Event::Scalar(text, ..) => shown(text),
            Event::SequenceStart(..) => "a list".into(),
            Event::MappingStart(..) => "keys with values".into(),
            Event::Alias(_) => "an alias".into(),
            Event::SequenceEnd => "the end of a list".into(),
            _ => "the end of the file".into(),
        };
        FormatError::new(self.file, at, found, expected)
    }
}

fn place(span: Span) -> Location {
    Location { line: span.start.line().max(1), column: span.start.col() + 1 }
}
