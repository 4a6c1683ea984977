use std::collections::VecDeque;

/// Effect of a sensor's faults on a reading.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Disturbance {
    /// Repeats the previous reading.
    pub(super) stuck: bool,
    /// Delay of the readings (s).
    pub(super) delay: Option<f64>,
}

/// Past readings of one sensor, for faults that repeat them.
#[derive(Debug, Clone)]
pub(super) struct Memory<T> {
    /// The last reading before the sensor got stuck.
    held: Option<T>,
    past: VecDeque<(f64, T)>,
    /// How long readings are kept (s).
    horizon: f64,
}

impl<T: Clone> Memory<T> {
    /// A memory for delays up to `horizon` seconds.
    pub(super) fn new(horizon: f64) -> Self {
        Self { held: None, past: VecDeque::new(), horizon }
    }

    /// Stores a reading and returns the one visible to the program.
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

    /// Drops readings older than a time, except the newest of them, which is valid at that time.
    fn forget(&mut self, time: f64) {
        while self.past.get(1).is_some_and(|&(t, _)| t <= time) {
            self.past.pop_front();
        }
    }

    /// The newest reading at or before a time, or else the oldest known.
    fn recall(&self, time: f64) -> Option<T> {
        let newest = self.past.iter().rev().find(|&&(t, _)| t <= time);
        newest.or_else(|| self.past.front()).map(|(_, reading)| reading.clone())
    }
}
