use super::alignment::Alignment;
use crate::geometry::{Aabb, Point, Pose, Vector, angle_difference, direction, math};
use crate::parameter::debug_as_sentence;

/// A closed road of two lanes, one in each direction, with its markings. Cars drive along its line.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// On which side of the road cars drive.
    pub traffic: Traffic,
    /// Metres of the course for each metre of the rules: 0.5 at a scale of 2:1.
    pub size: f64,
    /// The middle of the road.
    pub line: Alignment,
    /// Metres from the inner edge of one marking of a lane to that of the other.
    pub lane_width: f64,
    /// Metres across a marking.
    pub line_width: f64,
    /// Where kinds of the centre line begin, by metres along the line. Before the first one it is as at the end.
    pub centre: Vec<(f64, Centre)>,
    /// What else is painted on the road, and what is not.
    pub marks: Vec<Mark>,
}

/// On which side of a road cars drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Traffic {
    /// As in most countries.
    #[default]
    Right,
    /// As in Australia, where the book's robots drive.
    Left,
}

/// A line of the road, as seen by who drives along it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Line {
    /// The left edge.
    Left,
    /// The line between the lanes.
    Centre,
    /// The right edge.
    Right,
}

/// A kind of the line between the lanes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Centre {
    /// Dashes of 200 mm with gaps of 200 mm: passing is allowed.
    #[default]
    Dashed,
    /// Two solid lines: no passing.
    Double,
    /// A solid line to the left of a dashed one.
    SolidLeft,
    /// A solid line to the right of a dashed one.
    SolidRight,
}

/// To the left or to the right.
///
/// ```
/// use roverlab::world::road::Direction;
/// assert_eq!([Direction::Left.sign(), Direction::Right.sign()], [1.0, -1.0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Left.
    Left,
    /// Right.
    Right,
}

impl Direction {
    /// 1 to the left, -1 to the right.
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

/// Something that is painted on the road, or missing from it, at a place along its line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Metres along the line where it begins; the middle of a crossing.
    pub at: f64,
    /// What it is.
    pub kind: MarkKind,
}

/// What a [`Mark`] is. Lengths are metres along the road, of the course itself; sizes that are not stated are those of the
/// rules.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum MarkKind {
    /// The chequered line across the road at which laps start.
    Start,
    /// A line that is missing for a length.
    Gap(Line, f64),
    /// The edge at a side road: short dashes for a length.
    SideRoad(Direction, f64),
    /// Another road that crosses this one, or this one itself on another part of its way.
    Crossing(Crossing),
    /// A line across the own lane before which cars stop; it ends here.
    StopLine,
    /// The same as dashes, for cars that give way.
    GiveWayLine,
    /// A crosswalk: stripes of 400 mm along the road across both lanes.
    Zebra,
    /// An area from an edge of the road that cars may not enter: its length along the edge, and its width.
    Barred(Direction, f64, f64),
    /// An arrow on the own lane.
    Arrow(Direction),
    /// The number of a speed limit on the own lane, at most two digits, or the same struck out.
    Speed(u8, bool),
    /// A parking area beside an edge: parallel to the road on the right, perpendicular on the left, of a length.
    Parking(Direction, f64),
    /// A patch beside the road that is no marking: metres to the left of the line, its length and its width.
    Artefact(f64, f64, f64),
}

impl MarkKind {
    /// The same with every length times a factor.
    fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Gap(line, long) => Self::Gap(line, long * factor),
            Self::SideRoad(side, long) => Self::SideRoad(side, long * factor),
            Self::Crossing(crossing) => {
                Self::Crossing(Crossing { arms: crossing.arms.map(|arm| arm * factor), ..crossing })
            }
            Self::Barred(side, long, wide) => Self::Barred(side, long * factor, wide * factor),
            Self::Parking(side, long) => Self::Parking(side, long * factor),
            Self::Artefact(left, long, wide) => Self::Artefact(left * factor, long * factor, wide * factor),
            other => other,
        }
    }
}

/// How another road crosses this one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Radians from this road's direction to that of the other road, to the left.
    pub angle: f64,
    /// Metres of the arms to the left and to the right that belong to no other part of the course; 0 without one.
    pub arms: [f64; 2],
    /// Who has to wait.
    pub right_of_way: RightOfWay,
}

/// Who has to wait at a crossing, by the lines on its entries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum RightOfWay {
    /// The arms have stop lines.
    #[default]
    Priority,
    /// This road has stop lines.
    Stop,
    /// This road has give-way lines.
    GiveWay,
    /// Every entry has a give-way line: who comes from the right goes first.
    FromTheRight,
}

/// Where a car is on its lane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LanePose {
    /// Metres along the line.
    pub along: f64,
    /// Metres to the left of the lane's middle.
    pub offset: f64,
    /// Radians to the left of the lane's direction.
    pub heading: f64,
    /// The curvature of the lane's middle there, in 1/m; positive to the left.
    pub curvature: f64,
}

/// Why something is no course.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CourseError {
    /// There is no road, or none that memory would hold.
    #[error("a road of {length} m; expected one of {least} to {most} m")]
    Length {
        /// Metres.
        length: f64,
        /// The shortest.
        least: f64,
        /// The longest.
        most: f64,
    },
    /// The end is not where the road begins.
    #[error(
        "the road ends {distance:.3} m and {degrees:.2} degrees off its beginning; expected less than {most} m and 3 degrees"
    )]
    Open {
        /// Metres from its end to its beginning.
        distance: f64,
        /// Degrees between their directions.
        degrees: f64,
        /// Metres that are closed by themselves.
        most: f64,
    },
    /// A bend is too tight.
    #[error("at {along:.3} m the road's middle has a radius of {radius:.3} m; expected at least {least} m")]
    TooTight {
        /// Metres along the line.
        along: f64,
        /// The radius there.
        radius: f64,
        /// The least one.
        least: f64,
    },
    /// A lane is narrower or wider than the rules say.
    #[error("lanes of {width} m; expected {least} to {most} m")]
    LaneWidth {
        /// Metres.
        width: f64,
        /// The narrowest.
        least: f64,
        /// The widest.
        most: f64,
    },
    /// A lane is too narrow for the car.
    #[error("lanes of {lane} m and a car of {car} m; expected a car that fits in its lane")]
    CarTooWide {
        /// Metres across the lane.
        lane: f64,
        /// Metres across the car.
        car: f64,
    },
    /// The road crosses itself where no crossing is, or parts of it are too near to each other.
    #[error(
        "the road at {first:.2} m and at {second:.2} m crosses itself or comes too near; expected a crossing at both, or {apart} m between their edges"
    )]
    CrossesItself {
        /// Metres along the line.
        first: f64,
        /// The other place.
        second: f64,
        /// Metres between edges that are enough.
        apart: f64,
    },
    /// A mark's place or size makes no sense.
    #[error("{name} of {value} m; expected {expected}")]
    Mark {
        /// What is wrong.
        name: &'static str,
        /// What it is.
        value: f64,
        /// What it should be.
        expected: String,
    },
    /// A picture of the course would be too large.
    #[error("a floor of {width:.1} m x {height:.1} m in pixels of {pixel} m; expected at most {most} pixels")]
    TooLarge {
        /// Metres.
        width: f64,
        /// Metres.
        height: f64,
        /// Metres.
        pixel: f64,
        /// Pixels.
        most: usize,
    },
}

debug_as_sentence!(CourseError);

/// Metres from outer edges of markings to the floor's edge.
const MARGIN: f64 = 0.5;

impl Course {
    /// A road with dashes in its middle and nothing else on it. Fails as [`check`](Self::check) does.
    pub fn new(line: Alignment) -> Result<Self, CourseError> {
        let course = Self::new_unchecked(line);
        course.check().map(|()| course)
    }

    pub(super) fn new_unchecked(line: Alignment) -> Self {
        Self {
            traffic: Traffic::Right,
            size: 1.0,
            line,
            lane_width: 0.4,
            line_width: 0.02,
            centre: vec![(0.0, Centre::Dashed)],
            marks: Vec::new(),
        }
    }

    /// The same course in another size: a factor of every length.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let marks = self.marks.into_iter();
        Self {
            size: self.size * factor,
            line: self.line.scaled(factor),
            lane_width: self.lane_width * factor,
            line_width: self.line_width * factor,
            centre: self.centre.into_iter().map(|(at, kind)| (at * factor, kind)).collect(),
            marks: marks.map(|mark| Mark { at: mark.at * factor, kind: mark.kind.scaled(factor) }).collect(),
            ..self
        }
    }

    /// Fails if a car of a width in metres does not fit in the lanes.
    pub fn check_car(&self, width: f64) -> Result<(), CourseError> {
        if width < self.lane_width {
            return Ok(());
        }
        Err(CourseError::CarTooWide { lane: self.lane_width, car: width })
    }

    /// Metres from the road's middle to the middle of its edge lines.
    pub fn edge(&self) -> f64 {
        self.lane_width + self.line_width
    }

    /// Metres to the left of the road's middle to the middle of the own lane.
    pub fn lane_middle(&self) -> f64 {
        let aside = 0.5 * self.edge();
        match self.traffic {
            Traffic::Right => -aside,
            Traffic::Left => aside,
        }
    }

    /// The kind of the line between the lanes at a place.
    pub fn centre_at(&self, along: f64) -> Centre {
        let before = self.centre.iter().rev().find(|(from, _)| *from <= along);
        before.or(self.centre.last()).map_or(Centre::Dashed, |(_, kind)| *kind)
    }

    /// The middle of the own lane at the beginning of the line.
    pub fn start(&self) -> Pose {
        self.pose(0.0, 0.0)
    }

    /// The pose some metres along the line and some to the left of the own lane's middle, along the road.
    pub fn pose(&self, along: f64, offset: f64) -> Pose {
        let pose = self.line.at(along).pose;
        let place = pose.to_world(Point::new(0.0, self.lane_middle() + offset));
        Pose::new(place.x, place.y, pose.heading)
    }

    /// Where a pose is on the own lane. On a road that crosses itself, `near` says about where: metres along the line.
    pub fn locate(&self, pose: &Pose, near: Option<f64>) -> LanePose {
        let window = 1.0;
        let (along, left) = self.line.locate(pose.position(), near.map(|near| (near, window)));
        let station = self.line.at(along);
        let middle = self.lane_middle();
        LanePose {
            along,
            offset: left - middle,
            heading: angle_difference(pose.heading, station.pose.heading),
            curvature: station.curvature / (1.0 - station.curvature * middle),
        }
    }

    /// The crossings and their places.
    pub fn crossings(&self) -> impl Iterator<Item = (f64, Crossing)> {
        self.marks.iter().filter_map(|mark| match mark.kind {
            MarkKind::Crossing(crossing) => Some((mark.at, crossing)),
            _ => None,
        })
    }

    /// Metres along the road from the middle of a crossing to where the edge lines go on.
    pub fn crossing_reach(&self, crossing: &Crossing) -> f64 {
        (self.edge() + 0.5 * self.line_width) / math::sin(crossing.angle).abs().max(0.5)
    }

    /// The floor around the road.
    pub fn floor(&self) -> Aabb {
        let reach = self.edge() + (MARGIN + 0.5) * self.size;
        let around = |station: &super::Station| station.pose.position();
        let road = Aabb::around(self.line.stations().iter().map(around));
        let mut floor = road.unwrap_or(Aabb::new(Point::origin(), Point::origin())).inflated(reach);
        for (at, crossing) in self.crossings() {
            let station = self.line.at(at).pose;
            let arms = [crossing.arms[0], -crossing.arms[1]].map(|arm| {
                let out = arm + self.edge().copysign(arm) + MARGIN.copysign(arm) * self.size;
                station.position() + direction(station.heading + crossing.angle) * out
            });
            let margin = Vector::new(self.edge(), self.edge());
            for arm in arms {
                floor = floor.union(&Aabb::new(arm - margin, arm + margin));
            }
        }
        floor
    }
}
