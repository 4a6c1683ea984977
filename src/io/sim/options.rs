use super::{LONGEST, NoiseModel, TICK, TICKS_PER_SECOND};
use crate::ParameterError;
use crate::parameter::{require, require_not_negative, require_up_to};

/// Options of a simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct SimOptions {
    /// Seed of all random streams.
    pub seed: u64,
    /// Errors of drives and sensors.
    pub noise: NoiseModel,
    /// Whether robots push movable objects that weigh no more than they do, instead of stopping before them.
    /// Pushed objects slide without turning, stop at once, and are not contacts; walls and other objects
    /// block them.
    pub pushing: bool,
    /// Brightness of the light for cameras, as a factor; 1 is a well-lit room.
    pub light: f64,
    /// Fraction of the radio messages that are lost.
    pub radio_loss: f64,
    /// Whether encoders measure exactly instead of counting whole ticks.
    pub ideal_encoders: bool,
    /// Duration of every call of a robot (s), so that time passes in loops that only read sensors.
    pub call_duration: f64,
    /// Time after which every call fails with [`TimedOut`](crate::io::ErrorKind::TimedOut) (s).
    pub time_limit: Option<f64>,
    /// Real time for which a call waits while another robot's program lets no simulated time pass; then it
    /// fails and names that robot, instead of blocking for ever (s). For a robot that the waiting thread
    /// itself used last it is at most 10 s.
    pub patience: f64,
    /// Interval between the points of each robot's trail (s); `None` for no trail.
    pub trail_interval: Option<f64>,
}

/// Number of ticks nearest to a time.
pub(super) fn ticks_in(seconds: f64) -> u64 {
    (seconds * TICKS_PER_SECOND).round() as u64
}

impl Default for SimOptions {
    /// Seed 1, the real robot's noise, 0.1 ms per call, no time limit, a minute of patience.
    fn default() -> Self {
        Self {
            seed: 1,
            noise: NoiseModel::real(),
            light: 1.0,
            pushing: false,
            radio_loss: 0.0,
            ideal_encoders: false,
            call_duration: 1e-4,
            time_limit: None,
            patience: 60.0,
            trail_interval: None,
        }
    }
}

impl SimOptions {
    /// Default options without noise.
    pub fn ideal() -> Self {
        Self { noise: NoiseModel::ideal(), ..Self::default() }
    }

    /// Default options with a seed and the real robot's noise times a factor.
    pub fn with_noise(factor: f64, seed: u64) -> Self {
        Self { seed, noise: NoiseModel::real().scaled(factor), ..Self::default() }
    }

    /// Fails with the name of an option out of range.
    pub(super) fn validate(&self) -> Result<(), ParameterError> {
        self.noise.validate()?;
        require("light", self.light, (0.0..=100.0).contains(&self.light), "0 to 100")?;
        require("radio loss", self.radio_loss, (0.0..=1.0).contains(&self.radio_loss), "0 to 1")?;
        let limit = self.time_limit.unwrap_or(0.0);
        require_not_negative("time limit", limit)?;
        require_up_to("patience", self.patience, LONGEST)?;
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
