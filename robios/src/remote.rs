//! Connection of a program's library to a world in another process, through shared memory.

use std::sync::Arc;

use roverlab::io::{Error, ErrorKind, Result};

use crate::ask::{Reply, Request};
use crate::link::{Link, Truth};
use crate::memory::Memory;
use crate::wire::{Answer, Question};

/// A world in another process.
#[derive(Debug)]
pub struct Remote {
    memory: Arc<Memory>,
    now: f64,
}

impl Remote {
    /// Connects to the world through shared memory.
    pub fn new(memory: Arc<Memory>) -> Self {
        Self { memory, now: 0.0 }
    }
}

impl Drop for Remote {
    fn drop(&mut self) {
        self.memory.leave();
    }
}

impl Link for Remote {
    fn ask(&mut self, debt: f64, wanted: &[Request], request: &Request) -> Result<(Reply, Vec<Reply>)> {
        let question = Question { debt, wanted: wanted.to_vec(), request: request.clone() };
        let answer = Answer::decode(&self.memory.ask(&question.encode()));
        let answer =
            answer.ok_or_else(|| Error::new(ErrorKind::Disconnected, "the world's answer makes no sense"))?;
        self.now = answer.now;
        Ok((answer.reply?, answer.readings))
    }

    fn now(&mut self) -> f64 {
        self.now
    }

    fn truth(&mut self) -> Option<Truth> {
        None
    }
}
