use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::Log;
use super::call::{self, Call};
use super::recording::{Event, Kind};
use super::stamp::{Nanoseconds, seconds};

/// Replay position of a robot's part of a recording, shared by all its copies.
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

    /// The first event after the calls made so far.
    pub(super) fn here(&self) -> usize {
        self.next.load(Ordering::Relaxed)
    }

    pub(super) fn move_to(&self, index: usize) {
        self.next.store(index, Ordering::Relaxed);
    }

    /// Moves to the first event at or after a time.
    pub(super) fn seek(&self, time: Nanoseconds) {
        let earlier = (0..).take_while(|&index| self.event(index).is_some_and(|event| event.time < time));
        self.move_to(earlier.count());
    }

    /// Index of the next call, or the end of the recording.
    pub(super) fn next_call(&self) -> usize {
        let mut index = self.here();
        while self.event(index).is_some_and(|event| event.kind != Kind::Call) {
            index += 1;
        }
        index
    }

    pub(super) fn rest(&self) -> Option<(f64, String)> {
        let event = self.event(self.next_call())?;
        let call = Call::read(self.log.data(event))?;
        Some((seconds(event.time), call::shown(call.method, &call.arguments)))
    }
}
