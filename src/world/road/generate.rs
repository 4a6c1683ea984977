use super::alignment::{Alignment, Element};
use super::check::{LANES, RADIUS};
use super::course::{
    Centre, CourseError, Crossing, Line, RightOfWay, RoadCourse, RoadMark, RoadMarkKind, RoadSide, Traffic,
};
use crate::geometry::{Point, Pose, Vector, angle_difference, cross, direction, math};
use crate::parameter::{ParameterError, require, require_not_negative};
use crate::random::Stream;

/// Options of a generated course. Lengths are those of the rules, before scaling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadCourseOptions {
    /// Side of the road on which cars drive.
    pub traffic: Traffic,
    /// Metres of the course per metre of the rules.
    pub size: f64,
    /// Smallest and largest lane width (m).
    pub lane_width: [f64; 2],
    /// Smallest radius of the road's inner edge (m), 1 by the rules. The road's middle has a radius of at
    /// least 1 m all the same.
    pub inner_radius: f64,
    /// Gaps in lines per metre of the road.
    pub gaps: f64,
    /// Longest gap (m).
    pub longest_gap: f64,
    /// Probability of a crossing or side road on a straight with enough room.
    pub crossings: f64,
    /// Probability of a crosswalk on a straight with enough room.
    pub zebras: f64,
    /// Probability of parking areas, parallel on the right and perpendicular on the left, on a straight with
    /// enough room.
    pub parking: f64,
    /// Patches beside the road per metre.
    pub artefacts: f64,
}

impl Default for RoadCourseOptions {
    /// The options of Free Drive: all kinds of lines, gaps up to 1 m, crossings and side roads, and patches
    /// beside the road.
    fn default() -> Self {
        Self {
            traffic: Traffic::Right,
            size: 1.0,
            lane_width: [0.35, 0.45],
            inner_radius: 1.0,
            gaps: 0.15,
            longest_gap: 1.0,
            crossings: 0.6,
            zebras: 0.0,
            parking: 0.0,
            artefacts: 0.3,
        }
    }
}

impl RoadCourseOptions {
    fn validate(&self) -> Result<(), ParameterError> {
        let within = |name, value, [least, most]: [f64; 2]| {
            require(name, value, (least..=most).contains(&value), format!("{least} to {most}"))
        };
        within("size", self.size, SIZES)?;
        let [narrow, wide] = self.lane_width;
        within("smallest lane width", narrow, LANES)?;
        within("largest lane width", wide, [narrow, LANES[1]])?;
        within("smallest radius of inner edges", self.inner_radius, [0.0, LARGEST])?;
        within("gaps per metre", self.gaps, [0.0, MOST_MARKS])?;
        require_not_negative("longest gap", self.longest_gap)?;
        within("probability of crossings", self.crossings, [0.0, 1.0])?;
        within("probability of zebras", self.zebras, [0.0, 1.0])?;
        within("probability of parking", self.parking, [0.0, 1.0])?;
        within("artefacts per metre", self.artefacts, [0.0, MOST_MARKS])
    }
}

/// A random course by the rules: straights with bends of clothoids and arcs, and random markings. Equal seeds
/// and options give bit-identical courses. One in three is a figure of eight.
///
/// # Errors
///
/// If an option is out of range, or no course is found by the options.
pub fn generate(seed: u64, options: &RoadCourseOptions) -> Result<RoadCourse, CourseError> {
    options.validate()?;
    let mut last = None;
    for attempt in 0..ATTEMPTS {
        let mut random = Stream::new(seed).child("course", attempt);
        match attempt_course(&mut random, options) {
            Some(Ok(course)) => return Ok(course),
            Some(Err(error)) => last = Some(error),
            None => {}
        }
    }
    Err(last.unwrap_or(CourseError::Length { length: 0.0, least: 6.0, most: 500.0 }))
}

/// Gaps and artefacts per metre at most.
const MOST_MARKS: f64 = 100.0;
/// Smallest and largest size: a lane of 4 mm and one of 40 m.
const SIZES: [f64; 2] = [0.01, 100.0];
/// Number of attempted outlines; about one in twenty has room for all bends.
const ATTEMPTS: u64 = 2000;
/// Shortest straight (m).
const SHORTEST: f64 = 0.3;
/// Smallest bend (rad).
const GENTLEST: f64 = 0.15;
/// Lengths of parking areas (m): 1.8 m along the road on the right, and four spots of 350 mm on the left.
const PARKING: (f64, f64) = (1.8, 1.4);
/// Largest radius of inner edges that can be asked for (m).
const LARGEST: f64 = 3.0;

/// Bend at a corner: its elements, and the distance from the corner to its beginning and end (m).
struct Bend {
    elements: [Element; 3],
    tangent: f64,
}

fn attempt_course(
    random: &mut Stream,
    options: &RoadCourseOptions,
) -> Option<Result<RoadCourse, CourseError>> {
    let lane = random.between(options.lane_width[0], options.lane_width[1]);
    let least = (options.inner_radius + lane + 0.03).max(RADIUS);
    let eight = random.chance(0.33);
    let corners = if eight { eight_corners(random) } else { star_corners(random) };
    let turns = turns(&corners);
    if turns.iter().any(|turn| turn.abs() < GENTLEST) {
        return None;
    }
    let bends: Vec<Bend> = turns.into_iter().map(|turn| bend(turn, least, random)).collect();
    let count = corners.len();
    let free = |i: usize| {
        let edge = (corners[(i + 1) % count] - corners[i]).norm();
        edge - bends[i].tangent - bends[(i + 1) % count].tangent
    };
    if (0..count).any(|i| free(i) < SHORTEST) {
        return None;
    }
    // The road begins in the middle of its longest straight; in a figure of eight, not on a crossing
    // straight.
    let first =
        (0..count).filter(|i| !eight || (i + 1) % 3 != 0).max_by(|&a, &b| free(a).total_cmp(&free(b)))?;
    if free(first) < 1.6 {
        return None;
    }
    let mut elements = vec![Element::straight(0.5 * free(first))];
    for i in (first + 1..=first + count).map(|i| i % count) {
        elements.extend(bends[i].elements);
        elements.push(Element::straight(if i == first { 0.5 * free(i) } else { free(i) }));
    }
    let way = corners[(first + 1) % count] - corners[first];
    let along = way / way.norm();
    let place = corners[first] + along * (bends[first].tangent + 0.5 * free(first));
    let start = Pose::new(place.x, place.y, math::atan2(along.y, along.x));
    Some(finished(random, options, lane, (start, elements)))
}

/// Corners around a centre.
fn star_corners(random: &mut Stream) -> Vec<Point> {
    let count = 4 + random.below(5);
    let clockwise = random.chance(0.5);
    let (wide, high) = (random.between(3.5, 6.5), random.between(3.0, 5.0));
    let turn = std::f64::consts::TAU / count as f64;
    let mut corners: Vec<Point> = (0..count)
        .map(|i| {
            let angle = turn * (i as f64 + random.between(-0.2, 0.2));
            let out = direction(angle) * random.between(0.55, 1.0);
            Point::new(out.x * wide, out.y * high)
        })
        .collect();
    if clockwise {
        corners.reverse();
    }
    corners
}

/// Corners of a figure of eight that crosses itself at the origin: between the third and fourth corner, and
/// between the sixth and first.
fn eight_corners(random: &mut Stream) -> Vec<Point> {
    let half = 0.5 * random.between(70.0, 90.0_f64).to_radians();
    let (up, down) = (direction(half), direction(-half));
    let mut near = || random.between(4.2, 5.5);
    let [a, c, d, f] = [up * near(), down * near(), down * -near(), up * -near()];
    let mut far = || Vector::new(random.between(6.0, 7.5), random.between(-0.5, 0.5));
    let (b, e) = (far(), -far());
    // Out along one line, back along the other, and on across the origin.
    [a, b, c, d, e, f].map(Point::from).to_vec()
}

/// Change of direction at each corner.
fn turns(corners: &[Point]) -> Vec<f64> {
    let count = corners.len();
    let heading = |i: usize| {
        let way = corners[(i + 1) % count] - corners[i];
        math::atan2(way.y, way.x)
    };
    (0..count).map(|i| angle_difference(heading(i), heading((i + count - 1) % count))).collect()
}

fn bend(turn: f64, least: f64, random: &mut Stream) -> Bend {
    let angle = turn.abs();
    let radius = least * random.between(1.0, 1.5);
    let ease = random.between(0.3, 0.9).min(0.8 * radius * angle);
    let bend = turn.signum() / radius;
    let arc = Element::arc(radius, turn.signum() * (angle - ease / radius));
    let elements = [Element::clothoid(ease, 0.0, bend), arc, Element::clothoid(ease, bend, 0.0)];
    let end = elements.iter().fold(Pose::default(), |pose, element| pose.compose(&element.end()));
    // The line through the end leads back to the corner.
    let tangent = end.x - end.y / math::tan(turn.signum() * angle);
    Bend { elements, tangent }
}

/// The course with its markings.
fn finished(
    random: &mut Stream,
    options: &RoadCourseOptions,
    lane: f64,
    (start, elements): (Pose, Vec<Element>),
) -> Result<RoadCourse, CourseError> {
    let line = Alignment::new(start, elements);
    let mut course =
        RoadCourse { lane_width: lane, traffic: options.traffic, ..RoadCourse::new_unchecked(line) };
    Marker { random, options, course: &mut course, taken: vec![(-1.2, 0.3)] }.mark();
    let course = course.scaled(options.size);
    course.check().map(|()| course)
}

/// Puts markings on a course at the scale of the rules.
struct Marker<'c> {
    random: &'c mut Stream,
    options: &'c RoadCourseOptions,
    course: &'c mut RoadCourse,
    /// Occupied intervals along the road (m).
    taken: Vec<(f64, f64)>,
}

impl Marker<'_> {
    fn mark(&mut self) {
        self.put(0.0, RoadMarkKind::Start);
        self.own_crossing();
        self.straights();
        self.centre_line();
        self.gaps();
        self.artefacts();
        self.course.marks.sort_by(|a, b| a.at.total_cmp(&b.at));
    }

    fn put(&mut self, at: f64, kind: RoadMarkKind) {
        self.course.marks.push(RoadMark { at, kind });
    }

    /// Occupies a part of the road if it is free.
    fn take(&mut self, from: f64, to: f64) -> bool {
        let length = self.course.line.length();
        let apart =
            |&(a, b): &(f64, f64)| [0.0, length, -length].iter().all(|turn| to < a + turn || from > b + turn);
        let is_free = from >= 0.0 && to <= length && self.taken.iter().all(apart);
        if is_free {
            self.taken.push((from, to));
        }
        is_free
    }

    /// Marks a crossing of the road with itself, at both of its places.
    fn own_crossing(&mut self) {
        let line = self.course.line.clone();
        let count = (line.length() / 0.02) as usize;
        let place = |i: usize| 0.02 * i as f64;
        let near = |i: usize| {
            let station = line.at(place(i));
            station.curvature == 0.0 && station.pose.position().coords.norm() < 0.4
        };
        let runs: Vec<usize> = (0..count).filter(|&i| near(i)).collect();
        let Some(&first) = runs.first() else { return };
        let Some(&second) = runs.iter().find(|&&i| place(i - first) > 2.0) else { return };
        let meet = crossing_of(&line.at(place(first)).pose, &line.at(place(second)).pose);
        let Some((on_first, on_second)) = meet else { return };
        let (a, b) = (place(first) + on_first, place(second) + on_second);
        let turn = |from: f64, to: f64| {
            let angle = angle_difference(line.at(to).pose.heading, line.at(from).pose.heading);
            // The other road has no direction.
            if angle < 0.0 { angle + std::f64::consts::PI } else { angle }
        };
        for (at, other, right_of_way) in [
            (a, b, RightOfWay::Priority),
            (b, a, if self.random.chance(0.5) { RightOfWay::Stop } else { RightOfWay::GiveWay }),
        ] {
            self.taken.push((at - 1.3, at + 1.3));
            let angle = turn(at, other);
            self.put(at, RoadMarkKind::Crossing(Crossing { angle, arms: [0.0; 2], right_of_way }));
        }
    }

    /// Adds crossings, side roads, crosswalks and numbers on straights.
    fn straights(&mut self) {
        let mut begun = 0.0;
        for element in self.course.line.elements().to_vec() {
            let (from, to) = (begun, begun + element.length);
            begun = to;
            if element.curvature != [0.0; 2] || element.length < 1.2 {
                continue;
            }
            let middle = self.random.between(0.35, 0.65) * element.length + from;
            if self.parking(middle, element.length) {
                continue;
            }
            if element.length > 2.4 && self.random.chance(self.options.crossings) {
                if self.room_for_arms(middle) && self.take(middle - 1.0, middle + 1.0) {
                    let angle = self.random.between(70.0, 110.0).to_radians();
                    let arms = [[0.8, 0.8], [0.8, 0.0], [0.0, 0.8]][self.random.below(3)];
                    let right_of_way =
                        [RightOfWay::Priority, RightOfWay::Stop, RightOfWay::GiveWay][self.random.below(3)];
                    self.put(middle, RoadMarkKind::Crossing(Crossing { angle, arms, right_of_way }));
                } else if self.take(middle - 0.5, middle + 0.5) {
                    let side = [RoadSide::Left, RoadSide::Right][self.random.below(2)];
                    self.put(middle - 0.45, RoadMarkKind::SideRoad(side, 0.9));
                }
            } else if self.random.chance(self.options.zebras) && self.take(middle - 0.7, middle + 0.7) {
                self.put(middle - 0.2, RoadMarkKind::Zebra);
            } else if self.random.chance(0.3 * self.options.crossings)
                && self.take(middle - 0.3, middle + 0.5)
            {
                let value = 10 * (1 + self.random.below(8)) as u8;
                let struck = self.random.chance(0.5);
                self.put(middle, RoadMarkKind::Speed(value, struck));
            }
        }
    }

    /// Adds parking areas on both sides of a straight. Courses without any draw no random number for them.
    fn parking(&mut self, middle: f64, straight: f64) -> bool {
        let chance = self.options.parking;
        let long = PARKING.0.max(PARKING.1);
        // Room for the slanted ends, and 1 m to the next element.
        let half = 0.5 * long + 0.6;
        let has_room = chance > 0.0 && straight > 2.0 * half + 0.4;
        if !(has_room && self.random.chance(chance) && self.room_for_arms(middle)) {
            return false;
        }
        if !self.take(middle - half, middle + half) {
            return false;
        }
        self.put(middle - 0.5 * PARKING.0, RoadMarkKind::Parking(RoadSide::Right, PARKING.0));
        self.put(middle - 0.5 * PARKING.1, RoadMarkKind::Parking(RoadSide::Left, PARKING.1));
        true
    }

    /// Whether the arms of a crossing would not overlap the road.
    fn room_for_arms(&self, at: f64) -> bool {
        let line = &self.course.line;
        let pose = line.at(at).pose;
        let far = 0.8 + 2.6 * self.course.edge();
        line.stations().iter().all(|station| {
            let own = pose.to_local(station.pose.position());
            own.x.abs() > 1.6 || own.y.abs() < 0.3 || own.y.abs() > far
        })
    }

    /// Adds kinds of centre markings, each at least 1 m long.
    fn centre_line(&mut self) {
        let length = self.course.line.length();
        let kinds = [Centre::Dashed, Centre::Double, Centre::SolidLeft, Centre::SolidRight];
        let mut at = self.random.between(1.0, 6.0);
        while at < length - 1.5 {
            let kind = if self.random.chance(0.5) { Centre::Dashed } else { kinds[self.random.below(4)] };
            self.course.centre.push((at, kind));
            at += self.random.between(1.0, 6.0);
        }
        self.course.centre.push(((at - 0.5).min(length - 0.2), Centre::Dashed));
        self.course.centre.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    fn gaps(&mut self) {
        let length = self.course.line.length();
        let lines = [Line::Left, Line::Centre, Line::Right];
        for _ in 0..(self.options.gaps * length) as usize {
            let at = self.random.uniform() * length;
            let long = self.random.between(0.2, 1.0) * self.options.longest_gap;
            if long > 0.0 && self.take(at - 0.5, at + long + 0.5) {
                let first = self.random.below(3);
                self.put(at, RoadMarkKind::Gap(lines[first], long));
                if self.random.chance(0.25) {
                    self.put(at, RoadMarkKind::Gap(lines[(first + 1) % 3], long));
                }
            }
        }
    }

    fn artefacts(&mut self) {
        let length = self.course.line.length();
        for _ in 0..(self.options.artefacts * length) as usize {
            let at = self.random.uniform() * length;
            let (long, wide) = (self.random.between(0.03, 0.5), self.random.between(0.02, 0.2));
            let out = self.course.edge() + 0.12 + wide + self.random.between(0.0, 0.5);
            let left = if self.random.chance(0.5) { out } else { -out };
            let place = self.course.line.beside(at, left);
            let (_, aside) = self.course.line.locate(place, None);
            let reach = self.course.edge() + 0.12 + 0.5 * (long + wide);
            let near_crossing = self
                .course
                .crossings()
                .any(|(middle, _)| (self.course.line.at(middle).pose.position() - place).norm() < 2.2);
            if aside.abs() > reach && !near_crossing {
                self.put(at, RoadMarkKind::Artefact(left, long, wide));
            }
        }
    }
}

/// Intersection of two straight lines: distances along each of them (m).
fn crossing_of(first: &Pose, second: &Pose) -> Option<(f64, f64)> {
    let between: Vector = second.position() - first.position();
    let (a, b) = (first.forward(), second.forward());
    let sine = cross(a, b);
    (sine.abs() > 0.1).then(|| (cross(between, b) / sine, cross(between, a) / sine))
}
