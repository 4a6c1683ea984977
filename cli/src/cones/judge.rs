//! Who watches a car: the referee, with what is true about it.

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

/// When a car was where, and how fast, at the end of a pass.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passed {
    pub(crate) time: f64,
    pub(crate) pose: Pose,
    pub(crate) speed: f64,
}

/// Watches one car.
pub(crate) struct Judge {
    truth: StageTruth,
    index: usize,
    referee: Whistle,
    cones: Vec<Point>,
    /// How many cones have fallen, of the contacts at the last look.
    hits: usize,
    /// What was true when it looked last, and when that was.
    last: RobotTruth,
    time: f64,
    /// Where the car was, and how fast, at the end of every pass.
    trail: Vec<Passed>,
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
            referee: Whistle::new(course),
            cones: course.cones.iter().map(|cone| cone.position).collect(),
            hits: 0,
            last,
            time: 0.0,
            trail: Vec::new(),
            clean: None,
        })
    }

    /// What the referee has seen.
    pub(crate) fn verdict(&self) -> &RaceScore {
        self.referee.verdict()
    }

    /// Whether all times of an event were taken and the car is within its lane still; always for laps.
    pub(crate) fn is_complete(&self) -> bool {
        match &self.referee {
            Whistle::Laps(_) => true,
            Whistle::Event(referee) => referee.is_complete(),
        }
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
    pub(crate) fn trail(&self) -> &[Passed] {
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

    /// Counts the cones among the contacts, if there are others than at the last look: most looks see none.
    fn count_hits(&mut self, contacts: &[Point]) {
        if contacts != self.last.contact_places {
            self.hits = contacts.iter().filter(|place| self.cones.contains(place)).count();
        }
    }

    /// Looks at the car.
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

/// Lets a behaviour drive a car, while the judge looks at every tick and `watch` at every decision.
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
        let passed = pass(car, judge, behaviour.period());
        let ended = match passed.and_then(|()| watch(car, behaviour, judge).verdict()) {
            Ok(ControlFlow::Continue(())) => continue,
            Ok(ControlFlow::Break(())) => Ok(behaviour.halt(Halt::Stopped)),
            Err(error) => Err(error),
        };
        let stopped = B::Command::stop(car);
        return ended.and_then(|outcome| stopped.map(|()| outcome));
    }
}

/// Lets time pass in ticks, at each of which the judge looks.
pub(crate) fn pass<R: Clock + ?Sized>(robot: &mut R, judge: &mut Judge, seconds: f64) -> io::Result<()> {
    let (time, metres) = (judge.time, judge.last.path_length);
    for _ in 0..(seconds / TICK).round().max(1.0) as usize {
        robot.wait(TICK)?;
        judge.look()?;
    }
    let speed = (judge.last.path_length - metres) / (judge.time - time).max(TICK);
    judge.trail.push(Passed { time: judge.time, pose: judge.last.pose, speed });
    Ok(())
}
