use saphyr_parser::Event;

use super::MOST;
use super::lists::{number, pair, points};
use crate::geometry::{Pose, math};
use crate::race::{Cone, ConeColour};
use crate::world::formats::{FormatError, Location, YamlEvents, shown};

/// Knowledge of a car at one moment of a drive.
#[derive(Debug, Clone, PartialEq)]
pub struct ConeFrame {
    /// Pose of the car.
    pub car: Pose,
    /// Speed of the car, if recorded (m/s).
    pub speed: Option<f64>,
    /// Known cones.
    pub cones: Vec<Cone>,
}

/// Colours of the lists of cones.
const COLOURS: [ConeColour; 5] =
    [ConeColour::Unknown, ConeColour::Yellow, ConeColour::Blue, ConeColour::Orange, ConeColour::BigOrange];
/// Keys of a frame.
const KEYS: &str = "car_position, car_direction, car_speed or slam_cones";

/// Reads a log of a car's cone map, in the format of the planner `ft-fsd-path-planning`: a JSON list of
/// frames with `car_position` (m), `car_direction` (a vector), optionally `car_speed` (m/s), and
/// `slam_cones`, five lists: without colour, yellow, blue, orange, large orange. All are in one frame of
/// reference.
///
/// ```
/// use roverlab::race::{ConeColour, parse_cone_log};
/// let text = r#"[{"car_position": [2.0, 0.0], "car_direction": [0.0, 1.0], "car_speed": 3.5,
///     "slam_cones": [[], [[4.0, 1.0]], [], [], []]}]"#;
/// let frames = parse_cone_log(text, "drive.json")?;
/// assert_eq!((frames[0].speed, frames[0].cones[0].colour), (Some(3.5), ConeColour::Yellow));
/// assert!((frames[0].car.heading - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
///
/// # Errors
///
/// If the text is not such a log.
pub fn parse_cone_log(text: &str, file: &str) -> Result<Vec<ConeFrame>, FormatError> {
    let mut events = YamlEvents::new(text, file, "a list of frames");
    match events.first()? {
        (Event::SequenceStart(..), at) => {
            let frames = events.items((MOST, " frame"), |events, event, at| frame(events, &event, at))?;
            if frames.is_empty() {
                return Err(events.error(at, "no frames", "at least one"));
            }
            Ok(frames)
        }
        (event, at) => Err(events.unexpected(&event, at, "a list of frames")),
    }
}

fn frame(events: &mut YamlEvents<'_>, first: &Event<'_>, start: Location) -> Result<ConeFrame, FormatError> {
    if !matches!(first, Event::MappingStart(..)) {
        return Err(events.unexpected(first, start, "a frame with keys"));
    }
    let (mut position, mut heading, mut speed, mut cones) = (None, None, None, None);
    loop {
        let (key, at) = match events.next()? {
            (Event::MappingEnd, _) => break,
            (Event::Scalar(key, ..), at) => (key.into_owned(), at),
            (event, at) => return Err(events.unexpected(&event, at, "a key")),
        };
        let again = match key.as_str() {
            "car_position" => position.replace(next_pair(events)?).is_some(),
            "car_direction" => heading.replace(direction(events)?).is_some(),
            "car_speed" => {
                let (event, at) = events.next()?;
                speed.replace(number(events, &event, at)?).is_some()
            }
            "slam_cones" => cones.replace(lists(events)?).is_some(),
            _ => return Err(events.error(at, shown(&key), KEYS)),
        };
        if again {
            return Err(events.error(at, format!("a second {}", shown(&key)), "each key once in a frame"));
        }
    }
    let lacks = |key: &str| events.error(start, format!("a frame without {key}"), "one with it");
    let position = position.ok_or_else(|| lacks("car_position"))?;
    let heading = heading.ok_or_else(|| lacks("car_direction"))?;
    let cones = cones.ok_or_else(|| lacks("slam_cones"))?;
    Ok(ConeFrame { car: Pose::new(position.x, position.y, heading), speed, cones })
}

fn next_pair(events: &mut YamlEvents<'_>) -> Result<crate::geometry::Point, FormatError> {
    let (event, at) = events.next()?;
    pair(events, &event, at)
}

/// Heading of a vector.
fn direction(events: &mut YamlEvents<'_>) -> Result<f64, FormatError> {
    let (event, at) = events.next()?;
    let vector = pair(events, &event, at)?;
    if vector.coords.norm() < 1e-6 {
        return Err(events.error(at, "a vector without length", "a direction"));
    }
    Ok(math::atan2(vector.y, vector.x))
}

/// Cones of all colours.
fn lists(events: &mut YamlEvents<'_>) -> Result<Vec<Cone>, FormatError> {
    let (event, start) = events.next()?;
    if !matches!(event, Event::SequenceStart(..)) {
        return Err(events.unexpected(&event, start, "five lists of cones"));
    }
    let mut cones = Vec::new();
    for colour in COLOURS {
        cones.extend(points(events)?.into_iter().map(|position| Cone::new(position, colour)));
    }
    match events.next()? {
        (Event::SequenceEnd, _) if cones.len() <= MOST => Ok(cones),
        (Event::SequenceEnd, _) => {
            let found = format!("{} cones", cones.len());
            Err(events.error(start, found, format!("at most {MOST}")))
        }
        (event, at) => Err(events.unexpected(&event, at, "the end of the five lists")),
    }
}
