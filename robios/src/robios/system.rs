use roverlab::io::Result;

use super::{EPOCH, Robios, invalid};

/// A timer function of a program.
#[cfg(not(target_family = "wasm"))]
pub(crate) type Callback = extern "C" fn();

/// A timer function of a program in a page, by the page's number.
#[cfg(target_family = "wasm")]
pub(crate) type Callback = u32;

/// Periodic functions.
#[derive(Debug, Default)]
pub struct Timers {
    all: Vec<Timer>,
    last: i32,
}

#[derive(Debug, Clone, Copy)]
struct Timer {
    id: i32,
    period: f64,
    due: f64,
    function: Callback,
}

/// Handle of the system's alarm clock.
const ALARM: i32 = 0;
/// Maximum number of timers in RoBIOS.
const MOST: usize = 17;

impl Timers {
    /// Whether there are no timers.
    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Time at which the next timer is due (s).
    pub(crate) fn next(&self) -> Option<f64> {
        self.all.iter().map(|timer| timer.due).min_by(f64::total_cmp)
    }

    /// The due functions. A late one is called once and continues from there.
    pub(crate) fn due(&mut self, now: f64) -> Vec<Callback> {
        let mut due = Vec::new();
        for timer in &mut self.all {
            if timer.due <= now {
                due.push(timer.function);
                timer.due = (timer.due + timer.period).max(now);
            }
        }
        self.all.retain(|timer| timer.due.is_finite());
        due
    }
}

impl Robios {
    /// `OSAttachTimer`: a function called every `scale` milliseconds. Returns its handle.
    pub(crate) fn os_attach_timer(&mut self, scale: i32, function: Callback) -> Result<i32> {
        if scale < 1 || self.timers.all.len() >= MOST {
            return Err(invalid("timer", format!("one of {scale} ms"), "17 of at least 1 ms"));
        }
        self.charge()?;
        let period = f64::from(scale) / 1000.0;
        let due = self.now() + period;
        self.timers.last += 1;
        self.timers.all.push(Timer { id: self.timers.last, period, due, function });
        Ok(self.timers.last)
    }

    /// Sets the system's alarm clock: it calls a function after `seconds`, and then periodically. Zero
    /// seconds mean never, a zero period once. Returns the result of [`alarm`](Robios::alarm) before.
    pub(crate) fn set_alarm(&mut self, (seconds, period): (f64, f64), function: Callback) -> (f64, f64) {
        let (now, earlier) = (self.now(), self.alarm());
        self.timers.all.retain(|timer| timer.id != ALARM);
        if seconds > 0.0 {
            let period = if period > 0.0 { period } else { f64::INFINITY };
            self.timers.all.push(Timer { id: ALARM, period, due: now + seconds, function });
        }
        earlier
    }

    /// Time until the next alarm, and its period (s).
    pub(crate) fn alarm(&mut self) -> (f64, f64) {
        let now = self.now();
        let alarm = self.timers.all.iter().find(|timer| timer.id == ALARM);
        let period = |period: f64| if period.is_finite() { period } else { 0.0 };
        alarm.map_or((0.0, 0.0), |alarm| ((alarm.due - now).max(1e-6), period(alarm.period)))
    }

    /// `OSDetachTimer`.
    pub fn os_detach_timer(&mut self, id: i32) -> Result<()> {
        let before = self.timers.all.len();
        self.timers.all.retain(|timer| timer.id != id || id == ALARM);
        if self.timers.all.len() == before {
            return Err(invalid("timer", id, "one that is attached"));
        }
        self.charge()
    }

    /// `OSSetTime`.
    pub fn os_set_time(&mut self, hours: i32, minutes: i32, seconds: i32) -> Result<()> {
        let fits = (0..24).contains(&hours) && (0..60).contains(&minutes) && (0..60).contains(&seconds);
        if !fits {
            return Err(invalid("time", format!("{hours}:{minutes}:{seconds}"), "0:0:0 to 23:59:59"));
        }
        self.charge()?;
        let wanted = f64::from(hours * 3600 + minutes * 60 + seconds);
        self.clock_offset = wanted - (EPOCH + self.now()).rem_euclid(86_400.0);
        Ok(())
    }

    /// `OSGetTime`: hours, minutes, seconds and milliseconds.
    pub fn os_get_time(&mut self) -> Result<[i32; 4]> {
        self.charge()?;
        let day = (EPOCH + self.now() + self.clock_offset).rem_euclid(86_400.0);
        let milliseconds = (1000.0 * day) as i32;
        let seconds = milliseconds / 1000;
        Ok([seconds / 3600, seconds / 60 % 60, seconds % 60, milliseconds % 1000])
    }

    /// `OSGetCount`: milliseconds since the start.
    pub fn os_get_count(&mut self) -> Result<i32> {
        let now = self.now();
        self.charge()?;
        // The floating-point number nearest to a time may lie below it.
        Ok((1000.0 * now + 1e-6) as i32)
    }
}
