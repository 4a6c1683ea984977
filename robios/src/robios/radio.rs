use std::collections::VecDeque;

use roverlab::io::{RadioMessage, Result};

use super::{Robios, invalid};
use crate::ask::{Reply, Request};

/// Maximum length of a message (bytes), as in EyeSim.
const LONGEST: usize = 100;

/// Messages examined but not received.
pub(crate) type Inbox = VecDeque<RadioMessage>;

impl Robios {
    /// `RADIOSend`: to a robot by its number, or to all others with 0.
    pub fn radio_send(&mut self, to: i32, data: &[u8]) -> Result<()> {
        if data.is_empty() || data.len() > LONGEST {
            return Err(invalid("radio message", format!("{} bytes long", data.len()), "1 to 100 bytes"));
        }
        let to = u32::try_from(to).map_err(|_| invalid("radio receiver", to, "0 or more"))?;
        if to > 0 {
            let numbers = self.robot_numbers()?;
            if !numbers.contains(&to) && to as usize > numbers.len() {
                return Err(invalid("radio receiver", to, &format!("0, or one of {numbers:?}")));
            }
            return self.order(&Request::Send(to, data.to_vec()));
        }
        let own = self.identity.id;
        for id in self.robot_numbers()?.into_iter().filter(|&id| id != own) {
            self.order(&Request::Send(id, data.to_vec()))?;
        }
        Ok(())
    }

    /// Numbers of all robots in the order of their placement.
    pub fn robot_numbers(&mut self) -> Result<Vec<u32>> {
        if self.numbers.is_empty() {
            let Reply::Numbers(numbers) = self.ask_now(&Request::Numbers)? else {
                return Err(super::foreign());
            };
            self.numbers = numbers;
        }
        Ok(self.numbers.clone())
    }

    /// `RADIOReceive`: the oldest unread message; waits for at most `seconds`, and is called again until
    /// there is one.
    pub fn radio_receive(&mut self, seconds: f64) -> Result<Option<RadioMessage>> {
        let now = self.now();
        self.report.listening_since.get_or_insert(now);
        let received = self.next_message(seconds);
        if !matches!(&received, Ok(None) | Err(_)) {
            self.report.listening_since = None;
            self.finish_frame()?;
        }
        received
    }

    fn next_message(&mut self, seconds: f64) -> Result<Option<RadioMessage>> {
        if let Some(message) = self.inbox.pop_front() {
            self.charge()?;
            return Ok(Some(message));
        }
        match self.ask(&Request::Receive(seconds))? {
            Reply::Message(message) => Ok(message),
            _ => Err(super::foreign()),
        }
    }

    /// `RADIOCheck`: sender of the oldest message, if any.
    pub fn radio_check(&mut self) -> Result<Option<u32>> {
        if self.inbox.is_empty()
            && let Some(message) = self.next_message(0.0)?
        {
            self.inbox.push_back(message);
        }
        Ok(self.inbox.front().map(|message| message.from))
    }
}
