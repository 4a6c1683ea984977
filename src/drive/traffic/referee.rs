use crate::geometry::{Point, Pose};
use crate::parameter::{ParameterError, require, require_not_negative};
use crate::world::road::{LanePose, RoadCourse};
use crate::world::{DriveSpec, RobotSpec};

/// Rules of Free Drive that its text leaves open, or that differ between releases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeDriveRules {
    /// Whether the distance outside the own lane is subtracted: yes in the release of 2025, no in that of
    /// 2026.
    pub subtract_outside: bool,
    /// Penalty for leaving the lane with two wheels, and for each intervention by remote control (m).
    pub penalty: f64,
    /// Penalty for an intervention in the measure of autonomy (s; M. Bojarski et al., "End to end learning
    /// for self-driving cars", 2016).
    pub intervention: f64,
    /// Offset of the car's centre from the lane's centre at which the car is taken over (lane widths).
    pub astray: f64,
    /// Standstill after which the car is taken over (s).
    pub standing: f64,
}

impl Default for FreeDriveRules {
    /// The rules of 2025.
    fn default() -> Self {
        Self { subtract_outside: true, penalty: 5.0, intervention: 6.0, astray: 1.0, standing: 5.0 }
    }
}

impl FreeDriveRules {
    fn validate(&self) -> Result<(), ParameterError> {
        require_not_negative("penalty", self.penalty)?;
        require_not_negative("penalty for an intervention", self.intervention)?;
        require("astray offset", self.astray, self.astray > 0.0, "more than 0 lane widths")?;
        require("standing time", self.standing, self.standing > 0.0, "more than 0 s")
    }
}

/// Record of a car in Free Drive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FreeDriveScore {
    /// Time since the start (s).
    pub time: f64,
    /// Distance along the lane, without that under remote control (m).
    pub distance: f64,
    /// Part of it with two wheels outside the lane (m).
    pub outside: f64,
    /// Number of times that the car left the lane with at least two wheels.
    pub departures: u32,
    /// Number of interventions.
    pub interventions: u32,
    /// Time to the first departure, or to the end (s; Duckietown's survival time).
    pub survival: f64,
    /// Integrals of the squared and of the absolute offset from the lane's centre over the distance driven
    /// (Duckietown's deviation).
    squares: f64,
    deviation: f64,
}

impl FreeDriveScore {
    /// Root mean square offset of the car's centre from the lane's centre (m).
    pub fn offset_rms(&self) -> f64 {
        (self.squares / self.distance.max(1e-9)).sqrt()
    }

    /// Mean absolute offset of the car's centre from the lane's centre (m).
    pub fn mean_deviation(&self) -> f64 {
        self.deviation / self.distance.max(1e-9)
    }

    /// The result: the distance minus the penalties (m).
    pub fn result(&self, rules: &FreeDriveRules) -> f64 {
        let outside = if rules.subtract_outside { self.outside } else { 0.0 };
        let faults = self.departures + self.interventions;
        (self.distance - outside - rules.penalty * f64::from(faults)).max(0.0)
    }

    /// Share of the time driven without interventions (percent).
    pub fn autonomy(&self, rules: &FreeDriveRules) -> f64 {
        let helped = rules.intervention * f64::from(self.interventions);
        100.0 * (1.0 - helped / self.time.max(1e-9)).max(0.0)
    }
}

/// The referee of Free Drive. It sees the true pose of a car on a course and does not reveal it to the car.
///
/// ```
/// use roverlab::drive::traffic::{FreeDrive, FreeDriveRules};
/// use roverlab::world::RobotSpec;
/// use roverlab::world::formats::course;
/// let oval = course::parse("course 1\nstraight 6000\narc 1500 180\nstraight 6000\narc 1500 180\n", "oval")?;
/// let mut referee = FreeDrive::new(oval.clone(), &RobotSpec::road_car(), FreeDriveRules::default())?;
/// // Three metres at 1 m/s, first in the middle of the lane, then 30 cm beside it.
/// for step in 0..300 {
///     let along = 0.01 * f64::from(step);
///     referee.see(along, &oval.pose(along, if along < 2.0 { 0.0 } else { 0.3 }));
/// }
/// let score = referee.score();
/// assert_eq!(score.departures, 1);
/// assert!((score.survival - 2.0).abs() < 0.1, "seconds to the first departure");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct FreeDrive {
    course: RoadCourse,
    rules: FreeDriveRules,
    /// Points where the wheels touch the ground, and the centre, in the car's frame.
    wheels: [Point; 4],
    middle: Point,
    score: FreeDriveScore,
    lane: LanePose,
    /// Whether two wheels are outside, the time at which the car stopped, and whether it is under remote
    /// control.
    is_outside: bool,
    stands_since: Option<f64>,
    is_remote: bool,
}

/// Speed below which a car stands (m/s).
const STANDS: f64 = 0.02;

impl FreeDrive {
    /// Creates the referee of a car that starts at the beginning of a course.
    ///
    /// # Errors
    ///
    /// If a penalty is negative, or `astray` or `standing` is not above 0; infinity stands for never.
    pub fn new(course: RoadCourse, car: &RobotSpec, rules: FreeDriveRules) -> Result<Self, ParameterError> {
        rules.validate()?;
        let (length, track) = match car.drive {
            DriveSpec::Ackermann { wheelbase, track, .. } | DriveSpec::Omni { wheelbase, track, .. } => {
                (wheelbase, track)
            }
            DriveSpec::Tracked { length, track, .. } => (length, track),
            DriveSpec::Differential { track, .. } => (0.0, track),
            DriveSpec::Craft(_) => (0.0, 0.0),
        };
        let half = 0.5 * track;
        let wheels = [(0.0, half), (0.0, -half), (length, half), (length, -half)];
        let lane = course.locate(&course.start(), Some(0.0));
        Ok(Self {
            course,
            rules,
            wheels: wheels.map(|(x, y)| Point::new(x, y)),
            middle: Point::new(0.5 * length, 0.0),
            score: FreeDriveScore::default(),
            lane,
            is_outside: false,
            stands_since: None,
            is_remote: false,
        })
    }

    /// The same for a car that starts at a position along the course's line (m).
    #[must_use]
    pub fn starting_at(mut self, along: f64) -> Self {
        self.lane = self.course.locate(&self.course.pose(along, 0.0), Some(along));
        self
    }

    /// Record so far.
    pub fn score(&self) -> &FreeDriveScore {
        &self.score
    }

    /// Lane position of the car's centre.
    pub fn lane(&self) -> &LanePose {
        &self.lane
    }

    /// Whether the car is under remote control.
    pub fn is_remote(&self) -> bool {
        self.is_remote
    }

    /// Observes the car at a time (s). Returns whether it has to be taken over now.
    pub fn see(&mut self, time: f64, pose: &Pose) -> bool {
        let passed = time - self.score.time;
        self.score.time = time;
        let before = self.lane;
        self.lane = self.on_lane(pose, self.middle);
        let around = self.course.line.length();
        let metres = self.lane.along - before.along;
        // The shorter way around the course.
        let metres = metres - around * (metres / around).round();
        if self.is_remote {
            return false;
        }
        self.count(metres, pose);
        let stands = metres.abs() < STANDS * passed;
        let since = *self.stands_since.get_or_insert(time);
        if !stands {
            self.stands_since = None;
        }
        let is_astray = self.lane.offset.abs() > self.rules.astray * self.course.lane_width
            || self.lane.heading.abs() > 2.0;
        let is_over = is_astray || (stands && time - since > self.rules.standing);
        if is_over {
            self.score.interventions += 1;
            self.is_remote = true;
        }
        is_over
    }

    /// Returns control to the car.
    pub fn give_back(&mut self) {
        (self.is_remote, self.is_outside, self.stands_since) = (false, false, None);
    }

    fn count(&mut self, metres: f64, pose: &Pose) {
        let course = &self.course;
        let most = 0.5 * course.edge();
        let over = |wheel: &&Point| self.on_lane(pose, **wheel).offset.abs() > most;
        let is_outside = self.wheels.iter().filter(over).count() >= 2;
        let score = &mut self.score;
        score.distance += metres;
        score.squares += metres.max(0.0) * self.lane.offset * self.lane.offset;
        score.deviation += metres.max(0.0) * self.lane.offset.abs();
        if is_outside {
            score.outside += metres.max(0.0);
        }
        score.departures += u32::from(is_outside && !self.is_outside);
        if score.departures == 0 && score.interventions == 0 {
            score.survival = score.time;
        }
        self.is_outside = is_outside;
    }

    /// Lane position of a point of the car.
    fn on_lane(&self, car: &Pose, point: Point) -> LanePose {
        let place = car.to_world(point);
        self.course.locate(&Pose::new(place.x, place.y, car.heading), Some(self.lane.along))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::formats::course;

    fn referee() -> FreeDrive {
        let text = "course 1\nlane 400\nstraight 6000\narc 1500 180\nstraight 6000\narc 1500 180\n";
        let course = course::parse(text, "oval").unwrap();
        FreeDrive::new(course, &RobotSpec::road_car(), FreeDriveRules::default()).unwrap()
    }

    /// Drives along a lane at 1 m/s with given offsets.
    fn drive(referee: &mut FreeDrive, metres: f64, offset: impl Fn(f64) -> f64) -> Option<f64> {
        let course = referee.course.clone();
        (0..=(100.0 * metres) as u32).map(|i| 0.01 * f64::from(i)).find(|&time| {
            // The rear axle is behind the centre.
            let at = course.pose(time, offset(time));
            referee.see(time, &at)
        })
    }

    #[test]
    fn laps_in_the_middle_count_every_metre_and_no_fault() {
        let mut referee = referee();
        assert_eq!(drive(&mut referee, 50.0, |_| 0.0), None);
        let score = referee.score();
        assert!((score.distance - 50.0).abs() < 0.2, "{score:?}");
        assert_eq!((score.departures, score.interventions), (0, 0));
        assert_eq!(score.survival, score.time);
        assert!((score.autonomy(&FreeDriveRules::default()) - 100.0).abs() < 1e-9);
    }

    #[test]
    fn two_wheels_over_the_line_are_one_departure_until_they_are_back() {
        let mut referee = referee();
        // The right wheels are 82.5 mm to the right of the centre, and the line 210 mm.
        let offset = |time: f64| if (2.0..3.0).contains(&time) || time > 4.0 { -0.14 } else { 0.0 };
        assert_eq!(drive(&mut referee, 5.0, offset), None);
        let score = referee.score();
        assert_eq!(score.departures, 2);
        assert!((score.outside - 2.0).abs() < 0.05 && (score.survival - 1.99).abs() < 0.02, "{score:?}");
        let expected = score.distance - score.outside - 10.0;
        assert_eq!(score.result(&FreeDriveRules::default()), expected.max(0.0));
        let later = FreeDriveRules { subtract_outside: false, penalty: 0.0, ..FreeDriveRules::default() };
        assert_eq!(score.result(&later), score.distance);
    }

    #[test]
    fn a_car_that_strays_or_stands_is_taken_over_once() {
        let mut strays = referee();
        let taken = drive(&mut strays, 5.0, |time| -0.3 * time);
        assert!((taken.unwrap() - 1.34).abs() < 0.05, "{taken:?}");
        assert!(strays.is_remote() && !strays.see(9.0, &Pose::default()));
        let mut stands = referee();
        let pose = stands.course.pose(1.0, 0.0);
        let taken = (0..1000).map(|i| 0.01 * f64::from(i)).find(|&time| stands.see(time, &pose));
        assert!((taken.unwrap() - 5.0).abs() < 0.2, "{taken:?}");
        assert_eq!(stands.score().interventions, 1);
        let autonomy = stands.score().autonomy(&FreeDriveRules::default());
        assert_eq!(autonomy, 0.0, "6 s of help in 5 s");
    }
}
