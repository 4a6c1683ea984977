//! Observation of a car: the referee with the ground truth.

use std::ops::ControlFlow;

use roverlab::geometry::{Point, Pose};
use roverlab::io::control::{Command, Halt, Run, Senses, Verdict};
use roverlab::io::sim::{RobotTruth, TICK};
use roverlab::io::{self, Clock};
use roverlab::race::{EventReferee, RaceScore, Referee};

use super::course::Course;
use crate::common::StageTruth;

/// The referee of laps, or of another event.
enum Whistle {
    Laps(Referee),
    Event(EventReferee),
}

impl Whistle {
    fn new(course: &Course) -> Self {
        let Some(event) = &course.event else {
            return Self::Laps(Referee::new(course.corridor.clone(), Course::wheels()));
        };
        let nose = Point::new(Course::outline().nose, 0.0);
        Self::Event(EventReferee::new(event.clone(), Course::wheels(), nose))
    }

    fn verdict(&self) -> &RaceScore {
        match self {
            Self::Laps(referee) => referee.verdict(),
            Self::Event(referee) => referee.verdict(),
        }
    }

    fn see(&mut self, time: f64, pose: Pose, cones_hit: usize) {
        match self {
            Self::Laps(referee) => referee.see(time, pose, cones_hit),
            Self::Event(referee) => referee.see(time, pose, cones_hit),
        }
    }
}

/// Time, pose and speed of a car at the end of a pass.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passed {
    pub(crate) time: f64,
    pub(crate) pose: Pose,
    pub(crate) speed: f64,
}

/// Observes one car.
pub(crate) struct Judge {
    truth: StageTruth,
    index: usize,
    referee: Whistle,
    cones: Vec<Point>,
    /// Number of fallen cones at the last look.
    hits: usize,
    /// Ground truth at the last look, and its time.
    last: RobotTruth,
    time: f64,
    /// Pose and speed of the car at the end of every pass.
    trail: Vec<Passed>,
    /// Distance driven before the first cone or leaving the course (m).
    clean: Option<f64>,
}

impl Judge {
    /// A judge for a car of a course.
    pub(crate) fn new(course: &Course, mut truth: StageTruth, index: usize) -> io::Result<Self> {
        let last = truth.robot(index)?;
        Ok(Self {
            truth,
            index,
            referee: Whistle::new(course),
            cones: course.cones.iter().map(|cone| cone.position).collect(),
            hits: 0,
            last,
            time: 0.0,
            trail: Vec::new(),
            clean: None,
        })
    }

    /// The referee's score.
    pub(crate) fn verdict(&self) -> &RaceScore {
        self.referee.verdict()
    }

    /// Whether all times of an event were taken and the car is still within its lane; always `true` for laps.
    pub(crate) fn is_complete(&self) -> bool {
        match &self.referee {
            Whistle::Laps(_) => true,
            Whistle::Event(referee) => referee.is_complete(),
        }
    }

    /// Time since the beginning (s).
    pub(crate) fn time(&self) -> f64 {
        self.time
    }

    /// Ground truth at the last look.
    pub(crate) fn truth(&self) -> &RobotTruth {
        &self.last
    }

    /// Poses and speeds of the car.
    pub(crate) fn trail(&self) -> &[Passed] {
        &self.trail
    }

    /// Distance driven before the first cone or leaving the course, or in all (m).
    pub(crate) fn clean_metres(&self) -> f64 {
        self.clean.unwrap_or(self.last.path_length)
    }

    /// Whether the car has touched another one.
    pub(crate) fn touched(&self) -> bool {
        self.last.contact_places.iter().any(|place| !self.cones.contains(place))
    }

    /// Which cones are still standing.
    pub(crate) fn standing(&self) -> Vec<bool> {
        self.cones.iter().map(|cone| !self.last.contact_places.contains(cone)).collect()
    }

    /// Counts the cones among the contacts, if these have changed: usually they have not.
    fn count_hits(&mut self, contacts: &[Point]) {
        if contacts != self.last.contact_places {
            self.hits = contacts.iter().filter(|place| self.cones.contains(place)).count();
        }
    }

    /// Observes the car.
    pub(crate) fn look(&mut self) -> io::Result<()> {
        let now = self.truth.robot(self.index)?;
        self.count_hits(&now.contact_places);
        self.last = now;
        self.time = self.truth.time()?;
        self.referee.see(self.time, self.last.pose, self.hits);
        let verdict = self.referee.verdict();
        if self.clean.is_none() && verdict.cones_hit + verdict.off_course > 0 {
            self.clean = Some(self.last.path_length);
        }
        Ok(())
    }
}

/// Lets a behaviour drive a car; the judge observes every tick, and `watch` every decision.
pub(crate) fn judged<R, B, V>(
    car: &mut R,
    behaviour: &mut B,
    limit: f64,
    judge: &mut Judge,
    mut watch: impl FnMut(&mut R, &B, &Judge) -> V,
) -> io::Result<B::Outcome>
where
    R: Clock + ?Sized,
    B: Senses<R>,
    B::Command: Command<R>,
    V: Verdict,
{
    let mut run = Run::new(behaviour, limit)?;
    loop {
        if let ControlFlow::Break(outcome) = run.step(car, behaviour)? {
            return Ok(outcome);
        }
        let rested = run.rest(&mut Judged { car, judge });
        let ended = match rested.and_then(|()| watch(car, behaviour, judge).verdict()) {
            Ok(ControlFlow::Continue(())) => continue,
            Ok(ControlFlow::Break(())) => Ok(behaviour.halt(Halt::Stopped)),
            Err(error) => Err(error),
        };
        let stopped = B::Command::stop(car);
        return ended.and_then(|outcome| stopped.map(|()| outcome));
    }
}

/// A car whose waits are observed.
struct Judged<'a, R: ?Sized> {
    car: &'a mut R,
    judge: &'a mut Judge,
}

impl<R: Clock + ?Sized> Clock for Judged<'_, R> {
    fn now(&mut self) -> io::Result<f64> {
        self.car.now()
    }

    fn wait(&mut self, seconds: f64) -> io::Result<()> {
        pass(self.car, self.judge, seconds)
    }
}

/// Lets time pass in ticks, with an observation at each.
pub(crate) fn pass<R: Clock + ?Sized>(robot: &mut R, judge: &mut Judge, seconds: f64) -> io::Result<()> {
    let (time, metres) = (judge.time, judge.last.path_length);
    let ticks = (seconds / TICK).ceil().max(1.0);
    for _ in 0..ticks as usize {
        robot.wait(seconds / ticks)?;
        judge.look()?;
    }
    let speed = (judge.last.path_length - metres) / (judge.time - time).max(TICK);
    judge.trail.push(Passed { time: judge.time, pose: judge.last.pose, speed });
    Ok(())
}
