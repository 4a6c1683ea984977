use super::answer::Answers;
use super::call::{self, Call};
use super::player::Player;
use super::position::Position;
use super::recording::Kind;
use super::stamp::seconds;
use super::values::Values;
use super::{Log, LogError};
use crate::io::{Clock, Error, ErrorKind, Result};

/// A robot that answers from a recording.
///
/// A program must make the same calls in the same order, with arguments equal to the bit. The first deviation
/// is an error of the kind [`Diverged`](ErrorKind::Diverged) that names the time, the call and what was
/// expected; every later call fails alike. A call after the end of the recording fails with
/// [`EndOfLog`](ErrorKind::EndOfLog).
#[derive(Debug, Clone)]
pub struct Replay {
    position: Position,
    /// The first deviation.
    difference: Option<String>,
}

impl Player {
    /// A robot, by its index. Fails if the recording has no such robot.
    pub fn robot(&self, robot: usize) -> std::result::Result<Replay, LogError> {
        self.position(robot).map(Replay::at)
    }
}

impl Replay {
    /// Creates a robot from a recording, by its index. Fails if the recording has no such robot.
    pub fn new(log: &Log, robot: usize) -> std::result::Result<Self, LogError> {
        Player::new(log).robot(robot)
    }

    pub(super) fn at(position: Position) -> Self {
        Self { position, difference: None }
    }

    fn diverge(&mut self, difference: String) -> Error {
        let error = Error::new(ErrorKind::Diverged, &difference);
        self.difference = Some(difference);
        error
    }
}

impl Answers for Replay {
    fn answer<T>(
        &mut self,
        method: &str,
        arguments: &Values,
        take: impl FnOnce(&Values, &[u8]) -> Option<T>,
    ) -> Result<T> {
        if let Some(difference) = &self.difference {
            return Err(Error::new(ErrorKind::Diverged, difference));
        }
        let (here, index) = (self.position.here(), self.position.next_call());
        let position = self.position.clone();
        let Some(event) = position.event(index) else {
            let call = call::shown(method, arguments);
            return Err(Error::new(
                ErrorKind::EndOfLog,
                format!("the recording has ended before the call {call}"),
            ));
        };
        let time = seconds(event.time);
        let recorded = Call::read(position.log().data(event)).ok_or_else(|| unreadable(time))?;
        if recorded.method != method || recorded.arguments != *arguments {
            let found = call::shown(method, arguments);
            let expected = call::shown(recorded.method, &recorded.arguments);
            return Err(self
                .diverge(format!("at {time} s: found the call {found}; expected {expected}, as recorded")));
        }
        position.move_to(index + 1);
        let bulk =
            (here..index).filter_map(|index| position.event(index)).rfind(|event| event.kind == Kind::Bulk);
        match recorded.result {
            Ok(result) => take(&result, bulk.map_or(&[], |bulk| position.log().data(bulk)))
                .ok_or_else(|| unreadable(time)),
            Err(failure) => Err(failure.error()),
        }
    }
}

fn unreadable(time: f64) -> Error {
    Error::new(ErrorKind::Other, format!("at {time} s: the recording holds no readable answer"))
}

impl Clock for Replay {
    fn now(&mut self) -> Result<f64> {
        self.answer("now", &Values::default(), |result, _| result.take())
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.answer("wait", &Values::of(&seconds), |result, _| result.take())
    }

    fn peek_time(&mut self) -> Result<f64> {
        let next = self.position.event(self.position.next_call());
        next.map(|event| seconds(event.time))
            .ok_or_else(|| Error::new(ErrorKind::EndOfLog, "the recording has ended"))
    }
}
