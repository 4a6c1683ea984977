use super::corridor::Corridor;
use crate::geometry::{Point, Pose};

/// Result of a race, by the rules of Formula Student: a penalty of 2 s per cone and 10 s per excursion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RaceScore {
    /// Time of each completed lap (s).
    pub lap_times: Vec<f64>,
    /// Number of excursions: all four wheels outside the course.
    pub off_course: usize,
    /// Number of cones knocked over.
    pub cones_hit: usize,
}

impl RaceScore {
    /// Penalties for a cone and for leaving the course (s).
    pub const PENALTIES: [f64; 2] = [2.0, 10.0];

    /// Sum of lap times and penalties (s).
    pub fn total(&self) -> f64 {
        let [cone, course] = Self::PENALTIES;
        self.lap_times.iter().sum::<f64>() + cone * self.cones_hit as f64 + course * self.off_course as f64
    }
}

/// Takes lap times, and checks whether a car stays on its track.
///
/// ```
/// use roverlab::geometry::{Point, Pose, direction};
/// use roverlab::race::{Corridor, Referee};
/// let place = |degrees: u32| Point::origin() + direction(f64::from(degrees).to_radians()) * 20.0;
/// let ring = Corridor::closed(&(0..90).map(|k| (place(4 * k), 1.5, 1.5)).collect::<Vec<_>>())?;
/// let wheels = [(0.0, 0.6), (0.0, -0.6), (1.55, 0.6), (1.55, -0.6)].map(|(x, y)| Point::new(x, y));
/// let mut referee = Referee::new(ring, wheels);
/// // Twice around at 36 deg/s, timed from line crossing to line crossing; one cone falls.
/// for step in 0..730 {
///     let at = place(step);
///     let heading = f64::from(step).to_radians() + 0.5 * std::f64::consts::PI;
///     referee.see(f64::from(step) / 36.0, Pose::new(at.x, at.y, heading), usize::from(step > 500));
/// }
/// let score = referee.verdict();
/// assert!((score.lap_times[0] - 10.0).abs() < 0.2 && score.off_course == 0);
/// assert!((score.total() - score.lap_times.iter().sum::<f64>() - 2.0).abs() < 1e-9, "2 s for the cone");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Referee {
    corridor: Corridor,
    wheels: [Point; 4],
    verdict: RaceScore,
    nearest: Option<usize>,
    outside: bool,
    /// Time of the last line crossing (s).
    started: Option<f64>,
    /// Number of stations passed since.
    passed: i64,
    /// Number of stations from the line to the car, over all laps; negative before the line.
    driven: i64,
    last: f64,
}

impl Referee {
    /// A referee for a closed track whose line is at the first station, and for a car with wheels at the
    /// given positions in its frame.
    pub fn new(corridor: Corridor, wheels: [Point; 4]) -> Self {
        let verdict = RaceScore::default();
        Self {
            corridor,
            wheels,
            verdict,
            nearest: None,
            outside: false,
            started: None,
            passed: 0,
            driven: 0,
            last: 0.0,
        }
    }

    /// Result so far.
    pub fn verdict(&self) -> &RaceScore {
        &self.verdict
    }

    /// Distance from the line along the centre line, over all laps (m); negative before the line.
    pub fn distance(&self) -> f64 {
        self.driven as f64 * self.corridor.length() / self.corridor.stations().len() as f64
    }

    /// Takes the pose of the car at a time, and the number of cones knocked over so far.
    pub fn see(&mut self, time: f64, pose: Pose, cones_hit: usize) {
        let n = self.corridor.stations().len();
        let middle = nalgebra::center(&self.wheels[0], &self.wheels[3]);
        let place = pose.to_world(middle);
        let before = self.nearest.unwrap_or_else(|| self.search(place, 0, n));
        // Between two calls, a car stays within a window of some metres.
        let now = self.search(place, before + n - WINDOW.min(n / 3), 2 * WINDOW.min(n / 3) + 1);
        let step = (now + n + n / 2 - before) % n;
        let step = step as i64 - (n / 2) as i64;
        self.passed += step;
        self.driven = if self.nearest.is_some() {
            self.driven + step
        } else if now > n / 2 {
            now as i64 - n as i64
        } else {
            now as i64
        };
        self.nearest = Some(now);
        let crossed = step > 0 && now < before;
        if crossed && (self.started.is_none() || self.passed > (n / 2) as i64) {
            let share = (n - before) as f64 / step as f64;
            let instant = self.last + (time - self.last) * share.clamp(0.0, 1.0);
            if let Some(started) = self.started.replace(instant) {
                self.verdict.lap_times.push(instant - started);
            }
            self.passed = now as i64;
        }
        self.last = time;
        let outside = self.wheels.iter().all(|wheel| self.is_outside(pose.to_world(*wheel), now));
        self.verdict.off_course += usize::from(outside && !self.outside);
        self.outside = outside;
        self.verdict.cones_hit = cones_hit;
    }

    /// The station nearest to a point, among some.
    fn search(&self, place: Point, from: usize, count: usize) -> usize {
        let stations = self.corridor.stations();
        let n = stations.len();
        let away = |i: usize| (stations[i % n].position - place).norm_squared();
        (from..from + count).min_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap_or(from) % n
    }

    fn is_outside(&self, wheel: Point, near: usize) -> bool {
        let n = self.corridor.stations().len();
        let at = self.search(wheel, near + n - 4.min(n / 3), 9.min(n));
        let station = self.corridor.stations()[at];
        let aside = (wheel - station.position).dot(&station.normal);
        aside > station.left || aside < -station.right
    }
}

/// Number of stations to either side within which a car is searched.
const WINDOW: usize = 20;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::direction;
    use std::f64::consts::TAU;

    fn ring() -> Referee {
        let rows: Vec<_> = (0..120)
            .map(|i| (Point::origin() + direction(f64::from(i) * TAU / 120.0) * 20.0, 2.0, 2.0))
            .collect();
        let wheels = [(0.0, 0.6), (0.0, -0.6), (1.5, 0.6), (1.5, -0.6)].map(|(x, y)| Point::new(x, y));
        Referee::new(Corridor::closed(&rows).unwrap(), wheels)
    }

    fn drive(referee: &mut Referee, from: f64, to: f64, radius: impl Fn(f64) -> f64) {
        let mut angle = from;
        while angle < to {
            let place = direction(angle) * radius(angle);
            // One radian in ten seconds.
            referee.see(10.0 * (angle - from), Pose::new(place.x, place.y, angle + 0.25 * TAU), 0);
            angle += 0.01;
        }
    }

    #[test]
    fn laps_are_timed_at_the_line() {
        let mut referee = ring();
        drive(&mut referee, -0.3, 2.5 * TAU, |_| 20.0);
        let times = &referee.verdict().lap_times;
        assert!(times.len() == 2 && times.iter().all(|time| (time - 10.0 * TAU).abs() < 0.5), "{times:?}");
        assert_eq!(referee.verdict().off_course, 0);
    }

    #[test]
    fn leaving_is_counted_once_for_each_time() {
        let mut referee = ring();
        drive(
            &mut referee,
            -0.3,
            3.0,
            |angle| if (1.0..1.5).contains(&angle) || angle > 2.5 { 24.0 } else { 21.0 },
        );
        assert_eq!(referee.verdict().off_course, 2);
        assert!(referee.verdict().lap_times.is_empty());
    }

    #[test]
    fn penalties() {
        let verdict = RaceScore { lap_times: vec![20.0, 21.0], off_course: 1, cones_hit: 3 };
        assert_eq!(verdict.total(), 57.0);
    }
}
