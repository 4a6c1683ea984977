//! Checks a course against the rules.

use super::course::{CourseError, RoadCourse, RoadMarkKind};
use super::crossings;
use crate::geometry::{math, units};

/// Shortest and longest course (m at the scale of the rules).
const LENGTHS: [f64; 2] = [6.0, 500.0];
/// Smallest and largest width of a lane (m at the scale of the rules).
pub(super) const LANES: [f64; 2] = [0.35, 0.45];
/// Accepted width of a line (m); 18 to 20 mm by the rules.
const LINES: [f64; 2] = [0.015, 0.025];
/// Smallest radius of the centre line (m).
pub(super) const RADIUS: f64 = 1.0;
/// Largest closing error that is spread over the road (m, rad).
const CLOSING: (f64, f64) = (0.10, 0.0524);
/// Largest number of marks.
const MARKS: usize = 10_000;

impl RoadCourse {
    /// Fails unless the road is closed, has no tighter bend than the rules allow, and crosses itself only at
    /// crossings, and lanes and marks follow the rules.
    pub fn check(&self) -> Result<(), CourseError> {
        let size = self.size;
        let within = |[least, most]: [f64; 2], value: f64| (least * size..=most * size).contains(&value);
        let length = self.line.length();
        if !(size > 0.0 && within(LENGTHS, length)) {
            let [least, most] = LENGTHS.map(|length| length * size);
            return Err(CourseError::Length { length, least, most });
        }
        // Tolerance for rounding to millimetres.
        if !within([LANES[0] - 1e-9, LANES[1] + 1e-9], self.lane_width) {
            let [least, most] = LANES.map(|width| width * size);
            return Err(CourseError::LaneWidth { width: self.lane_width, least, most });
        }
        if !within(LINES, self.line_width) {
            let [least, most] = LINES.map(|width| width * size);
            let expected = format!("{least} to {most} m");
            return Err(CourseError::RoadMark { name: "a line's width", value: self.line_width, expected });
        }
        self.check_closed()?;
        self.check_bends()?;
        self.check_marks()?;
        crossings::check(self)
    }

    fn check_closed(&self) -> Result<(), CourseError> {
        let gap = self.line.gap();
        let distance = math::hypot(gap.x, gap.y);
        let most = CLOSING.0 * self.size;
        if distance <= most && gap.heading.abs() <= CLOSING.1 {
            return Ok(());
        }
        Err(CourseError::Open { distance, degrees: units::to_deg(gap.heading.abs()), most })
    }

    fn check_bends(&self) -> Result<(), CourseError> {
        let mut along = 0.0;
        for element in self.line.elements() {
            let bend = element.curvature.into_iter().fold(0.0, |most: f64, bend| most.max(bend.abs()));
            let (radius, least) = (1.0 / bend, RADIUS * self.size);
            if bend > 0.0 && radius < least - 1e-6 {
                return Err(CourseError::TooTight { along, radius, least });
            }
            along += element.length;
        }
        Ok(())
    }

    fn check_marks(&self) -> Result<(), CourseError> {
        let length = self.line.length();
        let wrong = |name, value, expected: &str| {
            Err(CourseError::RoadMark { name, value, expected: expected.to_owned() })
        };
        if self.marks.len() > MARKS {
            return wrong("a number of marks", self.marks.len() as f64, "at most 10000 marks");
        }
        for mark in &self.marks {
            if !(0.0..=length).contains(&mark.at) {
                return wrong("a mark's place", mark.at, "a place on the road");
            }
            let (RoadMarkKind::Gap(_, long)
            | RoadMarkKind::SideRoad(_, long)
            | RoadMarkKind::Barred(_, long, _)
            | RoadMarkKind::Parking(_, long)
            | RoadMarkKind::Artefact(_, long, _)) = mark.kind
            else {
                continue;
            };
            if !(long > 0.0 && long <= 0.5 * length) {
                return wrong("a mark's length", long, "more than 0 and at most half the road");
            }
        }
        Ok(())
    }
}
