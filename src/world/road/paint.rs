//! Markings of a course as convex quadrangles.

use super::course::{
    Centre, Crossing, Line, RightOfWay, RoadCourse, RoadMark, RoadMarkKind, RoadSide, Traffic,
};
#[cfg(test)]
use crate::geometry::cross;
use crate::geometry::{Point, Pose, Vector, math};

/// Length of a dash of the centre line and of the gap behind it, by the rules (m).
const DASH: f64 = 0.20;
/// Length of a dash of the edge line where a side road joins, and of the gap behind it, by the rules (m).
const SIDE_DASH: (f64, f64) = (0.10, 0.05);
/// Gap between the lines of a double centre line, by the rules (m).
const DOUBLE_GAP: f64 = 0.02;
/// Width of stop lines, give-way lines and stripes, by the rules (m).
const BROAD: f64 = 0.038;
/// Length of the dashes of give-way lines, and of the gaps between them, by the rules (m).
const GIVE_WAY: (f64, f64) = (0.08, 0.06);
/// Length of the stripes of a crosswalk, and gap between them, by the rules (m).
const ZEBRA: (f64, f64) = (0.40, 0.04);
/// Length of the chequered start line along the road (m): two rows of squares.
const START: f64 = 0.05;
/// Distance between the stripes of a barred area (m), and their angle to the road (rad).
const BARRED: (f64, f64) = (0.15, 0.471);
/// Length and width of an arrow, by the rules (m).
const ARROW: (f64, f64) = (0.50, 0.07);
/// Height and width of a number, by the rules (m).
const NUMBER: (f64, f64) = (0.40, 0.06);
/// Depths of parallel and of perpendicular parking spots, by the rules (m).
const PARKING: (f64, f64) = (0.30, 0.50);
/// Width of a perpendicular parking spot, by the rules (m).
const SPOT: f64 = 0.35;
/// Length of a straight piece of a curved line (m).
const PIECE: f64 = 0.03;

/// All markings.
pub(super) fn quads(course: &RoadCourse) -> Vec<[Point; 4]> {
    let mut painter = Painter { course, quads: Vec::new() };
    painter.edges();
    painter.centre();
    for mark in &course.marks {
        painter.mark(mark);
    }
    painter.quads
}

struct Painter<'c> {
    course: &'c RoadCourse,
    quads: Vec<[Point; 4]>,
}

/// An interval along a road (m).
type Part = (f64, f64);

impl Painter<'_> {
    fn size(&self, metres: f64) -> f64 {
        metres * self.course.size
    }

    fn edges(&mut self) {
        let edge = self.course.edge();
        for (line, left) in [(Line::Left, edge), (Line::Right, -edge)] {
            let side = if left > 0.0 { RoadSide::Left } else { RoadSide::Right };
            let mut missing = self.missing(line);
            let mut side_roads = Vec::new();
            for mark in &self.course.marks {
                if let RoadMarkKind::SideRoad(at, long) = mark.kind
                    && at == side
                {
                    side_roads.push((mark.at, mark.at + long));
                }
            }
            missing.extend(&side_roads);
            for part in self.present(missing) {
                self.ribbon(part, left, self.course.line_width);
            }
            let (dash, gap) = SIDE_DASH;
            for part in side_roads {
                self.dashes(part, left, (self.size(dash), self.size(gap)));
            }
        }
    }

    fn centre(&mut self) {
        let course = self.course;
        let mut starts = course.centre.clone();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Dashes go on where their kind does: two of them that meet would be one of up to twice the length.
        starts.dedup_by(|next, before| next.1 == before.1);
        let missing = self.missing(Line::Centre);
        let present = self.present(missing);
        let beside = 0.5 * (self.size(DOUBLE_GAP) + course.line_width);
        let dash = (self.size(DASH), self.size(DASH));
        let length = course.line.length();
        let first = starts.first().map_or(length, |start| start.0);
        let mut kinds = vec![(0.0, first, course.centre_at(-1.0))];
        for (i, &(from, kind)) in starts.iter().enumerate() {
            kinds.push((from, starts.get(i + 1).map_or(length, |next| next.0), kind));
        }
        for (from, to, kind) in kinds {
            for &(start, end) in &present {
                let part = (start.max(from), end.min(to));
                if part.0 >= part.1 {
                    continue;
                }
                let (solid, dashed): (&[f64], &[f64]) = match kind {
                    Centre::Dashed => (&[], &[0.0]),
                    Centre::Double => (&[1.0, -1.0], &[]),
                    Centre::SolidLeft => (&[1.0], &[-1.0]),
                    Centre::SolidRight => (&[-1.0], &[1.0]),
                };
                for side in solid {
                    self.ribbon(part, side * beside, course.line_width);
                }
                for side in dashed {
                    self.dashes(part, side * beside, dash);
                }
            }
        }
    }

    /// Intervals where a line is missing: at its gaps and at crossings.
    fn missing(&self, line: Line) -> Vec<Part> {
        let mut missing = Vec::new();
        for mark in &self.course.marks {
            match mark.kind {
                RoadMarkKind::Gap(of, long) if of == line => missing.push((mark.at, mark.at + long)),
                RoadMarkKind::Crossing(crossing) if self.opens(mark.at, &crossing, line) => {
                    let reach = self.course.crossing_reach(&crossing);
                    missing.push((mark.at - reach, mark.at + reach));
                }
                _ => {}
            }
        }
        missing
    }

    /// Whether a line is interrupted at a crossing.
    fn opens(&self, at: f64, crossing: &Crossing, line: Line) -> bool {
        let [left, right] = crossing.arms.map(|arm| arm > 0.0);
        let shared = super::crossings::shared_crossings(self.course);
        let is_shared = shared.iter().any(|&(a, b)| a == at || b == at);
        match line {
            _ if is_shared => true,
            Line::Left => left,
            Line::Right => right,
            Line::Centre => left || right,
        }
    }

    /// Complement of the missing intervals.
    fn present(&self, missing: Vec<Part>) -> Vec<Part> {
        let length = self.course.line.length();
        // Intervals beyond the end continue at the beginning.
        let mut missing: Vec<Part> = missing
            .into_iter()
            .flat_map(|(from, to)| [(from, to), (from - length, to - length), (from + length, to + length)])
            .collect();
        missing.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut present = Vec::new();
        let mut from = 0.0;
        for (start, end) in missing {
            if start > from && from < length {
                present.push((from, start.min(length)));
            }
            from = end.max(from);
        }
        if from < length {
            present.push((from, length));
        }
        present
    }

    /// A line of a width at a distance to the left of the road's centre line (m).
    fn ribbon(&mut self, (from, to): Part, left: f64, width: f64) {
        let count = ((to - from) / self.size(PIECE)).ceil().max(1.0) as usize;
        let at = |i: usize| from + (to - from) * i as f64 / count as f64;
        let (inner, outer) = (left - 0.5 * width, left + 0.5 * width);
        let line = &self.course.line;
        let mut before = (line.beside(from, inner), line.beside(from, outer));
        for i in 1..=count {
            // A place at the very end would be that at the beginning, with a different rounding.
            let here = (line.beside(at(i), inner), line.beside(at(i), outer));
            self.quads.push([before.0, here.0, here.1, before.1]);
            before = here;
        }
    }

    fn dashes(&mut self, (from, to): Part, left: f64, (dash, gap): (f64, f64)) {
        let count = ((to - from) / (dash + gap)).ceil() as usize;
        for i in 0..count {
            let start = from + i as f64 * (dash + gap);
            self.ribbon((start, (start + dash).min(to)), left, self.course.line_width);
        }
    }

    /// A rectangle in a frame.
    fn block(&mut self, frame: &Pose, x: Part, y: Part) {
        let corner = |x, y| frame.to_world(Point::new(x, y));
        self.quads.push([corner(x.0, y.0), corner(x.1, y.0), corner(x.1, y.1), corner(x.0, y.1)]);
    }

    /// A line from one point to another in a frame.
    fn stroke(&mut self, frame: &Pose, from: Point, to: Point, width: f64) {
        let along = (to - from) / (to - from).norm().max(1e-9);
        let aside = Vector::new(-along.y, along.x) * (0.5 * width);
        self.quads.push([from - aside, to - aside, to + aside, from + aside].map(|p| frame.to_world(p)));
    }

    fn mark(&mut self, mark: &RoadMark) {
        let frame = self.course.line.at(mark.at).pose;
        match mark.kind {
            RoadMarkKind::Gap(..) | RoadMarkKind::SideRoad(..) => {}
            RoadMarkKind::Start => self.chequers(&frame),
            RoadMarkKind::StopLine => self.across(&frame, self.own_lane(), None),
            RoadMarkKind::GiveWayLine => self.across(&frame, self.own_lane(), Some(GIVE_WAY)),
            RoadMarkKind::Crossing(crossing) => self.crossing(&frame, &crossing),
            RoadMarkKind::Zebra => self.zebra(&frame),
            RoadMarkKind::Barred(side, long, wide) => self.barred(mark.at, side, long, wide),
            RoadMarkKind::Arrow(to) => self.arrow(&frame, to),
            RoadMarkKind::Speed(value, struck) => self.speed(&frame, value, struck),
            RoadMarkKind::Parking(side, long) => self.parking(mark.at, side, long),
            RoadMarkKind::Artefact(left, long, wide) => {
                let (long, wide) = (0.5 * long, 0.5 * wide);
                self.block(&frame, (-long, long), (left - wide, left + wide));
            }
        }
    }

    /// From the inner edge of the centre marking to that of the own edge line.
    fn own_lane(&self) -> Part {
        let (inner, outer) =
            (0.5 * self.course.line_width, self.course.edge() - 0.5 * self.course.line_width);
        match self.course.traffic {
            Traffic::Right => (-outer, -inner),
            Traffic::Left => (inner, outer),
        }
    }

    /// A broad line across a lane, which ends at a frame's origin.
    fn across(&mut self, frame: &Pose, lane: Part, dashes: Option<(f64, f64)>) {
        let along = (-self.size(BROAD), 0.0);
        let Some((dash, gap)) = dashes.map(|(dash, gap)| (self.size(dash), self.size(gap))) else {
            return self.block(frame, along, lane);
        };
        let mut y = lane.0;
        while y < lane.1 {
            self.block(frame, along, (y, (y + dash).min(lane.1)));
            y += dash + gap;
        }
    }

    fn chequers(&mut self, frame: &Pose) {
        let (edge, square) = (self.course.edge(), 0.5 * self.size(START));
        let count = (2.0 * edge / square) as usize;
        for i in 0..count {
            let y = -edge + square * i as f64;
            let x = if i % 2 == 0 { 0.0 } else { square };
            self.block(frame, (x, x + square), (y, y + square));
        }
    }

    fn zebra(&mut self, frame: &Pose) {
        let (long, gap) = (self.size(ZEBRA.0), self.size(ZEBRA.1));
        let (edge, stripe) = (self.course.edge() - self.course.line_width, self.size(BROAD));
        let mut y = -edge + gap;
        while y + stripe < edge {
            self.block(frame, (0.0, long), (y, y + stripe));
            y += stripe + gap;
        }
    }

    /// The arms of a crossing and the lines of those who wait.
    fn crossing(&mut self, frame: &Pose, crossing: &Crossing) {
        let own = self.course.crossing_reach(crossing);
        let own_waits = match crossing.right_of_way {
            RightOfWay::Priority => None,
            RightOfWay::Stop => Some(None),
            RightOfWay::GiveWay | RightOfWay::FromTheRight => Some(Some(GIVE_WAY)),
        };
        let arm_waits = match crossing.right_of_way {
            RightOfWay::Priority => Some(None),
            RightOfWay::Stop | RightOfWay::GiveWay => None,
            RightOfWay::FromTheRight => Some(Some(GIVE_WAY)),
        };
        if let Some(dashes) = own_waits {
            for turn in [0.0, std::f64::consts::PI] {
                let towards = Pose::new(frame.x, frame.y, frame.heading + turn);
                let place = towards.to_world(Point::new(-own, 0.0));
                self.across(&Pose::new(place.x, place.y, towards.heading), self.own_lane(), dashes);
            }
        }
        for (side, arm) in [1.0, -1.0].into_iter().zip(crossing.arms) {
            if arm > 0.0 {
                let turn = if side > 0.0 { crossing.angle } else { crossing.angle + std::f64::consts::PI };
                let out = Pose::new(frame.x, frame.y, frame.heading + turn);
                self.arm(&out, own, arm, arm_waits);
            }
        }
    }

    /// A straight road away from a crossing, along a frame.
    #[allow(clippy::option_option, reason = "no line, a solid one, or one of dashes")]
    fn arm(&mut self, out: &Pose, from: f64, to: f64, waits: Option<Option<(f64, f64)>>) {
        let (edge, half) = (self.course.edge(), 0.5 * self.course.line_width);
        for y in [edge, -edge] {
            self.block(out, (from, to), (y - half, y + half));
        }
        let dash = self.size(DASH);
        let mut x = from;
        while x < to {
            self.block(out, (x, (x + dash).min(to)), (-half, half));
            x += 2.0 * dash;
        }
        if let Some(dashes) = waits {
            let place = out.to_world(Point::new(from, 0.0));
            let towards = Pose::new(place.x, place.y, out.heading + std::f64::consts::PI);
            self.across(&towards, self.own_lane(), dashes);
        }
    }

    /// A trapezoid at the edge of the road, filled with slanted stripes.
    fn barred(&mut self, at: f64, side: RoadSide, long: f64, wide: f64) {
        let frame = self.course.line.at(at).pose;
        let (sign, edge) = (side.sign(), self.course.edge());
        let slope = wide / math::tan(std::f64::consts::FRAC_PI_3);
        let point = |x: f64, depth: f64| Point::new(x, sign * (edge - depth));
        let corners = [point(0.0, 0.0), point(slope, wide), point(long - slope, wide), point(long, 0.0)];
        let width = self.course.line_width;
        for pair in corners.windows(2) {
            self.stroke(&frame, pair[0], pair[1], width);
        }
        let (gap, angle) = (self.size(BARRED.0), BARRED.1);
        let lean = wide / math::tan(angle);
        let mut x = 0.5 * gap;
        while x < long {
            // From the edge to the inner side, or to the slope at the end.
            let depth = if x + lean <= long - slope { wide } else { (long - x) / (lean + slope) * wide };
            let start = if x < 0.0 { 0.0 } else { x };
            let end = point(start + lean * depth / wide, depth.max(0.0));
            self.stroke(&frame, point(start, 0.0), end, self.size(BROAD));
            x += gap;
        }
    }

    fn arrow(&mut self, frame: &Pose, to: RoadSide) {
        let (long, wide) = (self.size(ARROW.0), self.size(ARROW.1));
        let middle = self.course.lane_middle();
        let point = |x: f64, y: f64| Point::new(x, middle + y);
        let (bend, reach) = (0.7 * long, to.sign() * 1.6 * wide);
        self.stroke(frame, point(0.0, 0.0), point(bend, 0.0), 0.5 * wide);
        self.stroke(frame, point(bend - 0.25 * wide, 0.0), point(bend - 0.25 * wide, reach), 0.5 * wide);
        let head = [
            point(bend - 0.25 * wide - wide, reach),
            point(bend - 0.25 * wide, reach + to.sign() * wide),
            point(bend - 0.25 * wide + wide, reach),
            point(bend - 0.25 * wide, reach),
        ];
        self.quads.push(head.map(|corner| frame.to_world(corner)));
    }

    fn speed(&mut self, frame: &Pose, value: u8, struck: bool) {
        let (high, wide) = (self.size(NUMBER.0), self.size(NUMBER.1));
        let digits = if value < 10 { vec![value] } else { vec![value / 10 % 10, value % 10] };
        let pitch = 1.5 * wide;
        for (i, &digit) in digits.iter().enumerate() {
            let right = (i as f64 - 0.5 * (digits.len() as f64 - 1.0)) * pitch;
            self.digit(frame, self.course.lane_middle() - right, digit, (high, wide));
        }
        if struck {
            let middle = self.course.lane_middle();
            let (long, aside) = (self.size(0.50), self.size(0.10));
            let from = Point::new(-0.5 * (long - high), middle + aside);
            let to = Point::new(from.x + long, middle - aside);
            self.stroke(frame, from, to, self.course.line_width);
        }
    }

    /// A digit of seven strokes, upright for an approaching driver.
    fn digit(&mut self, frame: &Pose, middle: f64, digit: u8, (high, wide): (f64, f64)) {
        /// Top, upper right, lower right, bottom, lower left, upper left, middle: from the lowest bit
        /// upwards.
        const STROKES: [u8; 10] = [0x3f, 0x06, 0x5b, 0x4f, 0x66, 0x6d, 0x7d, 0x07, 0x7f, 0x6f];
        let (l, r) = (middle + 0.5 * wide, middle - 0.5 * wide);
        let ends: [[(f64, f64); 2]; 7] = [
            [(high, l), (high, r)],
            [(high, r), (0.5 * high, r)],
            [(0.5 * high, r), (0.0, r)],
            [(0.0, l), (0.0, r)],
            [(0.5 * high, l), (0.0, l)],
            [(high, l), (0.5 * high, l)],
            [(0.5 * high, l), (0.5 * high, r)],
        ];
        let lit = STROKES[usize::from(digit % 10)];
        for (_, [a, b]) in ends.iter().enumerate().filter(|(bit, _)| lit >> bit & 1 == 1) {
            self.stroke(frame, Point::new(a.0, a.1), Point::new(b.0, b.1), 0.25 * wide);
        }
    }

    /// Parking spots beside an edge: a long one parallel to the road on the right, short ones across on the
    /// left.
    fn parking(&mut self, at: f64, side: RoadSide, long: f64) {
        let (sign, edge) = (side.sign(), self.course.edge());
        let depth = self.size(if side == RoadSide::Right { PARKING.0 } else { PARKING.1 });
        let far = edge + depth;
        self.ribbon((at, at + long), sign * far, self.course.line_width);
        let width = self.course.line_width;
        let spots =
            if side == RoadSide::Right { 1 } else { (long / self.size(SPOT)).floor().max(1.0) as usize };
        for i in 0..=spots {
            let along = at + long * i as f64 / spots as f64;
            let frame = self.course.line.at(along).pose;
            // The ends of the area are slanted outwards.
            let slope = match i {
                0 => -depth,
                _ if i == spots => depth,
                _ => 0.0,
            };
            let (inner, outer) = (Point::new(slope, sign * edge), Point::new(0.0, sign * far));
            self.stroke(&frame, inner, outer, width);
        }
    }
}

/// Whether four corners turn the same way, as the raster requires.
#[cfg(test)]
pub(super) fn is_convex(corners: &[Point; 4]) -> bool {
    let turns: [f64; 4] = std::array::from_fn(|i| {
        let [a, b, c] = [0, 1, 2].map(|k| corners[(i + k) % 4]);
        cross(b - a, c - b)
    });
    turns.iter().all(|turn| *turn >= -1e-9) || turns.iter().all(|turn| *turn <= 1e-9)
}
