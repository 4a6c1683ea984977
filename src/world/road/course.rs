use super::alignment::Alignment;
use crate::geometry::{Aabb, Point, Pose, Vector, angle_difference, direction, math};
use crate::parameter::{ParameterError, debug_as_sentence};

/// A closed two-lane road, one lane per direction, with its markings. Cars drive in the direction of its
/// line.
#[derive(Debug, Clone, PartialEq)]
pub struct RoadCourse {
    /// Side of the road on which cars drive.
    pub traffic: Traffic,
    /// Metres of the course per metre of the rules: 0.5 at a scale of 2:1.
    pub size: f64,
    /// Centre line of the road.
    pub line: Alignment,
    /// Distance between the inner edges of a lane's markings (m).
    pub lane_width: f64,
    /// Width of a marking (m).
    pub line_width: f64,
    /// Start of each kind of centre marking along the line (m). Before the first one, the last one applies.
    pub centre: Vec<(f64, Centre)>,
    /// Other markings, and gaps in markings.
    pub marks: Vec<RoadMark>,
}

/// Side of a road on which cars drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Traffic {
    /// As in most countries.
    #[default]
    Right,
    /// As in Australia, home of the book's robots.
    Left,
}

/// A line of the road, as seen in driving direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Line {
    /// The left edge.
    Left,
    /// The line between the lanes.
    Centre,
    /// The right edge.
    Right,
}

/// A kind of marking between the lanes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Centre {
    /// Dashes of 200 mm with gaps of 200 mm: overtaking is allowed.
    #[default]
    Dashed,
    /// Two solid lines: no overtaking.
    Double,
    /// A solid line to the left of a dashed one.
    SolidLeft,
    /// A solid line to the right of a dashed one.
    SolidRight,
}

/// To the left or to the right.
///
/// ```
/// use roverlab::world::road::RoadSide;
/// assert_eq!([RoadSide::Left.sign(), RoadSide::Right.sign()], [1.0, -1.0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RoadSide {
    /// Left.
    Left,
    /// Right.
    Right,
}

impl RoadSide {
    /// 1 to the left, -1 to the right.
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

/// A marking on the road, or a gap in one, at a place along its line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadMark {
    /// Its start along the line (m); for a crossing, its middle.
    pub at: f64,
    /// Its kind.
    pub kind: RoadMarkKind,
}

/// Kinds of a [`RoadMark`]. Lengths are metres along the road at the scale of the course; unstated sizes are
/// those of the rules.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum RoadMarkKind {
    /// The chequered line across the road where laps start.
    Start,
    /// A gap of a length in a line.
    Gap(Line, f64),
    /// The edge at a side road: short dashes over a length.
    SideRoad(RoadSide, f64),
    /// A crossing with another road, or with another part of this one.
    Crossing(Crossing),
    /// A stop line across the own lane, which ends here.
    StopLine,
    /// The same with dashes, for cars that give way.
    GiveWayLine,
    /// A crosswalk: stripes of 400 mm along the road across both lanes.
    Zebra,
    /// A closed area at an edge of the road: its length along the edge and its width.
    Barred(RoadSide, f64, f64),
    /// An arrow on the own lane.
    Arrow(RoadSide),
    /// The number of a speed limit on the own lane, at most two digits; `true` strikes it out.
    Speed(u8, bool),
    /// A parking area of a length beside an edge: parallel to the road on the right, perpendicular on the
    /// left.
    Parking(RoadSide, f64),
    /// A patch beside the road that is not a marking: distance to the left of the line, length and width (m).
    Artefact(f64, f64, f64),
}

impl RoadMarkKind {
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

/// A crossing of this road with another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Angle from this road's direction to that of the other road, positive to the left (rad).
    pub angle: f64,
    /// Lengths of the left and right arms that are not part of the course (m); 0 without an arm.
    pub arms: [f64; 2],
    /// Right of way.
    pub right_of_way: RightOfWay,
}

/// Right of way at a crossing, by the lines at its entries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum RightOfWay {
    /// The arms have stop lines.
    #[default]
    Priority,
    /// This road has stop lines.
    Stop,
    /// This road has give-way lines.
    GiveWay,
    /// Every entry has a give-way line: traffic from the right goes first.
    FromTheRight,
}

/// Position of a car in its lane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LanePose {
    /// Distance along the line (m).
    pub along: f64,
    /// Distance to the left of the lane's centre (m).
    pub offset: f64,
    /// Heading relative to the lane's direction, positive to the left (rad).
    pub heading: f64,
    /// Curvature of the lane's centre line there, positive to the left (1/m).
    pub curvature: f64,
}

/// Reason why a course is invalid.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CourseError {
    /// The road has zero length, or is too long for the memory.
    #[error("a road of {length} m; expected one of {least} to {most} m")]
    Length {
        /// Its length (m).
        length: f64,
        /// Shortest length (m).
        least: f64,
        /// Longest length (m).
        most: f64,
    },
    /// The road's end does not meet its beginning.
    #[error(
        "the road ends {distance:.3} m and {degrees:.2} degrees off its beginning; expected less than {most} m and 3 degrees"
    )]
    Open {
        /// Distance between end and beginning (m).
        distance: f64,
        /// Angle between their directions (degrees).
        degrees: f64,
        /// Largest distance that is closed automatically (m).
        most: f64,
    },
    /// A bend is too tight.
    #[error("at {along:.3} m the road's middle has a radius of {radius:.3} m; expected at least {least} m")]
    TooTight {
        /// Distance along the line (m).
        along: f64,
        /// Radius there (m).
        radius: f64,
        /// Smallest radius (m).
        least: f64,
    },
    /// The lane width violates the rules.
    #[error("lanes of {width} m; expected {least} to {most} m")]
    LaneWidth {
        /// Width (m).
        width: f64,
        /// Smallest width (m).
        least: f64,
        /// Largest width (m).
        most: f64,
    },
    /// A lane is too narrow for the car.
    #[error("lanes of {lane} m and a car of {car} m; expected a car that fits in its lane")]
    CarTooWide {
        /// Width of the lane (m).
        lane: f64,
        /// Width of the car (m).
        car: f64,
    },
    /// The road crosses itself without a crossing, or parts of it are too close.
    #[error(
        "the road at {first:.2} m and at {second:.2} m crosses itself or comes too near; expected a crossing at both, or {apart} m between their edges"
    )]
    CrossesItself {
        /// Distance along the line (m).
        first: f64,
        /// The other place (m).
        second: f64,
        /// Required distance between edges (m).
        apart: f64,
    },
    /// The place or size of a mark is invalid.
    #[error("{name} of {value} m; expected {expected}")]
    RoadMark {
        /// Name of the invalid value.
        name: &'static str,
        /// The value.
        value: f64,
        /// Expected range.
        expected: String,
    },
    /// An option of [`generate`](super::generate()) is out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A picture of the course would be too large.
    #[error("a floor of {width:.1} m x {height:.1} m in pixels of {pixel} m; expected at most {most} pixels")]
    TooLarge {
        /// Width (m).
        width: f64,
        /// Height (m).
        height: f64,
        /// Pixel size (m).
        pixel: f64,
        /// Largest number of pixels.
        most: usize,
    },
}

debug_as_sentence!(CourseError);

/// Distance from the outer edges of markings to the edge of the floor (m).
const MARGIN: f64 = 0.5;

impl RoadCourse {
    /// A road with a dashed centre line and no other marks. Fails as [`check`](Self::check) does.
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

    /// The same course with every length times a factor.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let marks = self.marks.into_iter();
        Self {
            size: self.size * factor,
            line: self.line.scaled(factor),
            lane_width: self.lane_width * factor,
            line_width: self.line_width * factor,
            centre: self.centre.into_iter().map(|(at, kind)| (at * factor, kind)).collect(),
            marks: marks
                .map(|mark| RoadMark { at: mark.at * factor, kind: mark.kind.scaled(factor) })
                .collect(),
            ..self
        }
    }

    /// Fails if a car of a width (m) does not fit in the lanes.
    pub fn check_car(&self, width: f64) -> Result<(), CourseError> {
        if width < self.lane_width {
            return Ok(());
        }
        Err(CourseError::CarTooWide { lane: self.lane_width, car: width })
    }

    /// Distance from the road's centre line to the centre of its edge lines (m).
    pub fn edge(&self) -> f64 {
        self.lane_width + self.line_width
    }

    /// Distance from the road's centre line to the left, to the centre of the own lane (m).
    pub fn lane_middle(&self) -> f64 {
        let aside = 0.5 * self.edge();
        match self.traffic {
            Traffic::Right => -aside,
            Traffic::Left => aside,
        }
    }

    /// Kind of the centre marking at a place.
    pub fn centre_at(&self, along: f64) -> Centre {
        let before = self.centre.iter().rev().find(|(from, _)| *from <= along);
        before.or(self.centre.last()).map_or(Centre::Dashed, |(_, kind)| *kind)
    }

    /// Pose on the own lane's centre at the beginning of the line.
    pub fn start(&self) -> Pose {
        self.pose(0.0, 0.0)
    }

    /// Pose at a distance along the line and to the left of the own lane's centre (m), in the direction of
    /// the road.
    pub fn pose(&self, along: f64, offset: f64) -> Pose {
        let pose = self.line.at(along).pose;
        let place = pose.to_world(Point::new(0.0, self.lane_middle() + offset));
        Pose::new(place.x, place.y, pose.heading)
    }

    /// Lane position of a pose. If the road crosses itself, `near` is the approximate distance along the line
    /// (m).
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

    /// The crossings with their places.
    pub fn crossings(&self) -> impl Iterator<Item = (f64, Crossing)> {
        self.marks.iter().filter_map(|mark| match mark.kind {
            RoadMarkKind::Crossing(crossing) => Some((mark.at, crossing)),
            _ => None,
        })
    }

    /// Distance along the road from the middle of a crossing to where the edge lines resume (m).
    pub fn crossing_reach(&self, crossing: &Crossing) -> f64 {
        (self.edge() + 0.5 * self.line_width) / math::sin(crossing.angle).abs().max(0.5)
    }

    /// Bounding box of the floor.
    pub fn floor(&self) -> Aabb {
        let reach = self.edge() + (MARGIN + 0.5) * self.size;
        let around = |station: &super::AlignmentStation| station.pose.position();
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
