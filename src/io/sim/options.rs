use super::{NoiseModel, TICK, TICKS_PER_SECOND};
use crate::ParameterError;
use crate::parameter::{require, require_not_negative};

/// How a simulation runs.
#[derive(Debug, Clone, PartialEq)]
pub struct SimOptions {
    /// The seed of every random stream.
    pub seed: u64,
    /// Drive and sensor errors.
    pub noise: NoiseModel,
    /// Whether robots push what is not fixed and weighs no more than they do, instead of standing before it. Pushed
    /// things slide without turning, stop at once, and are no contacts; against walls and other things they stay.
    pub pushing: bool,
    /// How bright the light is that cameras see by, as a factor; 1 is a well lit room.
    pub light: f64,
    /// Whether encoders measure exactly instead of counting whole ticks.
    pub ideal_encoders: bool,
    /// Seconds that every call of a robot takes, so that a loop that only reads a sensor still lets time pass.
    pub call_duration: f64,
    /// Seconds after which every call fails with [`TimedOut`](crate::io::ErrorKind::TimedOut).
    pub time_limit: Option<f64>,
    /// Seconds between the points of each robot's trail; none is kept without it.
    pub trail_interval: Option<f64>,
}

/// The whole number of ticks nearest to a time.
pub(super) fn ticks_in(seconds: f64) -> u64 {
    (seconds * TICKS_PER_SECOND).round() as u64
}

impl Default for SimOptions {
    /// Seed 1, noise as on the real robot, 0.1 ms a call, no time limit.
    fn default() -> Self {
        Self {
            seed: 1,
            noise: NoiseModel::real(),
            light: 1.0,
            pushing: false,
            ideal_encoders: false,
            call_duration: 1e-4,
            time_limit: None,
            trail_interval: None,
        }
    }
}

impl SimOptions {
    /// Default options without noise.
    pub fn ideal() -> Self {
        Self { noise: NoiseModel::ideal(), ..Self::default() }
    }

    /// Default options with the real robot's noise times a factor, and a seed.
    pub fn with_noise(factor: f64, seed: u64) -> Self {
        Self { seed, noise: NoiseModel::real().scaled(factor), ..Self::default() }
    }

    /// Fails with the name of the option that is out of range.
    pub(super) fn validate(&self) -> Result<(), ParameterError> {
        self.noise.validate()?;
        require("light", self.light, (0.0..=100.0).contains(&self.light), "0 to 100")?;
        let limit = self.time_limit.unwrap_or(0.0);
        require_not_negative("time limit", limit)?;
        let interval = self.trail_interval.unwrap_or(TICK);
        let good = interval.is_finite() && interval >= TICK;
        require("trail interval", interval, good, "at least one tick of 10 ms")?;
        require(
            "call duration",
            self.call_duration,
            (1e-6..=1.0).contains(&self.call_duration),
            "1 µs to 1 s",
        )
    }
}
