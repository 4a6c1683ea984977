//! Lists of numbers in YAML, of which JSON is a subset.

use saphyr_parser::Event;

use super::MOST;
use crate::geometry::Point;
use crate::geometry::units::FARTHEST;
use crate::world::formats::{FormatError, Location, YamlEvents};

/// A list of items read by `item`.
pub(super) fn list_of<'a, T>(
    events: &mut YamlEvents<'a>,
    item: impl FnMut(&mut YamlEvents<'a>, Event<'a>, Location) -> Result<T, FormatError>,
) -> Result<Vec<T>, FormatError> {
    match events.next()? {
        (Event::SequenceStart(..), _) => events.items((MOST, " item"), item),
        (event, at) => Err(events.unexpected(&event, at, "a list")),
    }
}

/// A list of points.
pub(super) fn points(events: &mut YamlEvents<'_>) -> Result<Vec<Point>, FormatError> {
    list_of(events, |events, event, at| pair(events, &event, at))
}

/// A list of x and y, starting at its first event.
pub(super) fn pair(
    events: &mut YamlEvents<'_>,
    first: &Event<'_>,
    at: Location,
) -> Result<Point, FormatError> {
    if !matches!(first, Event::SequenceStart(..)) {
        return Err(events.unexpected(first, at, "a list of x and y"));
    }
    let mut coordinates = [0.0; 2];
    for coordinate in &mut coordinates {
        let (event, at) = events.next()?;
        *coordinate = number(events, &event, at)?;
    }
    match events.next()? {
        (Event::SequenceEnd, _) => Ok(Point::new(coordinates[0], coordinates[1])),
        (event, at) => Err(events.unexpected(&event, at, "the end of the list")),
    }
}

/// A number of bounded size.
pub(super) fn number(events: &YamlEvents<'_>, event: &Event<'_>, at: Location) -> Result<f64, FormatError> {
    let value = match event {
        Event::Scalar(text, ..) => text.parse::<f64>().ok().filter(|value| value.abs() <= FARTHEST),
        _ => None,
    };
    value.ok_or_else(|| events.unexpected(event, at, "a number of metres or radians"))
}
