use super::course::EventCourse;
use crate::geometry::{Point, Pose};
use crate::race::referee::RaceScore;

/// Measures the times of an event, and checks whether a car stays on its course.
#[derive(Debug, Clone)]
pub struct EventReferee {
    course: EventCourse,
    wheels: [Point; 4],
    nose: Point,
    verdict: RaceScore,
    nearest: usize,
    outside: bool,
    /// Crossing times of the start and finish lines.
    crossed: Vec<[Option<f64>; 2]>,
    /// Stations passed, and the time, at the last call.
    last: Option<(f64, f64)>,
}

/// Number of stations ahead and behind within which a car is searched.
const WINDOW: [usize; 2] = [16, 4];
/// The same for a wheel, relative to the nose.
const WHEELS: [usize; 2] = [3, 14];

impl EventReferee {
    /// A referee for a car with wheels at the given positions in its frame; its nose breaks the light
    /// barriers.
    pub fn new(course: EventCourse, wheels: [Point; 4], nose: Point) -> Self {
        let crossed = vec![[None; 2]; course.timed().len()];
        let verdict = RaceScore::default();
        Self { course, wheels, nose, verdict, nearest: 0, outside: false, crossed, last: None }
    }

    /// Result so far. Its lap times are those of the event.
    pub fn verdict(&self) -> &RaceScore {
        &self.verdict
    }

    /// Whether all times are taken, and the car is before the end of the lane behind the finish.
    pub fn is_complete(&self) -> bool {
        let beyond = self
            .last
            .is_some_and(|(passed, _)| passed >= self.course.corridor().stations().len() as f64 - 1.0);
        !beyond && self.verdict.lap_times.len() == self.course.timed().len()
    }

    /// Takes the pose of the car at a time, and the number of cones knocked over so far.
    pub fn see(&mut self, time: f64, pose: Pose, cones_hit: usize) {
        let nose = pose.to_world(self.nose);
        let begin = self.course.timed().first().map_or(0, |lines| lines[0]);
        // Before the first call, the car is anywhere before the first line.
        let around = if self.last.is_some() {
            self.nearest.saturating_sub(WINDOW[1])..self.nearest + WINDOW[0]
        } else {
            0..begin + 1
        };
        self.nearest = self.search(nose, around);
        let passed = self.passed(nose);
        if let Some((before, then)) = self.last {
            self.take_times((before, then), (passed, time));
        }
        self.last = Some((passed, time));
        let outside = self.wheels.iter().all(|wheel| self.is_outside(pose.to_world(*wheel)));
        self.verdict.off_course += usize::from(outside && !self.outside);
        self.outside = outside;
        self.verdict.cones_hit = cones_hit;
    }

    /// Number of stations passed, with the fraction of the next one.
    fn passed(&self, place: Point) -> f64 {
        let stations = self.course.corridor().stations();
        let station = stations[self.nearest];
        let along = nalgebra::Vector2::new(station.normal.y, -station.normal.x);
        let other = if self.nearest + 1 < stations.len() { self.nearest + 1 } else { self.nearest - 1 };
        let step = (stations[other].position - station.position).norm();
        self.nearest as f64 + (place - station.position).dot(&along) / step.max(1e-9)
    }

    /// Records the lines crossed between two calls, with interpolated times.
    fn take_times(&mut self, (before, then): (f64, f64), (passed, time): (f64, f64)) {
        for (lines, crossed) in self.course.timed().iter().zip(&mut self.crossed) {
            for end in [0, 1] {
                let line = lines[end] as f64;
                if crossed[end].is_some() || !(before < line && passed >= line) {
                    continue;
                }
                crossed[end] = Some(then + (time - then) * (line - before) / (passed - before));
                if let [Some(begin), Some(finish)] = *crossed {
                    self.verdict.lap_times.push(finish - begin);
                }
            }
        }
    }

    /// The station nearest to a point, among some.
    fn search(&self, place: Point, around: std::ops::Range<usize>) -> usize {
        let stations = self.course.corridor().stations();
        let away = |i: usize| (stations[i].position - place).norm_squared();
        let around = around.start..around.end.min(stations.len());
        around.min_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap_or(self.nearest)
    }

    fn is_outside(&self, wheel: Point) -> bool {
        let around = self.nearest.saturating_sub(WHEELS[1])..self.nearest + WHEELS[0];
        let station = self.course.corridor().stations()[self.search(wheel, around)];
        let aside = (wheel - station.position).dot(&station.normal);
        aside > station.left || aside < -station.right
    }
}
