use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::call::{self, Call};
use super::recording::{Event, Kind};
use super::writer::{Nanoseconds, nanoseconds};
use super::{Log, LogError, Replay, ReplayTroop, ReplayTruth};

/// Plays a recording: hands out its robots, and what was true about them.
#[derive(Debug, Clone)]
pub struct Player {
    positions: Vec<Position>,
    log: Log,
}

impl Player {
    /// A player of a recording, at its beginning.
    pub fn new(log: &Log) -> Self {
        let positions = (0..log.robots()).map(|robot| Position::new(log, robot)).collect();
        Self { positions, log: log.clone() }
    }

    /// What is played.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// A robot, by its index.
    pub fn robot(&self, robot: usize) -> Result<Replay, LogError> {
        self.position(robot).map(Replay::at)
    }

    /// The robots of a recorded troop, which are stepped in one thread.
    pub fn troop<'a>(&self) -> ReplayTroop<'a> {
        ReplayTroop::new(self)
    }

    /// How far each robot has come.
    pub(super) fn positions(&self) -> impl Iterator<Item = Position> + '_ {
        self.positions.iter().cloned()
    }

    /// What was true while a robot drove, as somebody asked who watched it.
    pub fn truth(&self, robot: usize) -> Result<ReplayTruth, LogError> {
        self.position(robot).map(ReplayTruth::new)
    }

    /// Goes to a time of the recording, in seconds: the next call of each robot is its first one from then on.
    pub fn seek(&self, time: f64) {
        self.positions.iter().for_each(|position| position.seek(nanoseconds(time)));
    }

    /// The first recorded call, of the robot of the lowest index, that no program has made: its time in seconds, and
    /// the call. `None` when the recording has been played to its end.
    pub fn rest(&self) -> Option<(f64, String)> {
        self.positions.iter().find_map(Position::rest)
    }

    fn position(&self, robot: usize) -> Result<Position, LogError> {
        let no_robot = LogError::NoRobot { index: robot, robots: self.log.robots() };
        self.positions.get(robot).cloned().ok_or(no_robot)
    }
}

/// How far a robot's part of a recording has been played. The copies move together.
#[derive(Debug, Clone)]
pub(super) struct Position {
    log: Log,
    robot: usize,
    next: Arc<AtomicUsize>,
}

impl Position {
    pub(super) fn new(log: &Log, robot: usize) -> Self {
        Self { log: log.clone(), robot, next: Arc::default() }
    }

    pub(super) fn log(&self) -> &Log {
        &self.log
    }

    pub(super) fn event(&self, index: usize) -> Option<&Event> {
        self.log.event(self.robot, index)
    }

    /// The first event behind the calls made so far.
    pub(super) fn here(&self) -> usize {
        self.next.load(Ordering::Relaxed)
    }

    pub(super) fn move_to(&self, index: usize) {
        self.next.store(index, Ordering::Relaxed);
    }

    /// Goes to the first event from a time on.
    fn seek(&self, time: Nanoseconds) {
        let earlier = (0..).take_while(|&index| self.event(index).is_some_and(|event| event.time < time));
        self.move_to(earlier.count());
    }

    /// The next call, or the end of the recording.
    pub(super) fn next_call(&self) -> usize {
        let mut index = self.here();
        while self.event(index).is_some_and(|event| event.kind != Kind::Call) {
            index += 1;
        }
        index
    }

    fn rest(&self) -> Option<(f64, String)> {
        let event = self.event(self.next_call())?;
        let call = Call::read(self.log.data(event))?;
        Some((seconds(event.time), call::shown(call.method, &call.arguments)))
    }
}

/// Recorded time in seconds.
pub(super) fn seconds(time: Nanoseconds) -> f64 {
    time as f64 / 1e9
}
