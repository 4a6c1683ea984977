//! Duration of calls in robot time, and the time at which their requests reach the world.
//!
//! With [`Costs::Frames`], requests wait in a queue of which each frame serves one, in the order of the
//! calls. A query lets time pass until its frame. A one-way request is kept until time reaches its frame; as
//! only this program's calls let time pass, that is early enough.

use std::collections::VecDeque;

use roverlab::io::sim::TICK;
use roverlab::io::{ErrorKind, Result};

use super::{NANOSECONDS, Robios, foreign};
use crate::ask::{MOST_READINGS, Reply, Request};
use crate::costs::{Cost, Costs, Kind};

/// Queue of a robot's requests.
#[derive(Debug)]
pub(super) struct Queue {
    costs: Costs,
    /// Cost of the current call, until it is charged.
    due: Option<Cost>,
    /// The first free frame.
    free: u64,
    /// Service time reserved for the current call (ns).
    reserved: Option<u64>,
    /// Service time since the start (ns), name of the call, and request of each entry.
    orders: VecDeque<(u64, &'static str, Request)>,
}

/// Maximum number of waiting requests; a further call blocks, as with the buffers of a connection.
const MOST_ORDERS: usize = 10_000;
const TICK_NANOSECONDS: u64 = (TICK * NANOSECONDS) as u64;
/// Duration of a call with [`Costs::Free`] (ns).
const FREE_CALL: u64 = 100_000;

impl Queue {
    pub(super) fn new(costs: Costs) -> Self {
        Self { costs, due: None, free: 0, reserved: None, orders: VecDeque::new() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.orders.is_empty()
    }

    /// The next request whose frame has come.
    fn next_before(&mut self, now: u64) -> Option<(u64, &'static str, Request)> {
        let is_due = self.orders.front().is_some_and(|order| order.0 <= now);
        if is_due { self.orders.pop_front() } else { None }
    }

    /// Service time of a request that arrives at a time.
    fn slot(&mut self, now: u64) -> u64 {
        if let Some(reserved) = self.reserved.take() {
            return reserved.max(now);
        }
        let Costs::Frames(frames) = &self.costs else { return now };
        let frame = frames.after(now).max(self.free);
        self.free = frame + 1;
        frames.time(frame)
    }
}

/// Cached readings of the current tick, valid until the next one or the next command.
#[derive(Debug, Default)]
pub(super) struct Recent {
    tick: u64,
    readings: Vec<(Request, Reply)>,
    /// Readings since the last request, which are likely to be repeated.
    used: Vec<Request>,
}

impl Robios {
    /// Starts a RoBIOS call; one without a name takes no time.
    pub(crate) fn begin(&mut self, call: &'static str) {
        self.call = call;
        self.queue.reserved = None;
        self.queue.due = match &self.queue.costs {
            Costs::Frames(frames) if !call.is_empty() => Some(frames.of(call)),
            _ => None,
        };
    }

    /// Reserves the next free frame if a call is a query, and returns its time since the start (ns): a thread
    /// waits for it while others run.
    pub(crate) fn reserve(&mut self, call: &str) -> Option<u64> {
        let now = self.clock();
        match &self.queue.costs {
            Costs::Frames(frames) if frames.of(call).kind == Kind::Query => Some(self.queue.slot(now)),
            _ => None,
        }
    }

    /// Lets the current call have a frame that was reserved for it.
    pub(crate) fn use_reserved(&mut self, slot: Option<u64>) {
        self.queue.reserved = slot;
    }

    /// Charges the program's computing time since its last call.
    pub(crate) fn charge_computing(&mut self, seconds: f64) {
        self.debt += (seconds * NANOSECONDS).round() as u64;
    }

    /// Time since the start (ns).
    fn clock(&mut self) -> u64 {
        self.link_clock() + self.debt
    }

    fn link_clock(&mut self) -> u64 {
        (self.link.now() * NANOSECONDS).round() as u64
    }

    /// Sets the program's time, which is never before the world's.
    fn set_clock(&mut self, time: u64) {
        self.debt = time.saturating_sub(self.link_clock());
    }

    /// Sends a request to the world, in the robot's turn.
    pub(super) fn ask(&mut self, request: &Request) -> Result<Reply> {
        match self.queue.due.take() {
            None => {}
            Some(Cost { kind: Kind::Local, nanoseconds, .. }) => self.debt += nanoseconds,
            Some(Cost { nanoseconds, .. }) => {
                self.wait_for_turn();
                let reply = self.ask_now(request);
                self.debt += nanoseconds;
                return reply;
            }
        }
        self.ask_now(request)
    }

    fn wait_for_turn(&mut self) {
        let now = self.clock();
        let slot = self.queue.slot(now);
        self.set_clock(slot);
    }

    /// Sends a request to the world out of turn.
    pub(super) fn ask_now(&mut self, request: &Request) -> Result<Reply> {
        self.deliver()?;
        let begin = self.clock();
        let lasts = self.lasts(request);
        let known = if lasts { self.recall(request) } else { None };
        let reply = if let Some(reply) = known {
            Ok(reply)
        } else {
            let debt = std::mem::take(&mut self.debt);
            self.ask_link(debt, request)
        };
        if !self.has_frames() && self.clock() > begin {
            // A failing call takes its time too, if it reached the robot; where this one is, it need not be
            // asked.
            self.debt += FREE_CALL - self.call_in_world();
        }
        let reply = reply?;
        let used = &mut self.recent.used;
        if lasts && request.is_brief() && used.len() < MOST_READINGS && !used.contains(request) {
            used.push(request.clone());
        }
        self.settle()?;
        Ok(reply)
    }

    /// Duration of a call in the simulator (ns), charged there with every request.
    fn call_in_world(&self) -> u64 {
        (self.identity.call_duration * NANOSECONDS).round() as u64
    }

    /// A cached reading of this tick.
    fn recall(&mut self, request: &Request) -> Option<Reply> {
        let tick = self.clock() / TICK_NANOSECONDS;
        let known = self.recent.readings.iter().filter(|_| self.recent.tick == tick);
        let reply = known.clone().find(|(known, _)| known == request).map(|(_, reply)| reply.clone());
        if reply.is_some() {
            self.debt += self.call_in_world();
        }
        reply
    }

    /// Lets a time pass (ns) and sends a request to the world, bypassing the cache.
    fn ask_link(&mut self, debt: u64, request: &Request) -> Result<Reply> {
        let worthwhile = self.identity.exact && !self.has_frames();
        let wanted = if worthwhile { std::mem::take(&mut self.recent.used) } else { Vec::new() };
        let (reply, readings) = self.link.ask(debt as f64 / NANOSECONDS, &wanted, request)?;
        let end = self.link_clock().saturating_sub(self.call_in_world());
        let tick = end / TICK_NANOSECONDS;
        let lasts = self.lasts(request);
        if !lasts || self.recent.tick != tick {
            self.recent.readings.clear();
        }
        self.recent.tick = tick;
        let known = wanted.into_iter().zip(readings);
        self.recent.readings.extend(known.filter(|(known, _)| known != request));
        if lasts {
            self.recent.readings.push((request.clone(), reply.clone()));
        }
        Ok(reply)
    }

    /// Whether a reading changes only with the tick or a command.
    fn lasts(&self, request: &Request) -> bool {
        match request {
            Request::Speed
            | Request::Pose
            | Request::Remaining
            | Request::IsDone
            | Request::IsStalled
            | Request::Distance(_)
            | Request::Scan
            | Request::Encoder(_) => self.identity.exact,
            _ => false,
        }
    }

    /// Sends a command to the world, in the robot's turn.
    pub(super) fn order(&mut self, request: &Request) -> Result<()> {
        let slot = match self.queue.due {
            Some(Cost { kind: Kind::OneWay, nanoseconds, .. }) => {
                self.queue.due = None;
                let now = self.clock();
                self.debt += nanoseconds;
                Some(self.queue.slot(now))
            }
            Some(_) => None,
            // A further command of a call whose first one waits.
            None => self.queue.orders.back().map(|order| order.0),
        };
        let Some(slot) = slot else {
            let reply = self.ask(request)?;
            return self.accept(reply);
        };
        self.queue.orders.push_back((slot, self.call, request.clone()));
        if self.queue.orders.len() > MOST_ORDERS {
            let first = self.queue.orders[0].0;
            let now = self.clock();
            self.set_clock(first.max(now));
        }
        self.settle()
    }

    /// Takes the reply to a command.
    fn accept(&mut self, reply: Reply) -> Result<()> {
        match reply {
            Reply::Done => Ok(()),
            Reply::Misplaced(place) => {
                self.note(&place);
                Ok(())
            }
            _ => Err(foreign()),
        }
    }

    /// Sends the due commands to the world.
    fn deliver(&mut self) -> Result<()> {
        if self.queue.is_empty() {
            return Ok(());
        }
        let now = self.clock();
        while let Some((slot, call, request)) = self.queue.next_before(now) {
            let wait = slot.saturating_sub(self.link_clock());
            match self.ask_link(wait, &request) {
                // The program has moved on and is not informed.
                Err(error) if matches!(error.kind(), ErrorKind::Unsupported | ErrorKind::InvalidInput) => {
                    self.note_of(call, &error.to_string());
                }
                Ok(Reply::Misplaced(place)) => self.note_of(call, &place),
                answer => drop(answer?),
            }
            self.set_clock(now);
        }
        Ok(())
    }

    /// Sends all commands to the world, and lets the necessary time pass.
    pub(crate) fn deliver_all(&mut self) -> Result<()> {
        if let Some(&(last, ..)) = self.queue.orders.back() {
            let now = self.clock();
            self.set_clock(last.max(now));
        }
        self.deliver()
    }

    /// Charges a local call.
    pub fn charge(&mut self) -> Result<()> {
        match (&self.queue.costs, self.queue.due.take()) {
            (Costs::Free, _) => self.debt += FREE_CALL,
            (_, None) => {}
            (_, Some(Cost { kind: Kind::Query, nanoseconds, .. })) => {
                self.wait_for_turn();
                self.debt += nanoseconds;
            }
            (_, Some(Cost { kind, nanoseconds, .. })) => {
                if kind == Kind::OneWay {
                    let now = self.clock();
                    self.queue.slot(now);
                }
                self.debt += nanoseconds;
            }
        }
        self.settle()
    }

    /// Like [`charge`](Robios::charge), for a call with an image.
    pub(super) fn charge_image(&mut self, pixels: usize) -> Result<()> {
        if let Some(cost) = self.queue.due.as_mut().filter(|cost| cost.per_pixel) {
            cost.nanoseconds *= pixels as u64;
        }
        self.charge()
    }

    /// Lets the world catch up with the program once it lags by a tick.
    fn settle(&mut self) -> Result<()> {
        if self.debt < TICK_NANOSECONDS && self.now() < self.identity.time_limit {
            return Ok(());
        }
        self.catch_up()
    }

    fn catch_up(&mut self) -> Result<()> {
        self.deliver()?;
        // The request itself is a call.
        let rest = std::mem::take(&mut self.debt).saturating_sub(self.call_in_world());
        self.ask_link(0, &Request::Pass(rest as f64 / NANOSECONDS)).map(|_| ())
    }

    /// Lets a time (s) and the duration of the call pass.
    pub fn pass(&mut self, seconds: f64) -> Result<()> {
        let seconds = seconds.max(0.0);
        match self.queue.costs {
            Costs::Free => self.ask_now(&Request::Pass(seconds)).map(|_| ()),
            Costs::Frames(_) => {
                // The call is the wait.
                self.queue.due = None;
                self.debt += (seconds * NANOSECONDS).round() as u64;
                self.catch_up()
            }
        }
    }

    /// Lets time pass until the frame that reports an event.
    pub(super) fn finish_frame(&mut self) -> Result<()> {
        let now = self.clock();
        if let Costs::Frames(frames) = &self.queue.costs {
            let end = frames.time(frames.after(now));
            self.set_clock(end);
        }
        self.settle()
    }

    /// Whether calls cost as much as on EyeSim.
    pub(super) fn has_frames(&self) -> bool {
        matches!(self.queue.costs, Costs::Frames(_))
    }
}
