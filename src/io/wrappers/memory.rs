use std::collections::VecDeque;

/// What a sensor's faults do to a reading of a certain time.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Disturbance {
    /// The reading before is repeated.
    pub(super) stuck: bool,
    /// Readings are this many seconds old.
    pub(super) delay: Option<f64>,
}

/// The readings of one sensor that faults may bring back.
#[derive(Debug, Clone)]
pub(super) struct Memory<T> {
    /// The last reading before the sensor got stuck.
    held: Option<T>,
    past: VecDeque<(f64, T)>,
    /// Seconds for which readings are kept.
    horizon: f64,
}

impl<T: Clone> Memory<T> {
    /// A memory that serves delays up to `horizon` seconds.
    pub(super) fn new(horizon: f64) -> Self {
        Self { held: None, past: VecDeque::new(), horizon }
    }

    /// Takes in a reading and gives the one that the program gets to see.
    pub(super) fn pass(&mut self, time: f64, fresh: T, disturbance: Disturbance) -> T {
        if self.horizon > 0.0 {
            self.past.push_back((time, fresh.clone()));
            self.forget(time - self.horizon);
        }
        let reading = match disturbance.delay {
            Some(delay) => self.recall(time - delay).unwrap_or(fresh),
            None => fresh,
        };
        match &self.held {
            Some(held) if disturbance.stuck => held.clone(),
            _ => {
                self.held = Some(reading.clone());
                reading
            }
        }
    }

    /// Drops what is older than a time, but for the newest such reading, which is the one valid at that time.
    fn forget(&mut self, time: f64) {
        while self.past.get(1).is_some_and(|&(t, _)| t <= time) {
            self.past.pop_front();
        }
    }

    /// The newest reading of a time or before, or else the oldest known.
    fn recall(&self, time: f64) -> Option<T> {
        let newest = self.past.iter().rev().find(|&&(t, _)| t <= time);
        newest.or_else(|| self.past.front()).map(|(_, reading)| reading.clone())
    }
}
