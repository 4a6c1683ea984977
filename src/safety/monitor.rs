// This file compiles without the standard library.

/// Watches an event that must recur: a heartbeat, or the commands of a program.
///
/// ```
/// use roverlab::safety::Deadline;
/// let mut heartbeat = Deadline::new(0.5)?;
/// assert!(heartbeat.is_over(0.0), "no event yet");
/// heartbeat.feed(1.0);
/// assert!(!heartbeat.is_over(1.4) && heartbeat.is_over(1.6) && heartbeat.is_over(f64::NAN));
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deadline {
    limit: f64,
    last: Option<f64>,
}

impl Deadline {
    /// A deadline with a limit that is already validated (s).
    pub(super) const fn checked(limit: f64) -> Self {
        Self { limit, last: None }
    }

    /// Records an event.
    pub const fn feed(&mut self, now: f64) {
        self.last = Some(now);
    }

    /// Whether the deadline has expired: no event yet, the last one is too old, or the time is invalid.
    pub const fn is_over(&self, now: f64) -> bool {
        match self.last {
            None => true,
            // NaN counts as expired.
            Some(last) => !(now - last >= 0.0 && now - last <= self.limit),
        }
    }
}

/// Counts an observation only after several in a row.
///
/// ```
/// use roverlab::safety::Debounce;
/// let mut outside = Debounce::new(3);
/// let counts = [true, true, false, true, true, true].map(|seen| outside.update(seen));
/// assert_eq!(counts, [false, false, false, false, false, true], "three times in a row");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Debounce {
    needed: u16,
    seen: u16,
}

impl Debounce {
    /// An observation counts after `needed` in a row; 0 and 1 mean at once.
    pub const fn new(needed: u16) -> Self {
        Self { needed, seen: 0 }
    }

    /// Takes an observation and returns whether it counts.
    pub const fn update(&mut self, seen: bool) -> bool {
        self.seen = if seen { self.seen.saturating_add(1) } else { 0 };
        seen && self.seen >= self.needed
    }
}

/// Whether a point lies inside a polygon, by counting crossings. Points that are not finite count as outside,
/// and so does every point if there are fewer than three corners.
///
/// ```
/// use roverlab::safety::is_inside;
/// let fence = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]];
/// assert!(is_inside(&fence, [1.0, 1.0]) && !is_inside(&fence, [5.0, 1.0]));
/// assert!(!is_inside(&fence, [f64::NAN, 1.0]), "NaN counts as outside");
/// ```
pub fn is_inside(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    if !(x.is_finite() && y.is_finite()) {
        return false;
    }
    let Some(mut previous) = corners.last() else { return false };
    let mut inside = false;
    for corner in corners {
        let ([ax, ay], [bx, by]) = (*previous, *corner);
        if (ay > y) != (by > y) && x < ax + (y - ay) * (bx - ax) / (by - ay) {
            inside = !inside;
        }
        previous = corner;
    }
    inside
}

/// Limits of a plausible signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignalLimits {
    /// Maximum time between two readings (s).
    pub age: f64,
    /// Maximum rate of change (1/s).
    pub rate: f64,
    /// Further change allowed between two readings, for noise.
    pub step: f64,
    /// Number of equal readings in a row after which a changing signal counts as frozen.
    pub repeats: u16,
}

/// State of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SignalHealth {
    /// No fault.
    Good,
    /// Readings are missing or late.
    Lost,
    /// The last reading is not finite.
    NotANumber,
    /// The signal changed faster than is possible.
    Jump,
    /// The signal does not change although it should.
    Frozen,
}

/// Monitors one scalar signal of a sensor.
///
/// ```
/// use roverlab::safety::{SignalHealth, SignalLimits, SignalMonitor};
/// let limits = SignalLimits { age: 0.5, rate: 2.0, step: 0.1, repeats: 3 };
/// let mut range = SignalMonitor::new(limits)?;
/// range.read(0.0, 1.0, true);
/// range.read(0.1, 1.1, true);
/// assert_eq!(range.health(0.2), SignalHealth::Good);
/// assert_eq!(range.health(1.0), SignalHealth::Lost, "too old");
/// range.read(1.1, 9.0, true);
/// assert_eq!(range.health(1.1), SignalHealth::Jump, "faster than 2 m/s");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignalMonitor {
    limits: SignalLimits,
    last: Option<(f64, f64)>,
    repeats: u16,
    health: SignalHealth,
}

impl SignalMonitor {
    /// A monitor without a reading yet; the limits are already validated.
    pub(super) const fn checked(limits: SignalLimits) -> Self {
        Self { limits, last: None, repeats: 0, health: SignalHealth::Lost }
    }

    /// Takes a reading at time `now` (s). `alive` means that the signal should change, for example because
    /// the vehicle moves. A jump is reported once: the reading after it is compared with the new value.
    pub fn read(&mut self, now: f64, value: f64, alive: bool) {
        if !value.is_finite() {
            self.health = SignalHealth::NotANumber;
            return;
        }
        let Some((time, before)) = self.last.replace((now, value)) else {
            self.health = SignalHealth::Good;
            return;
        };
        let (passed, change) = (now - time, value - before);
        let largest = self.limits.step + self.limits.rate * passed.max(0.0);
        let equal = value.to_bits() == before.to_bits() && alive;
        self.repeats = if equal { self.repeats.saturating_add(1) } else { 0 };
        self.health = if change > largest || change < -largest {
            SignalHealth::Jump
        } else if self.repeats >= self.limits.repeats {
            SignalHealth::Frozen
        } else {
            SignalHealth::Good
        };
    }

    /// State of the signal at time `now` (s).
    pub fn health(&self, now: f64) -> SignalHealth {
        let Some((time, _)) = self.last else { return SignalHealth::Lost };
        let fresh = now - time >= 0.0 && now - time <= self.limits.age;
        match self.health {
            SignalHealth::Good if !fresh => SignalHealth::Lost,
            health => health,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deadline_needs_to_be_fed() {
        let mut deadline = Deadline::checked(0.5);
        assert!(deadline.is_over(0.0));
        deadline.feed(1.0);
        assert!(!deadline.is_over(1.0) && !deadline.is_over(1.5));
        // Too late, a clock that ran backwards, and an invalid time.
        assert!(deadline.is_over(1.51) && deadline.is_over(0.9) && deadline.is_over(f64::NAN));
    }

    #[test]
    fn once_is_not_often() {
        let mut outside = Debounce::new(3);
        let seen = [true, true, false, true, true, true, true, false].map(|seen| outside.update(seen));
        assert_eq!(seen, [false, false, false, false, false, true, true, false]);
    }

    #[test]
    fn a_fence_with_a_dent() {
        let fence = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]];
        for (point, inside) in [
            ([1.0, 1.0], true),
            ([2.0, 0.5], true),
            ([2.0, 2.0], false),
            ([3.9, 3.5], true),
            ([-0.1, 1.0], false),
            ([5.0, 0.5], false),
            ([f64::NAN, 1.0], false),
        ] {
            assert_eq!(is_inside(&fence, point), inside, "{point:?}");
        }
        assert!(!is_inside(&[], [0.0, 0.0]) && !is_inside(&fence[..2], [1.0, 0.0]));
    }

    #[test]
    fn every_way_of_going_wrong_has_its_name() {
        let limits = SignalLimits { age: 0.2, rate: 2.0, step: 0.1, repeats: 3 };
        let mut signal = SignalMonitor::checked(limits);
        assert_eq!(signal.health(0.0), SignalHealth::Lost);
        signal.read(0.0, 1.0, true);
        signal.read(0.1, 1.2, true);
        assert_eq!((signal.health(0.1), signal.health(0.31)), (SignalHealth::Good, SignalHealth::Lost));
        signal.read(0.2, 1.6, true);
        assert_eq!(signal.health(0.2), SignalHealth::Jump);
        signal.read(0.3, 1.6, true);
        assert_eq!(signal.health(0.3), SignalHealth::Good);
        signal.read(0.4, f64::NAN, true);
        assert_eq!(signal.health(0.4), SignalHealth::NotANumber);
        for _ in 0..5 {
            signal.read(0.5, 1.6, false);
        }
        assert_eq!(signal.health(0.5), SignalHealth::Good, "nothing changes while standing");
        for _ in 0..3 {
            signal.read(0.6, 1.6, true);
        }
        assert_eq!(signal.health(0.6), SignalHealth::Frozen);
    }
}
