use std::io::Write;
use std::ops::ControlFlow;

use super::call::{self, Call};
use super::player::Player;
use super::port::Port;
use super::position::Position;
use super::recording::Kind;
use super::stamp::{nanoseconds, seconds};
use super::truth::Notes;
use super::values::Values;
use super::{LogWriter, Recorder, Replay, ReplayTruth};
use crate::geometry::Pose;
use crate::io::fleet::no_robot;
use crate::io::{Error, ErrorKind, FleetIo, FleetStep, GroundTruth, Result, RobotIo, RobotTruth};

/// A recorded fleet, made by [`LogWriter::fleet`]. Each robot's calls are recorded as by a [`Recorder`],
/// along with the ends of the runs.
#[derive(Debug)]
pub struct RecordedFleet<T, W: Write> {
    inner: T,
    writer: LogWriter<W>,
    notes: Vec<Notes<W>>,
}

impl<W: Write> LogWriter<W> {
    /// Records robots stepped in one thread, under their own indices.
    pub fn fleet<'a, T: FleetIo<'a>>(&self, fleet: T) -> RecordedFleet<T, W> {
        RecordedFleet::new(fleet, self.clone())
    }
}

impl<T, W: Write> RecordedFleet<T, W> {
    pub(super) fn new<'a>(inner: T, writer: LogWriter<W>) -> Self
    where
        T: FleetIo<'a>,
    {
        let notes =
            (0..inner.robots()).map(|robot| Notes::new(Port::beside(writer.clone(), robot))).collect();
        Self { inner, writer, notes }
    }

    fn notes(&mut self, robot: usize) -> Result<&mut Notes<W>> {
        let robots = self.notes.len();
        self.notes.get_mut(robot).ok_or_else(|| no_robot(robot, robots))
    }
}

impl<'a, T: FleetIo<'a>, W: Write + 'a> FleetIo<'a> for RecordedFleet<T, W> {
    fn robots(&self) -> usize {
        self.inner.robots()
    }

    fn control(&mut self, robot: usize, period: f64, mut behaviour: FleetStep<'a>) -> Result<()> {
        self.notes(robot)?;
        let mut port = Some(self.writer.port(robot));
        let recorded = move |robot: &mut dyn RobotIo| {
            // A behaviour that has panicked is not called again.
            let Some(held) = port.take() else { return Ok(ControlFlow::Break(())) };
            let mut recorder = Recorder::new(robot, held);
            let flow = behaviour(&mut recorder);
            port = Some(recorder.into_port());
            flow
        };
        let result = self.inner.control(robot, period, Box::new(recorded));
        self.notes(robot)?.note(CONTROL, &period, &result);
        result
    }

    fn run_for(&mut self, seconds: f64) -> Result<()> {
        self.inner.run_for(seconds)?;
        let time = self.inner.time();
        // No later call has an earlier time.
        let now = time.as_ref().ok().copied().map(nanoseconds);
        for notes in &mut self.notes {
            notes.note_at(now, RUN, &seconds, &time);
        }
        Ok(())
    }

    fn time(&mut self) -> Result<f64> {
        self.inner.time()
    }

    fn pose(&mut self, robot: usize) -> Result<Pose> {
        let pose = self.inner.pose(robot);
        self.notes(robot)?.note("pose", &robot, &pose);
        pose
    }

    fn truth(&mut self, robot: usize) -> Result<RobotTruth> {
        let truth = self.inner.truth(robot);
        self.notes(robot)?.note_robot(robot, &truth);
        truth
    }
}

/// Recorded name of the call that assigns a behaviour to a robot.
const CONTROL: &str = "control";
/// Recorded name of the call that steps all behaviours.
const RUN: &str = "run_for";

/// A fleet replayed from a recording, made by [`Player::fleet`]. Each behaviour is stepped as often as in the
/// recorded run. Periods, durations and the robots' calls must match the recording, as with [`Replay`].
pub struct ReplayFleet<'a> {
    members: Vec<Member<'a>>,
    time: f64,
}

struct Member<'a> {
    robot: Replay,
    truth: ReplayTruth,
    orders: Orders,
    behaviour: Option<FleetStep<'a>>,
}

impl std::fmt::Debug for ReplayFleet<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ReplayFleet")
            .field("robots", &self.members.len())
            .field("time", &self.time)
            .finish_non_exhaustive()
    }
}

/// The recorded fleet calls of a robot, in order.
struct Orders {
    position: Position,
    /// The first event not yet examined.
    next: usize,
}

impl Orders {
    /// The next fleet call before the robot's next call, if any.
    fn next(&mut self) -> Option<Call<'_>> {
        let end = self.position.next_call();
        while self.next < end {
            self.next += 1;
            let event = self.position.event(self.next - 1).filter(|event| event.kind == Kind::Truth);
            let call = event.and_then(|event| Call::read(self.position.log().data(event)));
            if let Some(call) = call.filter(|call| matches!(call.method, CONTROL | RUN)) {
                return Some(call);
            }
        }
        None
    }

    /// Consumes a fleet call, which must be the next one. Returns its answer.
    fn take(&mut self, method: &str, argument: f64) -> Result<Option<Values>> {
        let Some(order) = self.next() else { return Ok(None) };
        let argument = Values::of(&argument);
        if order.method != method || order.arguments != argument {
            let found = call::shown(method, &argument);
            let expected = call::shown(order.method, &order.arguments);
            let message = format!("found {found}; expected {expected}, as recorded");
            return Err(Error::new(ErrorKind::Diverged, message));
        }
        order.result.map(Some).map_err(|failure| failure.error())
    }

    /// Index of the robot's next call, if any.
    fn next_call(&self) -> Option<usize> {
        Some(self.position.next_call()).filter(|&index| self.position.event(index).is_some())
    }
}

fn ended(what: &str) -> Error {
    Error::new(ErrorKind::EndOfLog, format!("the recording has ended before {what}"))
}

impl Player {
    /// The robots of a recorded fleet, stepped in one thread.
    pub fn fleet<'a>(&self) -> ReplayFleet<'a> {
        ReplayFleet::new(self)
    }
}

impl<'a> ReplayFleet<'a> {
    pub(super) fn new(player: &Player) -> Self {
        let member = |position: Position| Member {
            robot: Replay::at(position.clone()),
            truth: ReplayTruth::new(position.clone()),
            orders: Orders { position, next: 0 },
            behaviour: None,
        };
        Self { members: player.positions().map(member).collect(), time: 0.0 }
    }

    fn member(&mut self, robot: usize) -> Result<&mut Member<'a>> {
        let robots = self.members.len();
        self.members.get_mut(robot).ok_or_else(|| no_robot(robot, robots))
    }
}

impl Member<'_> {
    /// Steps the behaviour to the end of the recorded run and returns its time, or to the end of the
    /// recording.
    fn run_for(&mut self, seconds: f64) -> Result<Option<f64>> {
        loop {
            if let Some(time) = self.orders.take(RUN, seconds)? {
                return Ok(time.take());
            }
            let Some(before) = self.orders.next_call() else { return Ok(None) };
            let flow = match &mut self.behaviour {
                Some(behaviour) => behaviour(&mut self.robot)?,
                None => return Err(self.unasked("a robot without a behaviour")),
            };
            if self.orders.next_call() == Some(before) {
                return Err(self.unasked("a step without a call"));
            }
            if flow.is_break() {
                self.behaviour = None;
            }
        }
    }

    /// The error of a robot that omits its next recorded call.
    fn unasked(&self, found: &str) -> Error {
        let position = &self.orders.position;
        let call = position.event(position.next_call());
        let expected = call.and_then(|event| {
            let call = Call::read(position.log().data(event))?;
            Some(format!("{} at {} s", call::shown(call.method, &call.arguments), seconds(event.time)))
        });
        let expected = expected.unwrap_or_else(|| "the end".into());
        Error::new(ErrorKind::Diverged, format!("found {found}; expected {expected}, as recorded"))
    }
}

impl<'a> FleetIo<'a> for ReplayFleet<'a> {
    fn robots(&self) -> usize {
        self.members.len()
    }

    fn control(&mut self, robot: usize, period: f64, behaviour: FleetStep<'a>) -> Result<()> {
        let member = self.member(robot)?;
        member.orders.take(CONTROL, period)?.ok_or_else(|| ended("the behaviours were given"))?;
        member.behaviour = Some(behaviour);
        Ok(())
    }

    fn run_for(&mut self, seconds: f64) -> Result<()> {
        let mut first = None;
        let mut whole = true;
        for member in &mut self.members {
            match member.run_for(seconds) {
                Ok(Some(time)) => self.time = time,
                Ok(None) => whole = false,
                // An error ended the recorded run: the other robots continue as far as they did then.
                Err(error) => first = first.or(Some(error)),
            }
        }
        match first {
            Some(error) => Err(error),
            None if whole => Ok(()),
            None => Err(ended("the run did")),
        }
    }

    fn time(&mut self) -> Result<f64> {
        Ok(self.time)
    }

    fn pose(&mut self, robot: usize) -> Result<Pose> {
        self.member(robot)?.truth.pose(robot)
    }

    fn truth(&mut self, robot: usize) -> Result<RobotTruth> {
        self.member(robot)?.truth.robot(robot)
    }
}
