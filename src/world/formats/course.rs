//! Files of courses for model cars, in a plain format of our own; see `docs/courses.md`.

use std::fmt::Write as _;

use super::args::Args;
use super::error::{FormatError, Location};
use super::lexer::{self, Line as Words, shown};
use super::number::{degrees, millimetres};
use crate::geometry::{Pose, units};
use crate::world::road::{
    Alignment, Centre, Crossing, Element, Line, RightOfWay, RoadCourse, RoadMark, RoadMarkKind, RoadSide,
    Traffic,
};

/// Largest length for which a road is computed, if only to report its error (m).
const LONGEST: f64 = 1000.0;
/// Largest number of sections and marks of a course.
const MOST: usize = 10_000;
/// Default length of a crossing's arm at the scale of the rules (m).
const ARM: f64 = 1.0;
const KEYWORDS: &str = "a statement of a course: traffic, scale, lane, line, start, straight, arc, clothoid, centre, \
    start-line, gap, side-road, crossing, stop-line, give-way-line, zebra, barred, arrow, speed, speed-end, parking or artefact";

/// Reads a course strictly: nothing is ignored or guessed.
///
/// ```
/// use roverlab::world::formats::course;
/// let text = "course 1\nstraight 3000\narc 1500 180\nstraight 3000\nzebra\narc 1500 180\n";
/// let course = course::parse(text, "oval.course")?;
/// assert!((course.line.length() - 15.42).abs() < 0.01);
/// assert!(course::print(&course).contains("zebra"));
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
pub fn parse(text: &str, file: &str) -> Result<RoadCourse, FormatError> {
    let mut draft = Draft::default();
    let mut is_first = true;
    for (number, text) in lexer::numbered(text) {
        let Some(line) = lexer::line(file, number, text)? else { continue };
        if std::mem::take(&mut is_first) {
            head(&line)?;
        } else {
            draft.read(&line)?;
        }
    }
    if is_first {
        return Err(FormatError::new(file, Location::START, "an empty file", "`course 1`"));
    }
    draft.finish(file)
}

/// Writes a course in the form that [`parse`] reads.
pub fn print(course: &RoadCourse) -> String {
    let mut text = String::from("course 1\n");
    let mm = |metres: f64| millimetres(metres / course.size);
    let side = if course.traffic == Traffic::Left { "left" } else { "right" };
    let _ = writeln!(text, "traffic {side}\nscale {}", 1.0 / course.size);
    let _ = writeln!(text, "lane {}\nline {}", mm(course.lane_width), mm(course.line_width));
    if let Some(first) = course.line.stations().first() {
        let Pose { x, y, heading } = first.pose;
        let _ = writeln!(text, "start {} {} {}", mm(x), mm(y), degrees(heading));
    }
    let mut events: Vec<(f64, String)> =
        course.centre.iter().map(|&(at, kind)| (at, format!("centre {}", name_of(&CENTRES, kind)))).collect();
    events.extend(course.marks.iter().map(|mark| (mark.at, shown_mark(&mark.kind, &mm))));
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut events = events.into_iter().peekable();
    let mut begun = 0.0;
    let elements = course.line.elements();
    for (index, element) in elements.iter().enumerate() {
        let end = begun + element.length;
        let mut done = begun;
        let is_last = index + 1 == elements.len();
        while let Some((at, event)) = events.next_if(|(at, _)| *at < end || is_last) {
            section(&mut text, element, (done - begun, at.min(end) - begun), course.size);
            done = at.max(done).min(end);
            let _ = writeln!(text, "{event}");
        }
        section(&mut text, element, (done - begun, element.length), course.size);
        begun = end;
    }
    text
}

/// Writes a part of an element, if its length is not zero.
fn section(text: &mut String, element: &Element, (from, to): (f64, f64), size: f64) {
    let long = to - from;
    if long <= 1e-9 {
        return;
    }
    let mm = |metres: f64| millimetres(metres / size);
    let [first, last] = element.curvature;
    let bend = |along: f64| first + (last - first) * along / element.length;
    let radius = |bend: f64| if bend.abs() < 1e-9 { "0".to_owned() } else { mm(1.0 / bend) };
    let _ = if first == 0.0 && last == 0.0 {
        writeln!(text, "straight {}", mm(long))
    } else if first == last {
        writeln!(text, "arc {} {}", mm(1.0 / first.abs()), degrees_of(long * first))
    } else {
        writeln!(text, "clothoid {} {} {}", mm(long), radius(bend(from)), radius(bend(to)))
    };
}

/// Degrees of an arc, which may exceed half a turn.
fn degrees_of(radians: f64) -> String {
    format!("{}", units::to_deg(radians))
}

fn shown_mark(kind: &RoadMarkKind, mm: &impl Fn(f64) -> String) -> String {
    let side = |side: RoadSide| name_of(&SIDES, side);
    match *kind {
        RoadMarkKind::Start => "start-line".into(),
        RoadMarkKind::Gap(line, long) => format!("gap {} {}", name_of(&LINES, line), mm(long)),
        RoadMarkKind::SideRoad(at, long) => format!("side-road {} {}", side(at), mm(long)),
        RoadMarkKind::Crossing(Crossing { angle, arms, right_of_way }) => {
            let which = match arms.map(|arm| arm > 0.0) {
                [true, true] => "both",
                [true, false] => "left",
                [false, true] => "right",
                [false, false] => "none",
            };
            let who = name_of(&RIGHTS, right_of_way);
            format!("crossing {} {which} {} {who}", degrees(angle), mm(arms[0].max(arms[1])))
        }
        RoadMarkKind::StopLine => "stop-line".into(),
        RoadMarkKind::GiveWayLine => "give-way-line".into(),
        RoadMarkKind::Zebra => "zebra".into(),
        RoadMarkKind::Barred(at, long, wide) => format!("barred {} {} {}", side(at), mm(long), mm(wide)),
        RoadMarkKind::Arrow(to) => format!("arrow {}", side(to)),
        RoadMarkKind::Speed(value, struck) => format!("speed{} {value}", if struck { "-end" } else { "" }),
        RoadMarkKind::Parking(at, long) => format!("parking {} {}", side(at), mm(long)),
        RoadMarkKind::Artefact(left, long, wide) => {
            format!("artefact {} {} {}", mm(left), mm(long), mm(wide))
        }
    }
}

const CENTRES: [(&str, Centre); 4] = [
    ("dashed", Centre::Dashed),
    ("double", Centre::Double),
    ("solid-left", Centre::SolidLeft),
    ("solid-right", Centre::SolidRight),
];
/// Words for the lines of a road.
const LINES: [(&str, Line); 3] = [("left", Line::Left), ("centre", Line::Centre), ("right", Line::Right)];
/// Words for the sides of a road.
const SIDES: [(&str, RoadSide); 2] = [("left", RoadSide::Left), ("right", RoadSide::Right)];
/// Words for the sides on which cars drive.
const TRAFFIC: [(&str, Traffic); 2] = [("right", Traffic::Right), ("left", Traffic::Left)];
/// Words for the arms of a crossing, with the lengths of the left and the right one (shares).
const ARMS: [(&str, [f64; 2]); 4] =
    [("both", [1.0, 1.0]), ("left", [1.0, 0.0]), ("right", [0.0, 1.0]), ("none", [0.0, 0.0])];
/// Words for the rights of way at a crossing.
const RIGHTS: [(&str, RightOfWay); 4] = [
    ("priority", RightOfWay::Priority),
    ("stop", RightOfWay::Stop),
    ("give-way", RightOfWay::GiveWay),
    ("from-the-right", RightOfWay::FromTheRight),
];

fn name_of<T: PartialEq + Copy>(names: &[(&'static str, T)], value: T) -> &'static str {
    names.iter().find(|(_, known)| *known == value).map_or("", |(name, _)| name)
}

/// The first line identifies the format.
fn head(line: &Words<'_>) -> Result<(), FormatError> {
    if line.words[0].text != "course" {
        return Err(line.error(0, "`course 1`"));
    }
    let mut args = Args::after_keyword(line);
    args.count("the version of the format", 1..=1)?;
    end(line, &args)
}

/// Fails at an extra word.
fn end(line: &Words<'_>, args: &Args<'_, '_>) -> Result<(), FormatError> {
    if args.left() == 0 {
        Ok(())
    } else {
        Err(line.error(line.words.len() - args.left(), "the end of the line"))
    }
}

/// A word from a list.
fn choice<T: Copy>(
    line: &Words<'_>,
    args: &mut Args<'_, '_>,
    names: &[(&'static str, T)],
) -> Result<T, FormatError> {
    let list = names.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
    let at = line.words.len() - args.left();
    let word = args.word(&list)?;
    let found = names.iter().find(|(name, _)| *name == word.text);
    found.map(|(_, value)| *value).ok_or_else(|| line.error(at, list))
}

/// The part of a course that has been read, at the scale of the rules.
struct Draft {
    traffic: Traffic,
    scale: f64,
    lane: f64,
    line: f64,
    start: Pose,
    elements: Vec<Element>,
    centre: Vec<(f64, Centre)>,
    marks: Vec<RoadMark>,
    length: f64,
}

impl Default for Draft {
    fn default() -> Self {
        Self {
            traffic: Traffic::Right,
            scale: 1.0,
            lane: 0.4,
            line: 0.02,
            start: Pose::default(),
            elements: Vec::new(),
            centre: vec![(0.0, Centre::Dashed)],
            marks: Vec::new(),
            length: 0.0,
        }
    }
}

impl Draft {
    fn read(&mut self, line: &Words<'_>) -> Result<(), FormatError> {
        let mut args = Args::after_keyword(line);
        if !(self.of_all(line, &mut args)? || self.section(line, &mut args)?) {
            let kind = mark(line, &mut args)?;
            self.marks.push(RoadMark { at: self.length, kind });
        }
        end(line, &args)?;
        if self.elements.len() + self.marks.len() + self.centre.len() > MOST {
            return Err(line.error(0, format!("at most {MOST} sections and marks")));
        }
        Ok(())
    }

    /// Reads a statement about the whole course, which must precede the first section.
    fn of_all(&mut self, line: &Words<'_>, args: &mut Args<'_, '_>) -> Result<bool, FormatError> {
        match line.words[0].text {
            "traffic" => self.traffic = choice(line, args, &TRAFFIC)?,
            "scale" => self.scale = args.plain("the scale", 0.2..=5.0)?,
            "lane" => self.lane = args.positive_size("the width of a lane")?,
            "line" => self.line = args.positive_size("the width of a line")?,
            "start" => {
                let (x, y) = (args.length("x of the start")?, args.length("y of the start")?);
                self.start = Pose::new(x, y, args.direction("the heading at the start")?);
            }
            _ => return Ok(false),
        }
        if self.elements.is_empty() { Ok(true) } else { Err(line.error(0, "it before the first section")) }
    }

    /// Reads a part of the road, or the kind of its centre marking from here on.
    fn section(&mut self, line: &Words<'_>, args: &mut Args<'_, '_>) -> Result<bool, FormatError> {
        let element = match line.words[0].text {
            "straight" => Element::straight(args.positive_size("the length")?),
            "arc" => {
                let radius = args.positive_size("the radius")?;
                let angle = args.degrees("the angle", -360.0..=360.0)?;
                if angle == 0.0 {
                    return Err(line.error(2, "an angle other than 0"));
                }
                Element::arc(radius, units::from_deg(angle))
            }
            "clothoid" => {
                let long = args.positive_size("the length")?;
                let mut bend = |what| {
                    let radius = args.length(what)?;
                    Ok::<_, FormatError>(if radius == 0.0 { 0.0 } else { 1.0 / radius })
                };
                Element::clothoid(long, bend("the radius it begins with")?, bend("the radius it ends with")?)
            }
            "centre" => {
                self.centre.push((self.length, choice(line, args, &CENTRES)?));
                return Ok(true);
            }
            _ => return Ok(false),
        };
        self.length += element.length;
        self.elements.push(element);
        Ok(true)
    }

    /// The course at its own scale.
    fn finish(self, file: &str) -> Result<RoadCourse, FormatError> {
        let wrong = |found: &str, expected: &str| FormatError::new(file, Location::START, found, expected);
        if self.length > LONGEST {
            return Err(wrong(&format!("a road of {:.1} m", self.length), "a road of at most 500 m"));
        }
        let course = RoadCourse {
            traffic: self.traffic,
            size: 1.0,
            line: Alignment::new(self.start, self.elements),
            lane_width: self.lane,
            line_width: self.line,
            centre: self.centre,
            marks: self.marks,
        };
        let course = course.scaled(1.0 / self.scale);
        course.check().map(|()| course).map_err(|error| {
            let text = error.to_string();
            let (found, expected) = text.split_once("; expected ").unwrap_or((&text, "a course"));
            wrong(found, expected)
        })
    }
}

/// Reads a mark at the present place.
fn mark(line: &Words<'_>, args: &mut Args<'_, '_>) -> Result<RoadMarkKind, FormatError> {
    Ok(match line.words[0].text {
        "start-line" => RoadMarkKind::Start,
        "gap" => RoadMarkKind::Gap(choice(line, args, &LINES)?, args.positive_size("the length")?),
        "side-road" => RoadMarkKind::SideRoad(choice(line, args, &SIDES)?, args.positive_size("the length")?),
        "crossing" => RoadMarkKind::Crossing(crossing(line, args)?),
        "stop-line" => RoadMarkKind::StopLine,
        "give-way-line" => RoadMarkKind::GiveWayLine,
        "zebra" => RoadMarkKind::Zebra,
        "barred" => {
            let (side, long) = (choice(line, args, &SIDES)?, args.positive_size("the length")?);
            RoadMarkKind::Barred(side, long, args.positive_size("the width")?)
        }
        "arrow" => RoadMarkKind::Arrow(choice(line, args, &SIDES)?),
        "speed" | "speed-end" => {
            let value = args.count("the speed", 0..=99)? as u8;
            RoadMarkKind::Speed(value, line.words[0].text == "speed-end")
        }
        "parking" => RoadMarkKind::Parking(choice(line, args, &SIDES)?, args.positive_size("the length")?),
        "artefact" => {
            let left = args.length("metres to the left")?;
            let long = args.positive_size("the length")?;
            RoadMarkKind::Artefact(left, long, args.positive_size("the width")?)
        }
        _ => return Err(FormatError::new(line.file, line.location(0), shown(line.words[0].text), KEYWORDS)),
    })
}

/// The angle, the existing arms, their length, and the right of way; all but the angle are optional.
fn crossing(line: &Words<'_>, args: &mut Args<'_, '_>) -> Result<Crossing, FormatError> {
    let angle = units::from_deg(args.degrees("the angle", 60.0..=120.0)?);
    let arms = if args.left() > 0 { choice(line, args, &ARMS)? } else { [1.0, 1.0] };
    let is_long = args.numbers_ahead() > 0;
    let long = if is_long { args.length("the length of the arms")? } else { ARM };
    if !(0.0..=10.0).contains(&long) {
        return Err(line.error(3, "the length of the arms in millimetres, 0 to 10000"));
    }
    let right_of_way = if args.left() > 0 { choice(line, args, &RIGHTS)? } else { RightOfWay::Priority };
    Ok(Crossing { angle, arms: arms.map(|arm| arm * long), right_of_way })
}
