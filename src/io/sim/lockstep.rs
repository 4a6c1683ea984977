//! Programs that share one world in virtual time, independent of thread scheduling.

use std::cmp::Reverse;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};
use std::time::Duration;

use super::LONGEST;
use crate::io::{Error, ErrorKind, Result};

/// A world that advances tick by tick.
pub(super) trait Ticking {
    /// Ticks since the start.
    fn time(&self) -> u64;

    /// Advances by a number of ticks.
    fn run(&mut self, ticks: u64);
}

/// A world shared by several programs in lockstep.
///
/// The world stays at tick `n` until every running program has made a request at tick `n + 1` or later; the
/// last of them advances it. A program's readings at a tick therefore depend on ticks only, never on thread
/// scheduling. The one exception is a program that makes no request for longer than the others' patience in
/// real time: their requests fail, as they would otherwise hang for ever if it is blocked.
#[derive(Debug)]
pub(super) struct Lockstep<W> {
    state: Mutex<State<W>>,
    advanced: Condvar,
    /// Duration of a tick (ns).
    tick: u64,
    /// Real time for which a program waits while the world stands still.
    patience: Duration,
}

/// Real time for which a program waits at most for a robot that its own thread used last: nobody else will
/// drive it.
const FOR_OWN: Duration = Duration::from_secs(10);

#[derive(Debug)]
pub(super) struct State<W> {
    pub(super) world: W,
    seats: Vec<Seat>,
}

/// State of a program in the lockstep.
#[derive(Debug, Clone, Default)]
struct Seat {
    phase: Phase,
    /// Tick up to which the program allows the world to advance.
    tick: u64,
    /// Thread of the last call; `None` before the first one.
    thread: Option<ThreadId>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Phase {
    /// No program drives the robot; the world does not wait for it.
    #[default]
    Unclaimed,
    Running,
    Ended,
}

impl<W: Ticking> State<W> {
    /// Advances the world as far as every running program allows.
    fn advance(&mut self) {
        let running =
            self.seats.iter().filter(|seat| seat.phase == Phase::Running).map(|seat| seat.tick).min();
        let target = running.unwrap_or_else(|| self.seats.iter().map(|seat| seat.tick).max().unwrap_or(0));
        self.world.run(target.saturating_sub(self.world.time()));
    }

    /// A robot that blocks the world, if possible one that this thread used last, and whether it did.
    fn held_back_by(&self, index: usize) -> Option<(usize, bool)> {
        let me = Some(thread::current().id());
        let tick = self.world.time();
        let blocking = self
            .seats
            .iter()
            .enumerate()
            .filter(|(other, seat)| *other != index && seat.phase == Phase::Running && seat.tick == tick);
        blocking
            .map(|(other, seat)| (other, seat.thread == me))
            .max_by_key(|&(other, own)| (own, Reverse(other)))
    }
}

fn held_back(index: usize, other: usize, patience: Duration) -> Error {
    let message = format!(
        "robot {index} waits for robot {other}, whose program has let no time pass for {} s of real time; \
         give each robot a running thread of its own and drop robots that are done, or use a fleet",
        patience.as_secs_f64()
    );
    Error::new(ErrorKind::Other, message)
}

impl<W: Ticking> Lockstep<W> {
    /// A world with ticks of `tick` seconds for a number of programs, which wait for each other for at most
    /// `patience` seconds of real time.
    pub(super) fn new(world: W, tick: f64, programs: usize, patience: f64) -> Self {
        let seats = vec![Seat::default(); programs];
        let tick = nanoseconds(tick).max(1);
        let state = Mutex::new(State { world, seats });
        Self { state, advanced: Condvar::new(), tick, patience: Duration::from_secs_f64(patience) }
    }

    /// The world in its present state.
    pub(super) fn lock(&self) -> MutexGuard<'_, State<W>> {
        // A panic in a program can only occur between two calls, so the state is consistent.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Registers a program that the world waits for; returns the present tick.
    fn claim(&self, index: usize) -> Result<u64> {
        let mut state = self.lock();
        let programs = state.seats.len();
        let tick = state.world.time();
        let seat = state.seats.get_mut(index).ok_or_else(|| no_robot(index, programs))?;
        if seat.phase == Phase::Running {
            return Err(Error::new(
                ErrorKind::InvalidInput,
                format!("robot {index} is already being driven"),
            ));
        }
        *seat = Seat { phase: Phase::Running, tick, thread: None };
        Ok(tick)
    }

    /// Waits until the world is at `tick`, and returns it.
    fn reach(&self, index: usize, tick: u64) -> Result<MutexGuard<'_, State<W>>> {
        let mut state = self.lock();
        let alone = state.seats.len() == 1;
        if !alone {
            state.seats[index].thread = Some(thread::current().id());
        }
        if state.world.time() == tick {
            return Ok(state);
        }
        state.seats[index].tick = tick;
        let before = state.world.time();
        state.advance();
        if !alone && state.world.time() != before {
            self.advanced.notify_all();
        }
        while state.world.time() < tick {
            let before = state.world.time();
            let holder = state.held_back_by(index);
            let own = holder.is_some_and(|(_, own)| own);
            let patience = if own { self.patience.min(FOR_OWN) } else { self.patience };
            let (woken, waited) =
                self.advanced.wait_timeout(state, patience).unwrap_or_else(PoisonError::into_inner);
            state = woken;
            let still = state.world.time() == before && state.held_back_by(index) == holder;
            if let Some((other, _)) = holder
                && waited.timed_out()
                && still
            {
                return Err(held_back(index, other, patience));
            }
        }
        Ok(state)
    }

    /// Records that a program has ended at `tick`; the world continues without it.
    fn release(&self, index: usize, tick: u64) {
        let mut state = self.lock();
        state.seats[index].phase = Phase::Ended;
        state.seats[index].tick = tick;
        state.advance();
        self.advanced.notify_all();
    }
}

/// A program in a shared world: its own clock and its access to the world.
#[derive(Debug)]
pub(super) struct Program<W: Ticking> {
    shared: Arc<Lockstep<W>>,
    index: usize,
    /// The program's own clock, the duration of a call and the time limit (ns).
    clock: u64,
    call: u64,
    limit: u64,
}

/// Nanoseconds per second.
const NANOSECONDS: f64 = 1e9;

fn nanoseconds(seconds: f64) -> u64 {
    (seconds * NANOSECONDS).round() as u64
}

impl<W: Ticking> Program<W> {
    /// Claims the robot at an index. Each call takes `call` seconds; after the limit, if there is one, calls
    /// fail.
    pub(super) fn claim(
        shared: &Arc<Lockstep<W>>,
        index: usize,
        call: f64,
        limit: Option<f64>,
    ) -> Result<Self> {
        let clock = shared.claim(index)? * shared.tick;
        let (call, limit) = (nanoseconds(call), limit.map_or(u64::MAX, nanoseconds));
        Ok(Self { shared: Arc::clone(shared), index, clock, call, limit })
    }

    /// Makes a request at this program's time.
    pub(super) fn look<T>(&self, ask: impl FnOnce(&mut W, usize) -> Result<T>) -> Result<T> {
        if self.clock >= self.limit {
            // The world still advances to the limit, so that its final state can be examined.
            drop(self.shared.reach(self.index, self.limit / self.shared.tick)?);
            return Err(time_is_over());
        }
        let mut state = self.shared.reach(self.index, self.clock / self.shared.tick)?;
        ask(&mut state.world, self.index)
    }

    /// Makes a request at this program's time and charges its duration.
    pub(super) fn call<T>(&mut self, ask: impl FnOnce(&mut W, usize) -> Result<T>) -> Result<T> {
        let over = self.clock >= self.limit;
        let answer = self.look(ask);
        if !over {
            self.clock = self.clock.saturating_add(self.call);
        }
        answer
    }

    /// Advances the program's clock by the duration of a call.
    #[cfg(feature = "physics")]
    pub(super) fn charge(&mut self) {
        self.clock = self.clock.saturating_add(self.call);
    }

    /// Advances the program's clock. Fails for an invalid or excessive duration.
    pub(super) fn pass(&mut self, seconds: f64) -> Result<()> {
        check_duration("waiting time", seconds)?;
        self.clock = self.clock.saturating_add(nanoseconds(seconds.max(0.0)));
        Ok(())
    }

    /// Repeats a request at every tick until it has an answer.
    pub(super) fn poll<T>(&mut self, mut ask: impl FnMut(&mut W, usize) -> Result<Option<T>>) -> Result<T> {
        loop {
            if let Some(answer) = self.call(&mut ask)? {
                return Ok(answer);
            }
            self.clock = (self.clock / self.shared.tick + 1) * self.shared.tick;
        }
    }

    /// The program's own clock (s).
    pub(super) fn time(&self) -> f64 {
        self.clock as f64 / NANOSECONDS
    }

    /// The world, independent of the program's time.
    #[cfg(feature = "physics")]
    pub(super) fn shared(&self) -> &Lockstep<W> {
        &self.shared
    }
}

impl<W: Ticking> Drop for Program<W> {
    fn drop(&mut self) {
        self.shared.release(self.index, self.clock.min(self.limit) / self.shared.tick);
    }
}

pub(super) fn time_is_over() -> Error {
    Error::new(ErrorKind::TimedOut, "the time limit of the simulation is over")
}

pub(super) fn no_robot(index: usize, robots: usize) -> Error {
    Error::invalid_input("robot", index, &format!("an index below {robots}, the number of robots"))
}

/// Fails unless the duration of a wait is allowed.
pub(super) fn check_duration(name: &str, seconds: f64) -> Result<()> {
    if seconds.is_finite() && seconds <= LONGEST {
        return Ok(());
    }
    Err(Error::invalid_input(name, seconds, &format!("a finite number of at most {LONGEST} s")))
}

#[cfg(test)]
mod tests;
