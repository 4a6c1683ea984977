use std::sync::Arc;

use super::turn::draw_turn;
use crate::geometry::{Point, Pose};
use crate::random::Stream;
use crate::world::road::{
    Alignment, Appearance, Centre, CourseError, Crossing, RightOfWay, RoadCourse, RoadMark, RoadMarkKind,
    RoadSide, Traffic,
};
use crate::world::{Colour, Object, ObjectKind, RobotSpec, Scene, Shape};

/// A white box on the road.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadBox {
    /// Position of its near side along the course's line at first; for crossing traffic, that of the
    /// crossing's middle (m).
    pub along: f64,
    /// Position of its middle to the left of the own lane's centre; for crossing traffic, along the other
    /// road from the crossing's middle (m).
    pub left: f64,
    /// Length, width and height (m).
    pub size: [f64; 3],
    /// How it moves.
    pub motion: BoxMotion,
}

/// How a [`RoadBox`] moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BoxMotion {
    /// Not at all.
    Static,
    /// Along its lane over a distance (m) at 0.6 m/s, once a car is 1 m behind it. Then it is off the road
    /// until the next lap.
    Along(f64),
    /// In the other lane towards the car over a distance (m) at 0.6 m/s, once the car is 3.4 m before it.
    /// Then it is off the road until the next lap.
    Oncoming(f64),
    /// Across a crosswalk at 0.3 m/s, once a car stands before it: a pedestrian.
    Across,
    /// Over a crossing from the right at 0.6 m/s, once a car stands before it. The angle is that from this
    /// road's direction to the other road's (rad).
    Crossing(f64),
}

/// Size of a pedestrian, by the rules; they leave the depth open (m).
pub(super) const PERSON: [f64; 3] = [0.10, 0.10, 0.15];
/// Distance from an edge line to the middle of a waiting pedestrian: the area is 200 mm wide (m).
pub(super) const WAITS: f64 = 0.11;
/// Length of a crosswalk (m).
pub(super) const ZEBRA: f64 = 0.40;
/// Distance beyond the edge lines that crossing traffic has left when it is clear, by the rules (m).
pub(super) const CLEAR: f64 = 0.25;
/// Distance beyond that at which it waits (m).
const WAITS_BEYOND: f64 = 0.15;
/// Width of stop and give-way lines (m).
const LINE: f64 = 0.038;
/// Free road before a box, where cars change lanes, and behind it (m).
const APART: [f64; 2] = [1.6, 2.6];
/// Free road that a box needs that moves and is passed (m).
const STRETCH: f64 = 7.0;
/// Length of the shortest no-passing zone in which a box drives (m).
const ZONE: f64 = 2.2;
/// Distance of that box from the zone's beginning (m): cars see the zone before they could pass.
const INTO_ZONE: f64 = 1.0;
/// Length of the shortest speed zone (m), by the rules' least distance between elements.
const ZONE_LENGTH: f64 = 1.5;
/// Number of a speed limit of 1 m/s, by the rules.
const NUMBER: f64 = 36.0;
/// How far a line that strikes a number out begins before it (m).
const STRIKE: f64 = 0.05;
/// Number of standing boxes in the own lane of a course.
const BOXES: usize = 4;
/// Distance from the beginning of what blocks the own lane to an oncoming box at first (m): the car is 2.0 to
/// 2.4 m before it when the box begins to drive.
const MEETING: [f64; 2] = [1.0, 1.4];
/// Length of the longest box (m).
const LONGEST: f64 = 0.4;
/// Straight road before what blocks the own lane, on which cars see an oncoming box (m).
const SIGHT: f64 = 0.9;
/// Distance before what blocks the own lane at which an oncoming box leaves the road (m): a car waits there.
const BEHIND_CAR: f64 = 2.6;
/// Distance from a standing box in the own lane to one in the other lane behind it (m): cars return between
/// them.
const BETWEEN: [f64; 2] = [2.0, 2.2];

/// A course with boxes and pedestrians for Obstacle Evasion.
///
/// ```
/// use roverlab::drive::traffic::TrafficScene;
/// use roverlab::world::road::{RoadCourseOptions, generate};
/// let options = RoadCourseOptions { zebras: 0.8, ..RoadCourseOptions::default() };
/// let scene = TrafficScene::drawn(generate(3, &options)?, 3);
/// assert!(!scene.boxes.is_empty());
/// # Ok::<(), roverlab::world::road::CourseError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TrafficScene {
    /// The course.
    pub course: RoadCourse,
    /// The boxes on it.
    pub boxes: Vec<RoadBox>,
}

impl TrafficScene {
    /// Puts boxes at random on a course at the scale of the rules: pedestrians at every other crosswalk,
    /// traffic at every other crossing where this road gives way, a slow box in a no-passing zone, a barred
    /// area on a straight, a slow box where passing is allowed, and up to four boxes that stand. In the other
    /// lane, a box stands behind one of these, and boxes come towards the car there and at the barred area,
    /// if these find a straight with enough room; other marks may be removed there. Zones beside what is
    /// passed become dashed, and patches where pedestrians wait are removed. Half of the courses that cross
    /// themselves have a mandatory turn there, and nothing else on the part that it skips.
    pub fn drawn(mut course: RoadCourse, seed: u64) -> Self {
        let turn = draw_turn(&mut course, &mut Stream::new(seed).child("turn", 0));
        let marks = course.marks.iter().filter_map(|mark| extent(&course, mark));
        let taken = marks.chain(turn).collect();
        let random = Stream::new(seed).child("traffic", 0);
        let mut drawing = Drawing { course, random, taken, passed: Vec::new(), boxes: Vec::new() };
        drawing.end_speed_zones();
        let met = drawing.meeting(LONGEST, true);
        drawing.pedestrians();
        drawing.crossing_traffic();
        drawing.leader();
        drawing.barred_area();
        drawing.passable(met);
        drawing.allow_passing();
        let Drawing { mut course, mut boxes, .. } = drawing;
        course.marks.sort_by(|a, b| a.at.total_cmp(&b.at));
        boxes.sort_by(|a, b| a.along.total_cmp(&b.along));
        Self { course, boxes }
    }

    /// The scene of a simulation: the course with its boxes, which are the objects of the world in their
    /// order, and a car at its start. Fails if the course cannot be drawn.
    pub fn scene(&self, appearance: &Appearance, car: RobotSpec) -> Result<Scene, CourseError> {
        let mut world = self.course.world(appearance)?;
        for item in &self.boxes {
            let [length, width, height] = item.size;
            let shape = Shape::Box { length, width, height };
            let kind = ObjectKind { fixed: true, ..ObjectKind::new("box", shape, Colour::WHITE) };
            let pose = item.pose_at(&self.course, item.along, item.left);
            world.objects.push(Object::new(Arc::new(kind), pose));
        }
        Ok(Scene::with_robot(world, car, self.course.start()))
    }

    /// Crosswalks: their near edges along the line (m).
    pub fn zebras(&self) -> Vec<f64> {
        zebras(&self.course).collect()
    }

    /// Stop lines and give-way lines of the own lane: their near edges along the line (m), and whether cars
    /// have to stop for 3 s.
    pub fn lines(&self) -> Vec<(f64, bool)> {
        self.course.marks.iter().filter_map(|mark| own_line(&self.course, mark)).collect()
    }

    /// Barred areas in the own lane: beginning, length and width (m).
    pub fn barred_areas(&self) -> Vec<(f64, f64, f64)> {
        let own = if self.course.traffic == Traffic::Left { RoadSide::Left } else { RoadSide::Right };
        let area = |mark: &RoadMark| match mark.kind {
            RoadMarkKind::Barred(side, long, wide) if side == own => Some((mark.at, long, wide)),
            _ => None,
        };
        self.course.marks.iter().filter_map(area).collect()
    }

    /// Speed zones: beginning and end along the line (m), the end beyond the line's if the zone goes on in
    /// the next lap; and the maximum speed (m/s).
    pub fn speed_zones(&self) -> Vec<(f64, f64, f64)> {
        speed_zones(&self.course)
    }

    /// Stretches of the line where the own lane must not be left: beginning and end (m).
    pub fn no_passing_zones(&self) -> Vec<(f64, f64)> {
        no_passing_zones(&self.course)
    }
}

impl RoadBox {
    /// Whether its middle is in the own lane of a course.
    pub(super) fn is_in_lane(&self, course: &RoadCourse) -> bool {
        self.left.abs() < 0.5 * course.edge()
    }

    /// Pose at a position along a course's line and to the left, as in its fields.
    pub(super) fn pose_at(&self, course: &RoadCourse, along: f64, left: f64) -> Pose {
        let BoxMotion::Crossing(angle) = self.motion else {
            return course.pose(along + 0.5 * self.size[0], left);
        };
        let middle = course.line.at(along).pose;
        let other = Pose::new(middle.x, middle.y, middle.heading + angle);
        let place = other.to_world(Point::new(left, course.lane_middle()));
        Pose::new(place.x, place.y, other.heading)
    }
}

/// A scene while boxes are put on it.
struct Drawing {
    course: RoadCourse,
    random: Stream,
    /// Occupied intervals along the line, and those in which cars leave their lane (m).
    taken: Vec<(f64, f64)>,
    passed: Vec<(f64, f64)>,
    boxes: Vec<RoadBox>,
}

impl Drawing {
    /// Ends each speed zone that goes on where there is room for a number that is struck out; where there is
    /// none, the zone is removed. Nothing that cars pass is put in a zone.
    fn end_speed_zones(&mut self) {
        let is_number = |mark: &RoadMark| matches!(mark.kind, RoadMarkKind::Speed(..));
        let mut numbers: Vec<RoadMark> = self.course.marks.iter().copied().filter(is_number).collect();
        numbers.sort_by(|a, b| a.at.total_cmp(&b.at));
        self.course.marks.retain(|mark| !matches!(mark.kind, RoadMarkKind::Speed(_, false)));
        for (index, mark) in numbers.iter().enumerate() {
            let RoadMarkKind::Speed(value, false) = mark.kind else { continue };
            let struck = RoadMarkKind::Speed(value, true);
            let drawn = numbers.get(index + 1).filter(|next| next.kind == struck).map(|next| next.at);
            let Some(end) = drawn.or_else(|| self.end_of_zone(mark.at)) else { continue };
            self.taken.push((mark.at - 0.5, end + 1.1));
            self.course.marks.push(*mark);
            if drawn.is_none() {
                self.course.marks.push(RoadMark { at: end, kind: struck });
            }
        }
    }

    /// Place for the end of a speed zone (m).
    fn end_of_zone(&self, from: f64) -> Option<f64> {
        let mut places = (0..20).map(|step| from + ZONE_LENGTH + 0.25 * f64::from(step));
        let is_alone = self.is_free(from + 0.7, from + ZONE_LENGTH);
        places.find(|at| self.is_free(at - 0.1, at + 0.6)).filter(|_| is_alone)
    }

    fn pedestrians(&mut self) {
        let places: Vec<f64> = zebras(&self.course).collect();
        let line = self.course.line.clone();
        let middles: Vec<Point> = places.iter().map(|at| line.at(at + 0.5 * ZEBRA).pose.position()).collect();
        self.course.marks.retain(|mark| match mark.kind {
            RoadMarkKind::Artefact(left, ..) => {
                let place = line.beside(mark.at, left);
                middles.iter().all(|middle| (middle - place).norm() > 1.5)
            }
            _ => true,
        });
        for at in places.into_iter().step_by(2) {
            let side = if self.random.chance(0.5) { 1.0 } else { -1.0 };
            let left = side * (self.course.edge() + WAITS) - self.course.lane_middle();
            let along = at + 0.5 * (ZEBRA - PERSON[0]);
            self.boxes.push(RoadBox { along, left, size: PERSON, motion: BoxMotion::Across });
        }
    }

    fn crossing_traffic(&mut self) {
        let crossings: Vec<(f64, f64)> = self
            .course
            .crossings()
            .filter(|(_, it)| it.right_of_way != RightOfWay::Priority && it.arms.iter().all(|arm| *arm > 0.0))
            .map(|(at, it)| (at, it.angle))
            .collect();
        for (along, angle) in crossings.into_iter().step_by(2) {
            let size = self.size();
            let left = -(self.course.edge() + CLEAR + WAITS_BEYOND + 0.5 * size[0]);
            self.boxes.push(RoadBox { along, left, size, motion: BoxMotion::Crossing(angle) });
        }
    }

    /// A box that drives through the first no-passing zone with enough room.
    fn leader(&mut self) {
        let is_long = |&(from, to): &(f64, f64)| to - from > ZONE;
        let is_free = |&(from, to): &(f64, f64)| self.is_free(from - APART[0], to + APART[1]);
        let zones = no_passing_zones(&self.course);
        let Some((from, to)) = zones.into_iter().filter(is_long).find(is_free) else { return };
        self.taken.push((from - APART[0], to + APART[1]));
        let (along, size) = (from + INTO_ZONE, self.size());
        self.boxes.push(RoadBox { along, left: 0.0, size, motion: BoxMotion::Along(to - along - size[0]) });
    }

    /// A barred area on a straight.
    fn barred_area(&mut self) {
        let (long, wide) = (self.random.between(0.8, 1.6), self.random.between(0.15, 0.25));
        let at = self.meeting(long, false).or_else(|| {
            let line = self.course.line.clone();
            let is_straight = |at: f64| is_straight(&line, at + APART[0], at + APART[0] + long);
            self.take(APART[0] + long + APART[1], is_straight)
        });
        let Some(at) = at else { return };
        let side = if self.course.traffic == Traffic::Left { RoadSide::Left } else { RoadSide::Right };
        self.course.marks.push(RoadMark { at: at + APART[0], kind: RoadMarkKind::Barred(side, long, wide) });
    }

    /// Boxes that may be passed: one that moves, and some that stand.
    fn passable(&mut self, mut met: Option<f64>) {
        if let Some(at) = self.take(STRETCH, |_| true) {
            let motion = BoxMotion::Along(STRETCH - APART[0] - APART[1]);
            let size = self.size();
            self.boxes.push(RoadBox { along: at + APART[0], left: 0.0, size, motion });
        }
        for count in 0..BOXES {
            let at = met.take().or_else(|| self.take(APART[0] + APART[1], |_| true));
            let Some(along) = at.map(|at| at + APART[0]) else { break };
            let (size, left) = (self.size(), self.random.between(-0.03, 0.03));
            self.boxes.push(RoadBox { along, left, size, motion: BoxMotion::Static });
            let other = along + self.random.between(BETWEEN[0], BETWEEN[1]);
            // On a bend, cars return later.
            if count == 1 && is_straight(&self.course.line, along - SIGHT, other + LONGEST) {
                self.oppose(other, BoxMotion::Static);
            }
        }
    }

    /// Occupies an interval for what blocks the own lane over a length (m), on a straight on which cars see
    /// a box that comes from behind it, and puts that box there; may clear the interval of marks. Returns
    /// where it begins (m).
    fn meeting(&mut self, long: f64, clears: bool) -> Option<f64> {
        let behind = self.random.between(MEETING[0], MEETING[1]);
        let line = self.course.line.clone();
        let is_seen = |at: f64| is_straight(&line, at + APART[0] - SIGHT, at + APART[0] + behind.max(long));
        let length = APART[0] + long + APART[1];
        let at = self.take(length, is_seen);
        let at = at.or_else(|| if clears { self.take_cleared(length, is_seen) } else { None })?;
        self.oppose(at + APART[0] + behind, BoxMotion::Oncoming(behind + BEHIND_CAR));
        Some(at)
    }

    /// The same as [`take`](Self::take), with side roads, roads that give way, crosswalks and gaps in
    /// lines removed from the interval.
    fn take_cleared(&mut self, long: f64, is_suitable: impl Fn(f64) -> bool) -> Option<f64> {
        let is_loose = |mark: &RoadMark| match mark.kind {
            RoadMarkKind::SideRoad(..) | RoadMarkKind::Gap(..) | RoadMarkKind::Zebra => true,
            RoadMarkKind::Crossing(Crossing { arms, right_of_way, .. }) => {
                right_of_way == RightOfWay::Priority && arms.iter().any(|arm| *arm > 0.0)
            }
            _ => false,
        };
        let marks = std::mem::take(&mut self.course.marks);
        let (mut loose, fixed): (Vec<_>, Vec<_>) = marks.into_iter().partition(is_loose);
        self.course.marks = fixed;
        let parts: Vec<_> = loose.iter().filter_map(|mark| extent(&self.course, mark)).collect();
        self.taken.retain(|part| !parts.contains(part));
        let at = self.take(long, is_suitable);
        if let Some(at) = at {
            let is_apart = |&(from, to): &(f64, f64)| to < at || from > at + long;
            loose.retain(|mark| extent(&self.course, mark).is_none_or(|part| is_apart(&part)));
        }
        self.taken.extend(loose.iter().filter_map(|mark| extent(&self.course, mark)));
        self.course.marks.extend(loose);
        at
    }

    /// Puts a box in the other lane.
    fn oppose(&mut self, along: f64, motion: BoxMotion) {
        let (size, left) = (self.size(), -2.0 * self.course.lane_middle());
        self.boxes.push(RoadBox { along, left, size, motion });
    }

    /// Makes the centre line dashed where cars leave their lane.
    fn allow_passing(&mut self) {
        let is_left = |&(from, to): &(f64, f64)| self.passed.iter().any(|&(a, b)| from < b && a < to);
        let zones: Vec<(f64, f64)> = no_passing_zones(&self.course).into_iter().filter(is_left).collect();
        for (at, kind) in &mut self.course.centre {
            if zones.iter().any(|(from, to)| (*from..*to).contains(&*at)) {
                *kind = Centre::Dashed;
            }
        }
    }

    /// Size of a box (m): 100 to 400 mm by the rules, and narrow enough to leave room in the other lane.
    fn size(&mut self) -> [f64; 3] {
        let random = &mut self.random;
        [random.between(0.1, 0.4), random.between(0.1, 0.3), random.between(0.1, 0.24)]
    }

    /// Occupies a suitable free interval of a length where cars leave their lane. Returns where it begins
    /// (m).
    fn take(&mut self, long: f64, is_suitable: impl Fn(f64) -> bool) -> Option<f64> {
        // A line that is too long for stations has no places, however many its length would give.
        if self.course.line.stations().is_empty() {
            return None;
        }
        let length = self.course.line.length();
        let from = self.random.uniform() * length;
        let mut places = (0..(length / 0.25) as usize).map(|i| (from + 0.25 * i as f64) % length);
        let at = places.find(|at| self.is_free(*at, at + long) && is_suitable(*at))?;
        self.taken.push((at, at + long));
        self.passed.push((at, at + long));
        Some(at)
    }

    /// Whether nothing else is in an interval of the line, whose ends are left free.
    fn is_free(&self, from: f64, to: f64) -> bool {
        let length = self.course.line.length();
        let turns = [0.0, length, -length];
        let is_apart = |&(a, b): &(f64, f64)| turns.iter().all(|turn| to < a + turn || from > b + turn);
        from > 1.0 && to < length - 0.5 && self.taken.iter().all(is_apart)
    }
}

/// Whether a line is straight between two places (m).
fn is_straight(line: &Alignment, from: f64, to: f64) -> bool {
    (0..=20).all(|i| line.at(from + 0.05 * f64::from(i) * (to - from)).curvature == 0.0)
}

fn zebras(course: &RoadCourse) -> impl Iterator<Item = f64> {
    course.marks.iter().filter(|mark| mark.kind == RoadMarkKind::Zebra).map(|mark| mark.at)
}

/// Near edge of the own lane's line at a mark (m), and whether it is a stop line.
fn own_line(course: &RoadCourse, mark: &RoadMark) -> Option<(f64, bool)> {
    match mark.kind {
        RoadMarkKind::StopLine => Some((mark.at - LINE, true)),
        RoadMarkKind::GiveWayLine => Some((mark.at - LINE, false)),
        RoadMarkKind::Crossing(crossing) => {
            let at = mark.at - course.crossing_reach(&crossing) - LINE;
            match crossing.right_of_way {
                RightOfWay::Priority => None,
                RightOfWay::Stop => Some((at, true)),
                RightOfWay::GiveWay | RightOfWay::FromTheRight => Some((at, false)),
            }
        }
        _ => None,
    }
}

fn speed_zones(course: &RoadCourse) -> Vec<(f64, f64, f64)> {
    let mut numbers: Vec<(f64, u8, bool)> = course
        .marks
        .iter()
        .filter_map(|mark| match mark.kind {
            RoadMarkKind::Speed(value, struck) => Some((mark.at, value, struck)),
            _ => None,
        })
        .collect();
    numbers.sort_by(|a, b| a.0.total_cmp(&b.0));
    let next = numbers.iter().cycle().skip(1);
    let zones = numbers.iter().zip(next).filter(|((_, _, struck), _)| !struck);
    let length = course.line.length();
    zones
        .map(|(&(from, value, _), &(to, _, struck))| {
            let to = if to > from { to } else { to + length };
            (
                from,
                if struck { to - STRIKE * course.size } else { to },
                course.size * f64::from(value) / NUMBER,
            )
        })
        .collect()
}

/// Intervals whose centre marking forbids to leave the own lane.
fn no_passing_zones(course: &RoadCourse) -> Vec<(f64, f64)> {
    let forbids = |kind: Centre| match kind {
        Centre::Dashed => false,
        Centre::Double => true,
        Centre::SolidLeft => course.traffic == Traffic::Left,
        Centre::SolidRight => course.traffic == Traffic::Right,
    };
    let ends = course.centre.iter().skip(1).map(|(at, _)| *at).chain([course.line.length()]);
    let mut zones: Vec<(f64, f64)> = Vec::new();
    for (&(from, kind), to) in course.centre.iter().zip(ends) {
        match zones.last_mut() {
            _ if !forbids(kind) => {}
            Some(last) if last.1 == from => last.1 = to,
            _ => zones.push((from, to)),
        }
    }
    zones
}

/// Part of the road that a mark needs for itself (m).
fn extent(course: &RoadCourse, mark: &RoadMark) -> Option<(f64, f64)> {
    match mark.kind {
        RoadMarkKind::Artefact(..) => None,
        RoadMarkKind::Gap(_, long)
        | RoadMarkKind::SideRoad(_, long)
        | RoadMarkKind::Barred(_, long, _)
        | RoadMarkKind::Parking(_, long) => Some((mark.at, mark.at + long)),
        RoadMarkKind::Crossing(crossing) => {
            let reach = course.crossing_reach(&crossing) + 0.2;
            Some((mark.at - reach, mark.at + reach))
        }
        _ => Some((mark.at - 0.1, mark.at + 0.6)),
    }
}
