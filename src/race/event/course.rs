use super::layout::{AT_EDGE, EventLayout, EventShape};
use super::line::{self, crossings, straight};
use crate::geometry::{Point, Pose};
use crate::race::cone::{ConeColour, ConeTrack, Event};
use crate::race::corridor::Corridor;
use crate::race::profile::{CarLimits, SpeedProfile};
use crate::race::racing_line::CarOutline;

/// The course of an event, as a referee determines it from all cones.
#[derive(Debug, Clone, PartialEq)]
pub struct EventCourse {
    event: Event,
    layout: EventLayout,
    corridor: Corridor,
    /// Stations of the start and finish line of each timed section.
    timed: Vec<[usize; 2]>,
}

/// Length of an acceleration from line to line, and of the track beyond its finish, unless cones show
/// otherwise (m).
const STRIP: (f64, f64) = (75.0, 25.0);
/// Distance from the nose to the start line, unless cones show otherwise (m).
const TO_START: f64 = 0.3;
/// Distance from the nose, ahead and behind, within which the start gate is expected (m).
const GATE: f64 = 8.0;
/// Length of a gap between cones of a row, relative to their usual distance, at which the row ends: it may
/// lack one cone, but not two.
const ROW_ENDS: f64 = 2.5;
/// Largest distance of an end of a course from its start (m): beyond it, cones are no part of an event.
const FARTHEST: f64 = 10_000.0;
/// Length of a course behind the rear axle of a car at the start (m).
const BEHIND: f64 = 1.0;

/// Usual distance between the cones of rows, where they stand side by side (m).
fn usual_distance(sorted: &[f64]) -> f64 {
    let apart = sorted.windows(2).map(|two| two[1] - two[0]);
    let mut apart: Vec<f64> = apart.filter(|metres| *metres > AT_EDGE).collect();
    apart.sort_by(f64::total_cmp);
    apart.get(apart.len() / 2).copied().unwrap_or(0.0)
}

/// The end of a row of cones that goes on from a place: before the first gap, beyond which others are strays.
fn row_end(sorted: &[f64], from: f64, gap: f64) -> f64 {
    let beyond = sorted.iter().filter(|place| **place > from);
    beyond.fold(from, |end, &place| if place - end <= gap { place } else { end })
}

/// Whether a strip begins near the nose of a car at the start, not far behind it.
fn begins_ahead(sorted: &[f64], gap: f64) -> bool {
    let backwards: Vec<f64> = sorted.iter().rev().map(|place| -place).collect();
    row_end(&backwards, 0.0, gap) < GATE && sorted.iter().any(|place| place.abs() < GATE)
}

/// Whether the ends of a course are near its start.
fn are_near(ends: [f64; 2]) -> bool {
    ends.iter().all(|end| end.abs() <= FARTHEST)
}

impl EventCourse {
    /// The course among the cones of a track, for a car with an outline. `None` for laps, if the cones match
    /// no event, if the car does not start up to 8 m before a strip, and if an end of the course would be
    /// more than 10 km away. A skidpad is recognised without its orange cones as well.
    ///
    /// The timing lines are the gates of the track, or else those between its large cones; for a skidpad, the
    /// line through its centre.
    pub fn of(track: &ConeTrack, outline: &CarOutline) -> Option<Self> {
        let start = track.start_pose()?;
        let skidpad = Self::skidpad(track, start).filter(|course| course.layout.has_circles(&track.cones));
        if track.event() == Event::Laps {
            // Without the orange cones of its lanes, a skidpad is one if all other cones say so.
            return skidpad.filter(|course| course.layout.is_whole(&track.cones));
        }
        skidpad.or_else(|| Self::acceleration(track, start, outline.nose))
    }

    fn acceleration(track: &ConeTrack, start: Pose, nose: f64) -> Option<Self> {
        let mut layout = EventLayout::find(&track.cones, start, EventShape::STRIP)?;
        layout.pose = layout.pose.compose(&Pose::new(nose, 0.0, 0.0));
        let along = |place: Point| layout.pose.to_local(place).x;
        let gates: Vec<f64> = if track.gates.is_empty() {
            track.of(ConeColour::BigOrange).map(along).collect()
        } else {
            track.gates.iter().flatten().map(|place| along(*place)).collect()
        };
        let mean = |near: &dyn Fn(f64) -> bool| {
            let places: Vec<f64> = gates.iter().copied().filter(|x| near(*x)).collect();
            (!places.is_empty()).then(|| places.iter().sum::<f64>() / places.len() as f64)
        };
        let begin = mean(&|x| x.abs() < GATE).unwrap_or(TO_START);
        let end = mean(&|x| x >= GATE).unwrap_or(begin + STRIP.0);
        let mut rows: Vec<f64> = layout.at_edges(&track.cones).map(|cone| along(cone.position)).collect();
        rows.sort_by(f64::total_cmp);
        let gap = ROW_ENDS * usual_distance(&rows);
        let ends = [-nose - BEHIND, Self::lane_end(track, &layout, end, gap)];
        if !are_near(ends) || begin < 0.0 || !begins_ahead(&rows, gap) {
            return None;
        }
        let points = straight(ends[0], ends[1]);
        let station = |x: f64| points.partition_point(|point| point.x < x - 1e-9);
        let timed = vec![[station(begin), station(end)]];
        Self::new(Event::Acceleration, layout, &points, timed)
    }

    /// End of the lane behind a finish: where orange cones stand across it. Those beside it, in a row from
    /// the finish on, show that it reaches to there at least, as the rules do.
    fn lane_end(track: &ConeTrack, layout: &EventLayout, finish: f64, gap: f64) -> f64 {
        let [inside, outside] = [-AT_EDGE, AT_EDGE].map(|more| layout.shape.half_width() + more);
        let placed = track.cones.iter().map(|cone| (layout.pose.to_local(cone.position), cone.colour));
        let mut lane: Vec<(Point, ConeColour)> =
            placed.filter(|(place, _)| place.x > finish && place.y.abs() < outside).collect();
        lane.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x));
        let places: Vec<f64> = lane.iter().map(|(place, _)| place.x).collect();
        let last = row_end(&places, finish, gap);
        let closes = |(place, colour): &&(Point, ConeColour)| {
            *colour == ConeColour::Orange && place.x <= last && place.y.abs() < inside
        };
        let closed = lane.iter().find(closes);
        closed.map_or(last.max(finish + STRIP.1), |(place, _)| place.x)
    }

    fn skidpad(track: &ConeTrack, start: Pose) -> Option<Self> {
        let layout = EventLayout::find(&track.cones, start, EventShape::EIGHT)?;
        let along = |place: Point| layout.pose.to_local(place).x;
        let EventShape::Eight { apart, outer, .. } = layout.shape else { return None };
        // The lane goes on behind the circles.
        let ends = [along(start.position()) - BEHIND, Self::lane_end(track, &layout, 0.0, outer)];
        if !are_near(ends) {
            return None;
        }
        // Circles that meet at the origin.
        let points = line::eight(apart, apart, ends);
        let lines = crossings(ends);
        let timed = vec![[lines[1], lines[2]], [lines[3], lines[4]]];
        Self::new(Event::Skidpad, layout, &points, timed)
    }

    fn new(event: Event, layout: EventLayout, points: &[Point], timed: Vec<[usize; 2]>) -> Option<Self> {
        let rows = points.iter().map(|point| {
            let sides = match layout.shape {
                EventShape::Eight { apart, inner, outer } if point.y > 0.0 => [apart - inner, outer - apart],
                EventShape::Eight { apart, inner, outer } if point.y < 0.0 => [outer - apart, apart - inner],
                _ => [layout.shape.half_width(); 2],
            };
            (layout.pose.to_world(*point), sides[0], sides[1])
        });
        let corridor = Corridor::open(&rows.collect::<Vec<_>>()).ok()?;
        Some(Self { event, layout, corridor, timed })
    }

    /// The event.
    pub fn event(&self) -> Event {
        self.event
    }

    /// Its edges, in the frame of the track.
    pub fn layout(&self) -> &EventLayout {
        &self.layout
    }

    /// The whole corridor, from behind the start to the end of the lane behind the finish.
    pub fn corridor(&self) -> &Corridor {
        &self.corridor
    }

    /// Stations of the start and finish line of each timed section: one for an acceleration; for a skidpad,
    /// the second laps to the right and to the left.
    pub fn timed(&self) -> &[[usize; 2]] {
        &self.timed
    }

    /// Quasi-steady-state optimum of each timed section (s): an acceleration from standstill, limited by the
    /// braking distance before the end of the lane, or circles as close to the inner cones as the car's width
    /// permits.
    pub fn optima(&self, limits: &CarLimits, outline: &CarOutline) -> Vec<f64> {
        match self.layout.shape {
            EventShape::Strip { .. } => self.strip_optimum(limits, outline).into_iter().collect(),
            EventShape::Eight { .. } => {
                let touches = outline.half_width + ConeColour::Unknown.radius();
                let radius = line::radius(self.layout.shape, touches);
                let speed =
                    (limits.grip.across(1.0 / radius, limits.drive) * radius).sqrt().min(limits.top_speed);
                vec![std::f64::consts::TAU * radius / speed; self.timed.len()]
            }
        }
    }

    /// Optimum of a strip; stations are positions of the nose.
    fn strip_optimum(&self, limits: &CarLimits, outline: &CarOutline) -> Option<f64> {
        let stations = self.corridor.stations();
        let along = |k: usize| self.layout.pose.to_local(stations[k].position).x;
        let first = (0..stations.len()).find(|&k| along(k) >= -1e-9)?;
        let last = (first..stations.len()).rev().find(|&k| {
            along(k) <= along(stations.len() - 1) - ConeColour::Orange.radius() - outline.room.min(0.1)
        })?;
        let points: Vec<Point> = stations[first..=last].iter().map(|s| s.position).collect();
        let profile = SpeedProfile::open(&points, limits, 0.0, 0.0).ok()?;
        let [begin, end] = (*self.timed.first()?).map(|station| station.saturating_sub(first));
        let pieces = begin..end.min(points.len() - 1);
        let seconds = |i: usize| 2.0 * profile.lengths[i] / (profile.speeds[i] + profile.speeds[i + 1]);
        Some(pieces.map(seconds).sum())
    }
}
