//! Radio messages between the robots of a world.

use crate::io::sim::machine::Machine;
use crate::io::{Error, RadioMessage, Result};
use crate::random::Stream;

/// The messages of a tick, until they are delivered.
#[derive(Debug)]
pub(super) struct Radio {
    outbox: Vec<Letter>,
    /// Probability that a message is lost, and the draws.
    loss: f64,
    losses: Stream,
}

/// A radio message in transit.
#[derive(Debug)]
struct Letter {
    from: u32,
    to: u32,
    data: Vec<u8>,
}

/// Longest radio message (bytes).
const MAX_MESSAGE: usize = 65_536;
/// Largest number of messages waiting for a robot; older ones are dropped.
const MAX_MAILBOX: usize = 10_000;

impl Radio {
    pub(super) fn new(loss: f64, losses: Stream) -> Self {
        Self { outbox: Vec::new(), loss, losses }
    }

    /// Takes a message from one of `robots` robots, by its index, to another, by its number.
    pub(super) fn send(&mut self, index: usize, to: u32, data: &[u8], robots: usize) -> Result<()> {
        if to == 0 || to as usize > robots {
            return Err(Error::invalid_input("radio receiver", to, &format!("1 to {robots}")));
        }
        if data.len() > MAX_MESSAGE {
            return Err(Error::invalid_input("radio message length", data.len(), "at most 65536 bytes"));
        }
        self.outbox.push(Letter { from: index as u32 + 1, to, data: data.to_vec() });
        Ok(())
    }

    /// Delivers the messages of this tick to the mailboxes, in an order independent of thread scheduling.
    pub(super) fn deliver(&mut self, machines: &mut [Machine]) {
        if self.outbox.is_empty() {
            return;
        }
        self.outbox.sort_by_key(|letter| letter.from);
        let (loss, losses) = (self.loss, &mut self.losses);
        for letter in self.outbox.drain(..).filter(|_| loss == 0.0 || !losses.chance(loss)) {
            let mailbox = &mut machines[letter.to as usize - 1].mailbox;
            if mailbox.len() == MAX_MAILBOX {
                mailbox.pop_front();
            }
            mailbox.push_back(RadioMessage { from: letter.from, data: letter.data });
        }
    }
}
