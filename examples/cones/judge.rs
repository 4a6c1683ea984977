//! Who watches a car: the referee, with what is true about it.

use roverlab::drive::cones::{Referee, Verdict};
use roverlab::geometry::{Point, Pose};
use roverlab::io::sim::{RobotTruth, TICK};
use roverlab::io::{self, Clock};

use super::course::Course;
use crate::common::StageTruth;

/// Watches one car.
pub(crate) struct Judge {
    truth: StageTruth,
    index: usize,
    referee: Referee,
    cones: Vec<Point>,
    /// What was true when it looked last, and when that was.
    last: RobotTruth,
    time: f64,
    /// Where the car was, and how fast, at the end of every pass.
    trail: Vec<(Pose, f64)>,
    /// Metres to the first cone or off the course.
    clean: Option<f64>,
}

impl Judge {
    /// A judge for a car of a course.
    pub(crate) fn new(course: &Course, mut truth: StageTruth, index: usize) -> io::Result<Self> {
        let last = truth.robot(index)?;
        Ok(Self {
            truth,
            index,
            referee: Referee::new(course.corridor.clone(), Course::wheels()),
            cones: course.cones.iter().map(|cone| cone.position).collect(),
            last,
            time: 0.0,
            trail: Vec::new(),
            clean: None,
        })
    }

    /// What the referee has seen.
    pub(crate) fn verdict(&self) -> &Verdict {
        self.referee.verdict()
    }

    /// Seconds since the beginning.
    pub(crate) fn time(&self) -> f64 {
        self.time
    }

    /// What was true when it looked last.
    pub(crate) fn truth(&self) -> &RobotTruth {
        &self.last
    }

    /// Where the car was and how fast.
    pub(crate) fn trail(&self) -> &[(Pose, f64)] {
        &self.trail
    }

    /// Metres to the first cone or off the course, or to the end.
    pub(crate) fn clean_metres(&self) -> f64 {
        self.clean.unwrap_or(self.last.path_length)
    }

    /// Whether the car has touched another one.
    pub(crate) fn touched(&self) -> bool {
        self.last.contact_places.iter().any(|place| !self.cones.contains(place))
    }

    /// Which cones the car has left standing.
    pub(crate) fn standing(&self) -> Vec<bool> {
        self.cones.iter().map(|cone| !self.last.contact_places.contains(cone)).collect()
    }

    fn hits(&self) -> usize {
        self.last.contact_places.iter().filter(|place| self.cones.contains(place)).count()
    }

    fn look(&mut self) -> io::Result<()> {
        self.last = self.truth.robot(self.index)?;
        self.time = self.truth.time()?;
        self.referee.see(self.time, self.last.pose, self.hits());
        let verdict = self.referee.verdict();
        if self.clean.is_none() && verdict.cones_hit + verdict.off_course > 0 {
            self.clean = Some(self.last.path_length);
        }
        Ok(())
    }
}

/// Lets time pass in ticks, at each of which the judges look.
pub(crate) fn pass<R: Clock + ?Sized>(
    robot: &mut R,
    judges: &mut [&mut Judge],
    seconds: f64,
) -> io::Result<()> {
    let before: Vec<(f64, f64)> = judges.iter().map(|judge| (judge.time, judge.last.path_length)).collect();
    for _ in 0..(seconds / TICK).round().max(1.0) as usize {
        robot.wait(TICK)?;
        for judge in judges.iter_mut() {
            judge.look()?;
        }
    }
    for (judge, (time, metres)) in judges.iter_mut().zip(before) {
        let speed = (judge.last.path_length - metres) / (judge.time - time).max(TICK);
        judge.trail.push((judge.last.pose, speed));
    }
    Ok(())
}
