//! What calls take of the robot's time, and when the world hears of them.
//!
//! With [`Costs::Frames`], requests wait in a queue of which each frame serves one, in the order of the
//! calls. A query lets the time until its frame pass. An order that needs no answer is kept until time has
//! come to its frame; as nothing but this program's own calls lets time pass, that is early enough.

use std::collections::VecDeque;

use roverlab::io::sim::TICK;
use roverlab::io::{ErrorKind, Result};

use super::{NANOSECONDS, Robios, foreign};
use crate::ask::{MOST_READINGS, Reply, Request};
use crate::costs::{Cost, Costs, Kind};

/// The queue of a robot's requests.
#[derive(Debug)]
pub(super) struct Queue {
    costs: Costs,
    /// What the running call takes, until it has been paid.
    due: Option<Cost>,
    /// The first frame that is free.
    free: u64,
    /// When they are served, in nanoseconds since the start, which call gave them, and what they are.
    orders: VecDeque<(u64, &'static str, Request)>,
}

/// Orders that may wait; whoever gives more waits himself, as the buffers of a connection hold about so many.
const MOST_ORDERS: usize = 10_000;
const TICK_NANOSECONDS: u64 = (TICK * NANOSECONDS) as u64;
/// Nanoseconds of a call with [`Costs::Free`].
const FREE_CALL: u64 = 100_000;

impl Queue {
    pub(super) fn new(costs: Costs) -> Self {
        Self { costs, due: None, free: 0, orders: VecDeque::new() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.orders.is_empty()
    }

    /// The next order whose frame has come.
    fn next_before(&mut self, now: u64) -> Option<(u64, &'static str, Request)> {
        let is_due = self.orders.front().is_some_and(|order| order.0 <= now);
        if is_due { self.orders.pop_front() } else { None }
    }

    /// When a request is served that comes at a time.
    fn slot(&mut self, now: u64) -> u64 {
        let Costs::Frames(frames) = &self.costs else { return now };
        let frame = frames.after(now).max(self.free);
        self.free = frame + 1;
        frames.time(frame)
    }
}

/// What was read at the present tick, which reads the same until the next one or until the robot is told
/// something.
#[derive(Debug, Default)]
pub(super) struct Recent {
    tick: u64,
    readings: Vec<(Request, Reply)>,
    /// What has been read since the world was asked last, which is likely to be read again.
    used: Vec<Request>,
}

impl Robios {
    /// Begins a call of RoBIOS; one without a name takes no time.
    pub(crate) fn begin(&mut self, call: &'static str) {
        self.call = call;
        self.queue.due = match &self.queue.costs {
            Costs::Frames(frames) if !call.is_empty() => Some(frames.of(call)),
            _ => None,
        };
    }

    /// Charges what the program has computed since its last call.
    pub(crate) fn charge_computing(&mut self, seconds: f64) {
        self.debt += (seconds * NANOSECONDS).round() as u64;
    }

    /// Nanoseconds since the start.
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

    /// Asks the world, in the robot's turn.
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

    /// Asks the world out of turn.
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
            // A call that fails takes its time too, if it has come to the robot; where this one is, it need
            // not be asked.
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

    /// Nanoseconds of a call in the simulator, which has been charged where the world was asked.
    fn call_in_world(&self) -> u64 {
        (self.identity.call_duration * NANOSECONDS).round() as u64
    }

    /// What has been read at this tick already.
    fn recall(&mut self, request: &Request) -> Option<Reply> {
        let tick = self.clock() / TICK_NANOSECONDS;
        let known = self.recent.readings.iter().filter(|_| self.recent.tick == tick);
        let reply = known.clone().find(|(known, _)| known == request).map(|(_, reply)| reply.clone());
        if reply.is_some() {
            self.debt += self.call_in_world();
        }
        reply
    }

    /// Lets so many nanoseconds pass, and asks the world, whatever is known.
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

    /// Whether what is asked changes only with the tick, or with what the robot is told.
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

    /// Asks the world to do something, in the robot's turn.
    pub(super) fn order(&mut self, request: &Request) -> Result<()> {
        let slot = match self.queue.due {
            Some(Cost { kind: Kind::OneWay, nanoseconds, .. }) => {
                self.queue.due = None;
                let now = self.clock();
                self.debt += nanoseconds;
                Some(self.queue.slot(now))
            }
            Some(_) => None,
            // The rest of a call whose first order waits.
            None => self.queue.orders.back().map(|order| order.0),
        };
        let Some(slot) = slot else {
            return match self.ask(request)? {
                Reply::Done => Ok(()),
                _ => Err(foreign()),
            };
        };
        self.queue.orders.push_back((slot, self.call, request.clone()));
        if self.queue.orders.len() > MOST_ORDERS {
            let first = self.queue.orders[0].0;
            let now = self.clock();
            self.set_clock(first.max(now));
        }
        self.settle()
    }

    /// Gives the world the orders whose time has come.
    fn deliver(&mut self) -> Result<()> {
        if self.queue.is_empty() {
            return Ok(());
        }
        let now = self.clock();
        while let Some((slot, call, request)) = self.queue.next_before(now) {
            let wait = slot.saturating_sub(self.link_clock());
            match self.ask_link(wait, &request) {
                // The program has gone on, and does not hear of it.
                Err(error) if matches!(error.kind(), ErrorKind::Unsupported | ErrorKind::InvalidInput) => {
                    let present = std::mem::replace(&mut self.call, call);
                    self.note(&error.to_string());
                    self.call = present;
                }
                answer => drop(answer?),
            }
            self.set_clock(now);
        }
        Ok(())
    }

    /// Gives the world all orders, and lets the time pass that this takes.
    pub(super) fn deliver_all(&mut self) -> Result<()> {
        if let Some(&(last, ..)) = self.queue.orders.back() {
            let now = self.clock();
            self.set_clock(last.max(now));
        }
        self.deliver()
    }

    /// Counts a call that the world has no part in.
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

    /// As [`charge`](Robios::charge), for a call with an image of so many pixels.
    pub(super) fn charge_image(&mut self, pixels: usize) -> Result<()> {
        if let Some(cost) = self.queue.due.as_mut().filter(|cost| cost.per_pixel) {
            cost.nanoseconds *= pixels as u64;
        }
        self.charge()
    }

    /// Lets the world catch up with the program, once it lags by a tick.
    fn settle(&mut self) -> Result<()> {
        if self.debt < TICK_NANOSECONDS && self.now() < self.identity.time_limit {
            return Ok(());
        }
        self.catch_up()
    }

    fn catch_up(&mut self) -> Result<()> {
        self.deliver()?;
        // The request is a call itself.
        let rest = std::mem::take(&mut self.debt).saturating_sub(self.call_in_world());
        self.ask_link(0, &Request::Pass(rest as f64 / NANOSECONDS)).map(|_| ())
    }

    /// Lets seconds pass, and the time that the call takes.
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

    /// Lets the time pass until the frame in which an event is told.
    pub(super) fn finish_frame(&mut self) -> Result<()> {
        let now = self.clock();
        if let Costs::Frames(frames) = &self.queue.costs {
            let end = frames.time(frames.after(now));
            self.set_clock(end);
        }
        self.settle()
    }

    /// Whether calls take what they do on EyeSim.
    pub(super) fn has_frames(&self) -> bool {
        matches!(self.queue.costs, Costs::Frames(_))
    }
}
